//! A vector that rank 0 has whole, in the order of its unknowns, and all ranks have in parts.

use std::ptr::null_mut;

use stickslip::algebra::linear::LinearError;

use super::{Int, Object, Vector, call, sys};
use crate::expect_length;

const STEP: &str = "sharing a vector";

/// The way between rank 0 and all ranks.
pub(crate) struct Exchange {
    /// The part of this rank.
    pub own: Vector,
    /// The place of each entry in the whole of the parts, on rank 0. Entries of the parts that have no place stay 0.
    pub places: Vec<Int>,
    scatter: Object<sys::_p_PetscSF>,
    whole: Vector,
}

impl Exchange {
    /// Creates the way to parts with this many entries on this rank.
    pub(crate) fn new(entries: usize, places: Vec<Int>) -> Result<Self, LinearError> {
        let (own, mut scatter, mut whole) = (Vector::new(entries)?, Object(null_mut()), Object(null_mut()));
        call!(STEP, VecScatterCreateToZero(own.0, &raw mut scatter.0, &raw mut whole.0))?;
        Ok(Exchange { own, places, scatter, whole })
    }

    /// Deals `x` of rank 0 `to` the parts.
    pub(crate) fn deal(&self, x: &[f64], to: &Vector) -> Result<(), LinearError> {
        expect_length("what ranks share", self.places.len(), x.len())?;
        self.whole.with(|whole| {
            whole.fill(0.0);
            self.places.iter().zip(x).for_each(|(place, x)| whole[*place as usize] = *x);
        })?;
        self.bring(&self.whole, to, sys::ScatterMode_SCATTER_REVERSE)
    }

    /// Collects a vector in parts in `x` of rank 0.
    pub(crate) fn collect(&self, of: &Vector, x: &mut [f64]) -> Result<(), LinearError> {
        self.bring(of, &self.whole, sys::ScatterMode_SCATTER_FORWARD)?;
        expect_length("what ranks share", x.len(), self.places.len())?;
        self.whole.with(|whole| self.places.iter().zip(x).for_each(|(place, x)| *x = whole[*place as usize]))
    }

    fn bring(&self, from: &Vector, to: &Vector, mode: sys::ScatterMode) -> Result<(), LinearError> {
        call!(STEP, VecScatterBegin(self.scatter.0, from.0, to.0, sys::InsertMode_INSERT_VALUES, mode))?;
        call!(STEP, VecScatterEnd(self.scatter.0, from.0, to.0, sys::InsertMode_INSERT_VALUES, mode))
    }
}
