//! Extensions of Algorithm BN beyond the paper's loop: the last digits, points where it stalls, and bodies that the
//! contact statuses leave unconstrained.

use super::{Bn, StopCriterion, Termination};
use crate::algebra::linear::{Computed, RefinedSolver};
use crate::algebra::sparse::sum;
use crate::solver::formulation::Bdiff;

/// The number of attempts to find the branch into which a direction leads where several cases meet. Without a limit,
/// two nodes that depend on each other would never settle.
const BRANCH_TRIALS: usize = 3;

/// The number of refinements. Each gains as many digits as the condition of the matrix leaves: one is usually enough,
/// three suffice up to about 1e11.
const REFINEMENTS: usize = 3;

/// The number of refinements where contact rows depend on each other. Each is a step of the proximal point method; in a corner of
/// three planes it divides the error by 2 to 5.
const PROXIMAL_STEPS: usize = 40;

/// The last direction tried, and the step along it.
pub(super) struct Branch {
    pub step: f64,
    pub backtracks: usize,
    pub backward_error: f64,
    /// The number of linear systems solved.
    pub solves: usize,
}

impl Bn {
    /// Finds a direction of the directional Newton equation (11) with the exact derivative (20), branch by branch,
    /// until one admits a step.
    pub(super) fn branch_ahead(
        &mut self,
        branch: &mut Branch,
        formulation: &mut Bdiff,
        linear: &mut RefinedSolver,
        z: &[f64],
        theta: f64,
    ) -> Computed<()> {
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
        Ok(())
    }

    /// Takes Newton steps with the last factors from residuals in twice the working precision, as long as they gain.
    /// `z + rest` then solves the equations where the rounding of `z` alone is too coarse. Returns `true` if that is
    /// enough.
    pub(super) fn refine(
        &mut self,
        formulation: &mut Bdiff,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        end: &mut StopCriterion<'_>,
    ) -> Computed<bool> {
        let mut best = end.measure(z, &self.z_lo)?;
        let most = if formulation.has_dependent_nodes() { PROXIMAL_STEPS } else { REFINEMENTS };
        for _ in 0..most {
            formulation.refer_to(z);
            formulation.residual_dd(z, &self.z_lo, &mut self.h)?;
            if self.direction(formulation, linear, false)?.is_err() {
                break;
            }
            let corrected = z.iter().zip(&self.z_lo).zip(&self.dz).map(|((z, z_lo), dz)| sum(*z, z_lo + dz));
            let (candidate, z_lo): (Vec<f64>, Vec<f64>) = corrected.unzip();
            let reached = end.measure(&candidate, &z_lo)?;
            if reached.is_none_or(f64::is_nan) || reached >= best {
                break;
            }
            z.copy_from_slice(&candidate);
            self.z_lo = z_lo;
            best = reached;
            if end.is_met(f64::INFINITY, best) {
                break;
            }
        }
        Ok(end.is_met(f64::INFINITY, best))
    }

    /// Moves along the unconstrained mode in the last direction until the first contact node changes its case. Returns the
    /// reason to stop if there is no such mode, if none does, or if the solution is `converged`.
    pub(super) fn motion_ahead(&self, formulation: &Bdiff, z: &mut [f64], converged: bool) -> Option<Termination> {
        let Some(mode) = formulation.unconstrained_mode() else { return Some(Termination::Stalled) };
        let max_step = if converged { None } else { formulation.max_step(z, &self.dz) };
        let Some(step) = max_step else { return Some(Termination::Unconstrained(mode)) };
        z.iter_mut().zip(&self.dz).for_each(|(z, dz)| *z += step * dz);
        None
    }
}
