//! How far loads have carried a body that contact alone holds.
//!
//! Such a body may move by a million times what it deforms before it comes to rest, and beside that its forces are lost:
//! `K u` is rounded to `ε |K| |u|`, and a method that starts far away closes and opens contacts that have nothing to do with the
//! solution. A free motion strains nothing, so the equations are the same from any place on its way: the unknowns are
//! displacements from where the body has been carried, and the obstacles come the other way instead.

use crate::algebra::sparse::{Csr, sum};
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// A free motion of the body, in what it does to displacements and contact nodes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct RigidOffset {
    /// The displacements, n_u, m; empty while the body has stayed.
    u: Vec<f64>,
    /// What contact nodes have moved along their normals, n_c, m.
    pub w_n: Vec<f64>,
    /// The same along their tangents.
    pub w_t: [Vec<f64>; 2],
}

impl RigidOffset {
    /// A body that has stayed where it was.
    pub(super) fn nowhere(problem: &ContactProblem) -> Self {
        let zeros = || vec![0.0; problem.contacts()];
        RigidOffset { u: Vec::new(), w_n: zeros(), w_t: [zeros(), zeros()] }
    }

    /// Further, by the problem's free motions with these `weights`.
    pub(super) fn by(&self, problem: &ContactProblem, weights: &[f64]) -> Self {
        if weights.iter().all(|weight| *weight == 0.0) {
            return self.clone();
        }
        let mut u = if self.u.is_empty() { vec![0.0; problem.displacements()] } else { self.u.clone() };
        for (motion, weight) in problem.rigid_modes().iter().zip(weights) {
            u.iter_mut().zip(motion).for_each(|(u, r)| *u += weight * r);
        }
        let moved = |map: &Csr| map.mul(&u);
        RigidOffset { w_n: moved(problem.c_n()), w_t: problem.tangential_maps().map(moved), u }
    }

    /// Whether it is one of `problem`.
    pub(super) fn fits(&self, problem: &ContactProblem) -> bool {
        let [w_t, w_o] = &self.w_t;
        let contacts = [&self.w_n, w_t, w_o].iter().all(|w| w.len() == problem.contacts());
        contacts && [0, problem.displacements()].contains(&self.u.len())
    }

    /// Whether the body has moved at all.
    pub(super) fn is_nonzero(&self) -> bool {
        !self.u.is_empty()
    }

    /// The largest displacement, m.
    pub(super) fn largest(&self) -> f64 {
        self.u.iter().fold(0.0, |m, u| m.max(u.abs()))
    }

    /// The state of the body with the displacements that it has from where it was at first, where `state` has those from
    /// here.
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
