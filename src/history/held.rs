//! The interior displacements at the start of an increment.
//!
//! The paper eliminates them (33)–(35): its unknowns are those of the contact nodes, and the
//! interior is always in equilibrium with the load. On the uncondensed system the same iterates
//! come from a start in which the contact nodes stay where they are (without friction: stay at their
//! distance) and the interior follows the new load. Loads are combinations of a few cases, so the
//! interior's answer to each is worked out once a run.

use super::method::IncrementSolver;
use crate::formulation::Layout;
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::problem::ContactProblem;
use crate::units::Scaling;

/// The body's answer to each load case while the contact nodes are held.
pub(super) struct HeldBody {
    /// `∂(u, p_t, p_n)/∂factor` per case, scaled.
    answers: Vec<Vec<f64>>,
    /// The factors and gaps (m) of the last increment.
    factors: Vec<f64>,
    gap: Vec<f64>,
    displacements: usize,
    scaling: Scaling,
}

/// What the change of the load from one increment to the next does to the held body, scaled.
pub(super) struct Response {
    u: Vec<f64>,
    /// The largest change of a contact force that holds a node.
    pub contact_force: f64,
    /// The largest change of a gap.
    pub gap_change: f64,
}

impl Response {
    /// Moves the displacements at the beginning of `z`.
    pub(super) fn add_to(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.u).for_each(|(u, du)| *u += du);
    }
}

impl HeldBody {
    /// One factorisation with held contacts and one solve per load case. The inner `Err` tells that
    /// the body is free even then, and by which weights of its free motions if that is why.
    pub(super) fn new(
        method: &mut dyn IncrementSolver,
        problem: &ContactProblem,
        loading: &Loading,
        scaling: &Scaling,
        linear: &mut Direct,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        if let Err(motion) = method.hold_contacts() {
            return Ok(Err(Some(motion)));
        }
        let (displacements, unknowns) = (problem.displacements(), Layout::new(problem).unknowns());
        let mut answers = Vec::with_capacity(loading.cases.len());
        // Without contact nodes a Newton step does all there is to do.
        if problem.contacts() > 0 && !loading.cases.is_empty() {
            match linear.factorize(method.matrix()) {
                Ok(_) => {}
                Err(LinearError::Singular { .. }) => return Ok(Err(None)),
                Err(error) => return Err(error),
            }
            let n = method.matrix().pattern.rows();
            let (mut rhs, mut z) = (vec![0.0; n], vec![0.0; n]);
            for case in &loading.cases {
                for (to, from) in rhs.iter_mut().zip(&case.force) {
                    *to = from / scaling.force;
                }
                match linear.solve(method.matrix(), &rhs, &mut z) {
                    Ok(_) => {}
                    Err(LinearError::NotFinite) => return Ok(Err(None)),
                    Err(error) => return Err(error),
                }
                answers.push(z[..unknowns].to_vec());
            }
        }
        let (factors, gap) = (vec![0.0; answers.len()], loading.gap.clone());
        Ok(Ok(HeldBody { answers, factors, gap, displacements, scaling: *scaling }))
    }

    /// Goes on to the load at `time`.
    pub(super) fn advance(&mut self, loading: &Loading, time: f64) -> Response {
        let largest = |changes: &mut dyn Iterator<Item = f64>| changes.fold(0.0_f64, |m, change| m.max(change.abs()));
        let mut u = vec![0.0; self.answers.first().map_or(0, Vec::len)];
        for ((case, answer), last) in loading.cases.iter().zip(&self.answers).zip(&mut self.factors) {
            let factor = case.factor(time);
            for (u, a) in u.iter_mut().zip(answer) {
                *u += (factor - *last) * a;
            }
            *last = factor;
        }
        let contact_forces = u.split_off(self.displacements.min(u.len()));
        let before = self.gap.clone();
        loading.gap_at(time, &mut self.gap);
        let gap_changes = &mut self.gap.iter().zip(&before).map(|(now, before)| now - before);
        Response {
            u,
            contact_force: largest(&mut contact_forces.into_iter()),
            gap_change: largest(gap_changes) / self.scaling.length,
        }
    }
}
