//! Rigid motions from an equilibrium to other equilibria.

use serde::{Deserialize, Serialize};

use crate::algebra::null_space::Motions;
use crate::solver::laws::{ContactStatus, ROUNDING};
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
/// in the given `statuses`. It is empty for a supported body. A node whose force is rounding of the `largest` one (N)
/// holds nothing. A node that slips with friction counts as constrained, which misses motions in which it slips on.
pub(crate) fn neutral_motions(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    statuses: &[ContactStatus],
    largest: f64,
) -> Vec<NeutralMotion> {
    let motions = Motions::new(problem.rigid_modes());
    let presses = |i: &usize| statuses[*i] != ContactStatus::Open && state.p_n[*i] > ROUNDING * largest;
    let closed = || (0..problem.contacts()).filter(presses);
    let normal = closed().map(|i| problem.c_n().row(i));
    let rough = closed().filter(|&i| increment.mu[i] > 0.0);
    let tangential = rough.flat_map(|i| problem.tangential_maps().map(|map| map.row(i)));
    let open = motions.unfelt(normal.chain(tangential).map(|row| motions.felt(row)));
    let free: Vec<usize> = (0..problem.contacts()).filter(|i| !presses(i)).collect();
    open.into_iter().map(|weights| neutral_motion(problem, increment, state, &free, weights)).collect()
}

/// Creates the motion with these `weights`, of any length, until one of the `free` nodes touches.
fn neutral_motion(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    free: &[usize],
    mut weights: Vec<f64>,
) -> NeutralMotion {
    let mut u = problem.rigid_motion(&weights);
    let largest = u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    u.iter_mut().chain(&mut weights).for_each(|x| *x /= largest);
    let mut room = [f64::INFINITY; 2];
    for &i in free {
        let distance = (increment.gap[i] - problem.c_n().dot(i, &state.u)).max(0.0);
        let approach = problem.c_n().dot(i, &u);
        let way = &mut room[usize::from(approach < 0.0)];
        *way = way.min(distance / approach.abs());
    }
    NeutralMotion { weights, room }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::{Csr, Symmetric};
    use crate::solver::problem::Parts;

    /// The motions that a closed node leaves to a point with the free `motions`, whose row is `length` times that of unit length.
    fn left(motions: Vec<Vec<f64>>, length: f64) -> Vec<NeutralMotion> {
        let c_n = Csr::from_rows(2, [[(1, length)]]).unwrap();
        let stiffness = Symmetric::from_triplets(2, &[(0, 0, 0.0), (1, 1, 0.0)]).unwrap();
        let parts = Parts { rigid_modes: Some(motions), ..Parts::new(stiffness, c_n) };
        let problem = ContactProblem::of(parts);
        let state = State { p_n: vec![1.0], ..State::zero(&problem) };
        let increment = Increment { force: &[0.0; 2], gap: &[0.0], mu: &[0.0], w_t_last: &[0.0], w_o_last: &[0.0] };
        neutral_motions(&problem, &increment, &state, &[ContactStatus::Stick], 1.0)
    }

    #[test]
    fn the_length_of_rows_and_motions_says_nothing() {
        for length in [1e-12, 1.0, 1e12] {
            for size in [1e-12, 1.0, 1e12] {
                let motions = left(vec![vec![size, 0.0], vec![0.0, size]], length);
                assert_eq!(motions.len(), 1, "{length} {size}");
                let [x, y] = motions[0].weights[..] else { panic!("{motions:?}") };
                assert!(y.abs() < 1e-15 * x.abs(), "{motions:?}");
                // A remainder along the row that is only rounding stops nothing.
                assert_eq!(left(vec![vec![size, 1e-15 * size]], length).len(), 1, "{length} {size}");
            }
        }
    }
}
