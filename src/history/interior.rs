//! The interior displacements at the start of an increment.
//!
//! The paper eliminates them (33)–(35): its unknowns are those of the contact nodes, and the
//! interior is always in equilibrium with the load. On the uncondensed system the same iterates
//! come from a start in which the contact nodes stay where they are (without friction: stay at their
//! distance) and the interior follows the new load. Loads are combinations of a few cases, so the interior's answer to each is worked out
//! once a run.

use crate::formulation::{Bdiff, Formulation};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;

/// The interior's answer to each load case while the contact nodes are held.
pub(super) struct Interior {
    /// `∂u/∂factor`, per case, scaled.
    answers: Vec<Vec<f64>>,
    /// The factors that the displacements stand for.
    factors: Vec<f64>,
}

impl Interior {
    /// One factorisation with held contacts and one solve per load case. The inner `Err` tells that
    /// the body is free even then, and by which weights of its free motions if that is why.
    pub(super) fn new(
        formulation: &mut Bdiff,
        loading: &Loading,
        linear: &mut Direct,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        formulation.hold_contacts();
        if let Some(motion) = formulation.unheld_motion() {
            return Ok(Err(Some(motion)));
        }
        let mut answers = Vec::with_capacity(loading.cases.len());
        // Without contact nodes a Newton step does all there is to do.
        if !formulation.is_affine() && !loading.cases.is_empty() {
            match linear.factorize(formulation.jacobian()) {
                Ok(_) => {}
                Err(LinearError::Singular { .. }) => return Ok(Err(None)),
                Err(error) => return Err(error),
            }
            let (n, n_u) = (formulation.unknowns(), formulation.layout().displacements());
            let (mut rhs, mut z) = (vec![0.0; n], vec![0.0; n]);
            for case in &loading.cases {
                for (to, from) in rhs.iter_mut().zip(&case.force) {
                    *to = from / formulation.scaling().force;
                }
                match linear.solve(formulation.jacobian(), &rhs, &mut z) {
                    Ok(_) => {}
                    Err(LinearError::NotFinite) => return Ok(Err(None)),
                    Err(error) => return Err(error),
                }
                answers.push(z[..n_u].to_vec());
            }
        }
        Ok(Ok(Interior { factors: vec![0.0; answers.len()], answers }))
    }

    /// Moves the interior displacements of `z` to the equilibrium with the load at `time`.
    pub(super) fn advance(&mut self, loading: &Loading, time: f64, z: &mut [f64]) {
        for ((case, answer), last) in loading.cases.iter().zip(&self.answers).zip(&mut self.factors) {
            let factor = case.factor(time);
            for (u, a) in z.iter_mut().zip(answer) {
                *u += (factor - *last) * a;
            }
            *last = factor;
        }
    }
}
