//! The extension of Algorithm BN beyond the paper's loop: the last digits.

use super::{Bn, StopCriterion};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::sparse::sum;
use crate::solver::formulation::Bdiff;

/// The number of refinements. Each gains as many digits as the condition of the matrix leaves: one is usually enough,
/// three suffice up to about 1e11.
const REFINEMENTS: usize = 3;

impl Bn {
    /// Takes Newton steps with the last factors from residuals in twice the working precision, as long as they gain.
    /// `z + rest` then solves the equations where the rounding of `z` alone is too coarse. Returns `true` if that is
    /// enough.
    pub(super) fn refine(
        &mut self,
        formulation: &Bdiff,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        end: &mut StopCriterion<'_>,
    ) -> Result<bool, LinearError> {
        let mut best = end.measure(z, &self.rest)?;
        for _ in 0..REFINEMENTS {
            formulation.residual_beyond(z, &self.rest, &mut self.h)?;
            if self.direction(formulation, linear, false)?.is_err() {
                break;
            }
            let corrected = z.iter().zip(&self.rest).zip(&self.dz).map(|((z, rest), dz)| sum(*z, rest + dz));
            let (candidate, rest): (Vec<f64>, Vec<f64>) = corrected.unzip();
            let reached = end.measure(&candidate, &rest)?;
            if reached.is_none_or(f64::is_nan) || reached >= best {
                break;
            }
            z.copy_from_slice(&candidate);
            self.rest = rest;
            best = reached;
            if end.met(f64::INFINITY, best) {
                break;
            }
        }
        Ok(end.met(f64::INFINITY, best))
    }
}
