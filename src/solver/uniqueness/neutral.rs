//! Rigid motions from an equilibrium to other equilibria.

use serde::{Deserialize, Serialize};

use crate::algebra::null_space::null_space;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::{ContactProblem, Increment, State};

/// A non-unique mode of an equilibrium: a rigid motion in which closed nodes move along their obstacles, without
/// friction, and sticking nodes do not move. No force changes along it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NeutralMotion {
    /// The weights of the problem's rigid modes in it, scaled so that its largest displacement is at most 1.
    pub weights: Vec<f64>,
    /// The distances that the body can move along it, and against it, until an open node touches: the largest
    /// displacement, m. Infinite if none ever does.
    pub room: [f64; 2],
}

/// Returns a basis of the motions from the equilibrium `state` of `increment` to other equilibria, with contact nodes
/// in the given `statuses`. It is empty for a supported body. A node that slips with friction counts as constrained,
/// which misses motions in which it slips on.
pub(crate) fn neutral_motions(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    statuses: &[ContactStatus],
) -> Vec<NeutralMotion> {
    let motions = problem.rigid_modes();
    let felt = |row: &[(usize, f64)]| {
        motions.iter().map(|motion| row.iter().map(|&(j, c)| c * motion[j]).sum()).collect::<Vec<f64>>()
    };
    let closed = || (0..problem.contacts()).filter(|&i| statuses[i] != ContactStatus::Open);
    let normal = closed().map(|i| problem.c_n().row(i));
    let rough = closed().filter(|&i| increment.mu[i] > 0.0);
    let tangential = rough.flat_map(|i| problem.tangential_maps().map(|map| map.row(i)));
    let open = null_space(motions.len(), normal.chain(tangential).map(felt));
    open.into_iter().map(|weights| neutral_motion(problem, increment, state, statuses, weights)).collect()
}

/// Creates the motion with these `weights`, of any length.
fn neutral_motion(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    statuses: &[ContactStatus],
    mut weights: Vec<f64>,
) -> NeutralMotion {
    let mut u = vec![0.0; problem.displacements()];
    for (motion, weight) in problem.rigid_modes().iter().zip(&weights) {
        u.iter_mut().zip(motion).for_each(|(u, part)| *u += weight * part);
    }
    let largest = u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    u.iter_mut().chain(&mut weights).for_each(|x| *x /= largest);
    let mut room = [f64::INFINITY; 2];
    for i in (0..problem.contacts()).filter(|&i| statuses[i] == ContactStatus::Open) {
        let distance = (increment.gap[i] - problem.c_n().dot(i, &state.u)).max(0.0);
        let approach = problem.c_n().dot(i, &u);
        let way = &mut room[usize::from(approach < 0.0)];
        *way = way.min(distance / approach.abs());
    }
    NeutralMotion { weights, room }
}
