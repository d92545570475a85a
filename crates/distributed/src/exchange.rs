//! A vector that rank 0 has whole, in the order of its unknowns, and all ranks have in parts.

use stickslip::algebra::linear::LinearError;

use crate::expect_length;
use crate::petsc::{Int, Scatter, Vector};

/// The way between rank 0 and all ranks.
pub(crate) struct Exchange {
    whole: Vector,
    /// The part of this rank.
    pub own: Vector,
    scatter: Scatter,
}

impl Exchange {
    /// Creates the way to parts with this many entries on this rank. Rank 0 has the `places` of its entries in the
    /// whole of the parts; on the others they are empty. Entries of the parts that have no place stay 0.
    pub(crate) fn new(entries: usize, places: &[Int]) -> Result<Self, LinearError> {
        let (whole, own) = (Vector::new(places.len())?, Vector::new(entries)?);
        // Rank 0 has the first entries of the whole.
        let at: Vec<Int> = (0..).take(places.len()).collect();
        let scatter = Scatter::new(&whole, &at, &own, places)?;
        Ok(Exchange { whole, own, scatter })
    }

    /// Deals `x` of rank 0 to the parts.
    pub(crate) fn deal(&self, x: &[f64]) -> Result<(), LinearError> {
        self.whole.with(|whole| copy(x, whole))??;
        self.scatter.forward(&self.whole, &self.own)
    }

    /// Collects a vector in parts in `x` of rank 0.
    pub(crate) fn collect(&self, of: &Vector, x: &mut [f64]) -> Result<(), LinearError> {
        self.scatter.back(of, &self.whole)?;
        self.whole.with(|whole| copy(whole, x))?
    }
}

fn copy(from: &[f64], to: &mut [f64]) -> Result<(), LinearError> {
    expect_length("what ranks share", to.len(), from.len())?;
    to.copy_from_slice(from);
    Ok(())
}
