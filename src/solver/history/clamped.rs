//! The interior displacements at the start of an increment.
//!
//! The paper eliminates them (33)–(35): its unknowns are those of the contact nodes, and the
//! interior is always in equilibrium with the load. On the uncondensed system the same iterates
//! come from a start in which the contact nodes stay where they are (without friction: stay at their
//! distance) and the interior follows the new load. Loads are combinations of a few cases, so the
//! interior's answer to each is worked out once a run.

use super::task::{IncrementSolver, Response};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::base::units::Scaling;
use crate::solver::formulation::Layout;
use crate::solver::laws::coulomb::length;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// The body's answer to each load case while the contact nodes are held.
pub(super) struct ClampedBody {
    /// `∂(u, p_t, p_n)/∂factor` per case, scaled.
    answers: Vec<Vec<f64>>,
    layout: Layout,
    scaling: Scaling,
}

impl ClampedBody {
    /// One factorisation with held contacts and one solve per load case. The inner `Err` tells that
    /// the body is free even then, and by which weights of its free motions if that is why.
    pub(super) fn new(
        method: &mut dyn IncrementSolver,
        problem: &ContactProblem,
        loading: &Loading,
        scaling: &Scaling,
        linear: &mut RefinedSolver,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        if let Err(motion) = method.hold_contacts() {
            return Ok(Err(Some(motion)));
        }
        let layout = Layout::new(problem);
        let mut answers = Vec::with_capacity(loading.cases().len());
        // Without contact nodes a Newton step does all there is to do.
        if problem.contacts() > 0 && !loading.cases().is_empty() {
            match linear.factorize(method.matrix()) {
                Ok(_) => {}
                Err(LinearError::Singular { .. }) => return Ok(Err(None)),
                Err(error) => return Err(error),
            }
            let n = method.matrix().order();
            let (mut rhs, mut z) = (vec![0.0; n], vec![0.0; n]);
            for case in loading.cases() {
                for (to, from) in rhs.iter_mut().zip(case.force()) {
                    *to = from / scaling.force;
                }
                match linear.solve(method.matrix(), &rhs, &mut z) {
                    Ok(_) => {}
                    Err(LinearError::NotFinite) => return Ok(Err(None)),
                    Err(error) => return Err(error),
                }
                answers.push(z[..layout.unknowns()].to_vec());
            }
        }
        Ok(Ok(ClampedBody { answers, layout, scaling: *scaling }))
    }

    /// What the change of the load from one time to another does; `None` stands for the unloaded body.
    pub(super) fn response(&self, loading: &Loading, from: Option<f64>, to: f64) -> Response {
        let mut u = vec![0.0; self.answers.first().map_or(0, Vec::len)];
        for (case, answer) in loading.cases().iter().zip(&self.answers) {
            let change = case.factor(to) - from.map_or(0.0, |from| case.factor(from));
            for (u, a) in u.iter_mut().zip(answer) {
                *u += change * a;
            }
        }
        let contacts = if u.is_empty() { 0 } else { self.layout.contacts() };
        let force = |i: usize| {
            let friction = self.layout.tangential(i).map(|k| k.map_or(0.0, |k| u[k]));
            length(friction).max(u[self.layout.p_n(i)].abs())
        };
        let contact_force = (0..contacts).map(force).fold(0.0, f64::max);
        let forces = u.split_off(self.layout.displacements().min(u.len()));
        let (mut before, mut after) = (loading.gap().to_vec(), loading.gap().to_vec());
        if let Some(from) = from {
            loading.gap_at(from, &mut before);
        }
        loading.gap_at(to, &mut after);
        let gap_change = after.iter().zip(&before).fold(0.0_f64, |m, (now, before)| m.max((now - before).abs()));
        Response { u, contact_force, forces, gap_change: gap_change / self.scaling.length }
    }
}
