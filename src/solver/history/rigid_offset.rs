//! The rigid offset of a body that only contact holds.
//!
//! Such a body may move by a million times its deformation before it comes to rest, which would destroy the accuracy
//! of its forces: `K u` is rounded to `ε |K| |u|`. A method that starts far away also closes and opens contacts that
//! are unrelated to the solution. Rigid motions cause no strain, so the equations do not depend on the offset: the
//! unknowns are displacements relative to the offset, and the obstacles move the opposite way.

use crate::algebra::sparse::{Csr, sum};
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// A rigid motion of the body, as displacements and motions of the contact nodes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct RigidOffset {
    /// The displacements, n_u, m; empty if the body has not moved.
    pub u: Vec<f64>,
    /// The normal displacements of the contact nodes, n_c, m.
    pub w_n: Vec<f64>,
    /// The tangential displacements of the contact nodes along both tangents, n_c, m.
    pub w_t: [Vec<f64>; 2],
}

impl RigidOffset {
    /// Creates the offset of a body that has not moved.
    pub(super) fn nowhere(problem: &ContactProblem) -> Self {
        let zeros = || vec![0.0; problem.contacts()];
        RigidOffset { u: Vec::new(), w_n: zeros(), w_t: [zeros(), zeros()] }
    }

    /// Adds the problem's rigid modes with these `weights`.
    pub(super) fn by(&self, problem: &ContactProblem, weights: &[f64]) -> Self {
        if weights.iter().all(|weight| *weight == 0.0) {
            return self.clone();
        }
        let mut u = problem.rigid_motion(weights);
        u.iter_mut().zip(&self.u).for_each(|(u, offset)| *u += offset);
        let moved = |map: &Csr| map.mul(&u);
        RigidOffset { w_n: moved(problem.c_n()), w_t: problem.tangential_maps().map(moved), u }
    }

    /// Returns `true` if the offset has the sizes of `problem`.
    pub(super) fn fits(&self, problem: &ContactProblem) -> bool {
        let [w_t, w_o] = &self.w_t;
        let contacts = [&self.w_n, w_t, w_o].iter().all(|w| w.len() == problem.contacts());
        contacts && [0, problem.displacements()].contains(&self.u.len())
    }

    /// Returns `true` if the body has moved.
    pub(super) fn is_nonzero(&self) -> bool {
        !self.u.is_empty()
    }

    /// Converts a `state` relative to the offset into one relative to the initial configuration.
    pub(super) fn whole(&self, state: &State) -> State {
        let mut whole = state.clone();
        if self.is_nonzero() {
            let rest = state.u_rest.iter().chain(std::iter::repeat(&0.0));
            let sums = self.u.iter().zip(&state.u).zip(rest).map(|((offset, u), rest)| {
                let (u, left) = sum(*offset, *u);
                sum(u, left + rest)
            });
            (whole.u, whole.u_rest) = sums.unzip();
        }
        whole
    }
}
