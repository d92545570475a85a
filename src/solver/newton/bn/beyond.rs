//! What Algorithm BN has beyond the paper's loop: the last digits, the places where it stands still, and bodies that the
//! contact statuses leave free to move.

use super::{Bn, StopCriterion};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::sparse::sum;
use crate::solver::formulation::Bdiff;

/// In the places where several cases meet, the branch that a direction leads into is looked for this
/// many times; two nodes that wait for each other would go on for ever.
const BRANCH_TRIALS: usize = 3;

/// Each gains as many digits as the condition of the matrix leaves: one is the rule, three serve up to
/// 1e11 or so.
const REFINEMENTS: usize = 3;

/// The last direction tried, and the step along it.
pub(super) struct Branch {
    pub step: f64,
    pub backtracks: usize,
    pub backward_error: f64,
    /// Linear systems solved on the way.
    pub solves: usize,
}

impl Bn {
    /// Directions by the directional Newton equation (11), with the exact derivative (20), branch by branch until one can be
    /// stepped along.
    pub(super) fn branch_ahead(
        &mut self,
        mut branch: Branch,
        formulation: &mut Bdiff,
        linear: &mut RefinedSolver,
        z: &[f64],
        theta: f64,
    ) -> Result<Branch, LinearError> {
        for _ in 0..BRANCH_TRIALS {
            if !formulation.linearize_towards(z, &self.dz) {
                break;
            }
            let Ok(error) = self.direction(formulation, linear, true)? else { break };
            branch.backward_error = branch.backward_error.max(error);
            branch.solves += 1;
            (branch.step, branch.backtracks) = self.step_size(formulation, z, theta);
            if branch.backtracks < self.armijo.max_backtracks {
                break;
            }
        }
        Ok(branch)
    }

    /// Newton steps with the last factors from residuals in twice the working precision, as long as they
    /// gain: `z + rest` then solves the equations where the rounding of `z` alone is too coarse. Tells whether that is
    /// enough.
    pub(super) fn refine(
        &mut self,
        formulation: &Bdiff,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        end: &mut StopCriterion<'_>,
    ) -> Result<bool, LinearError> {
        let mut best = end.measure(z, &self.rest);
        for _ in 0..REFINEMENTS {
            formulation.residual_beyond(z, &self.rest, &mut self.h);
            if self.direction(formulation, linear, false)?.is_err() {
                break;
            }
            let corrected = z.iter().zip(&self.rest).zip(&self.dz).map(|((z, rest), dz)| sum(*z, rest + dz));
            let (candidate, rest): (Vec<f64>, Vec<f64>) = corrected.unzip();
            let reached = end.measure(&candidate, &rest);
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

    /// Follows the last direction, which only a free motion is left in, on to where the first contact node comes into
    /// another case. Tells whether there is such a place.
    pub(super) fn follow(&self, formulation: &Bdiff, z: &mut [f64]) -> bool {
        let reach = formulation.reach(z, &self.dz);
        if let Some(step) = reach {
            z.iter_mut().zip(&self.dz).for_each(|(z, dz)| *z += step * dz);
        }
        reach.is_some()
    }
}
