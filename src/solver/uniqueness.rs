//! The uniqueness of a solution: rigid motions that lead to other solutions ([`NeutralMotion`]), and the friction
//! that can make it ambiguous along the present statuses ([`critical_friction`]).

use crate::algebra::null_space::Motions;
use crate::solver::laws::{ContactStatus, ROUNDING, statuses};
use crate::solver::problem::{ContactProblem, Increment, State};
use faer::Mat;
use serde::{Deserialize, Serialize};

use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::base::units::Scaling;
use crate::solver::formulation::{Bdiff, FormulationScaling, Layout};
use crate::solver::history::Error;
use crate::solver::laws::coulomb::{NormalCase, TangentialCase};

/// The multiple of the friction that makes the rate problem singular, along given contact statuses.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CriticalFriction {
    /// `κ_c`: the smallest multiple of the present friction at which the rate problem is singular. It is infinite if
    /// there is none, and 0 if the rate problem is singular without friction, for example because nothing but
    /// friction stops a motion.
    pub factor: f64,
    /// The number of nodes that slip with friction, the order of `T`.
    pub slipping: usize,
}

impl CriticalFriction {
    /// Returns `true` if the rate problem is regular for all friction from zero to the present one.
    pub fn regular(&self) -> bool {
        self.factor > 1.0
    }
}

/// A solution says nothing of friction if its rows are violated by more than this share of their largest term. With sound
/// factors refinement leaves 1e-15.
const UNSOLVED: f64 = 1e-9;

/// Friction counts as on the border of its cone within this share of the largest force.
const BORDER: f64 = 1e-10;

/// A node that slips with friction.
struct Slider {
    /// The places of its forces in `z`; the tangential one along its tangent.
    p_t: usize,
    p_n: usize,
    /// `μ s`.
    drive: f64,
}

/// Computes the critical friction along the statuses of the nodes in `state`, a solution of `increment`. Nodes on the border of
/// their cone are about to slip, and count as slipping. It takes one analysis, one
/// factorisation and one solve for each slipping node, and leaves `linear` with the factors of `J_0`.
///
/// Returns `None` if a node can slide in two directions: there the turning of friction with the slip depends on the
/// rate, and `J(κ)` is a different matrix.
///
/// # Errors
/// If an array does not fit the problem, or if the linear solver fails, for example for lack of memory;
/// [`LinearError::Inaccurate`] if its solutions are too inaccurate. A singular
/// matrix is no error.
///
/// Multiply the friction at the slipping nodes by `κ` and keep every status. A small change of the
/// load then changes a solution by `(du, dp_t, dp_n)` with
///
/// - everywhere `K du + C_nᵀ dp_n + C_tᵀ dp_t = df`;
/// - open nodes: `dp_n = dp_t = 0`; closed ones: `C_n du = dg`; sticking ones: `C_t du = 0`;
/// - slipping ones: `-dp_t + κ μ s dp_n = 0`, with `s` the sign of `p_t`.
///
/// That matrix is `J(κ) = J_0 + κ J_1`, and `J_1 x` is `μ_i s_i dp_n,i` in the slip rows and 0 elsewhere. Let `T v`
/// be the normal forces of the slipping nodes if the tangential forces `μ_i s_i v_i` act there and the other rows of
/// `J_0` are 0. Eliminating with `J_0` leaves `dp_n = κ T dp_n`: `J(κ)` is singular if and only if `1/κ` is an
/// eigenvalue of `T`, or `J_0` is singular. `κ_c` is the smallest such `κ ≥ 0`. With all nodes slipping and
/// `W = C K⁻¹ Cᵀ`, `T = -W_nn⁻¹ W_nt diag(μ s)` (Klarbring, Ing.-Arch. 60, 1990, for one node).
pub fn critical_friction(
    problem: &ContactProblem,
    increment: &Increment<'_>,
    state: &State,
    scaling: Scaling,
    linear: &mut RefinedSolver,
) -> Result<Option<CriticalFriction>, Error> {
    let mut statuses = statuses(problem, increment, state)?;
    let largest = state.p_n.iter().fold(0.0_f64, |m, p| m.max(*p));
    for (i, status) in statuses.iter_mut().enumerate() {
        let friction = state.p_t[i].hypot(state.p_o[i]);
        if *status == ContactStatus::Stick && increment.mu[i] * state.p_n[i] - friction <= BORDER * largest {
            *status = ContactStatus::Slip;
        }
    }
    let layout = Layout::new(problem);
    if (0..problem.contacts()).any(|i| layout.slides_in_a_plane(i)) {
        return Ok(None);
    }
    // There is no iteration: the choices only affect r, which scales the rows of closed nodes.
    let mut tangent = Bdiff::new(problem, scaling, &FormulationScaling::natural(problem));
    tangent.set_cases(statuses.iter().map(|status| match status {
        ContactStatus::Open => (NormalCase::Open, TangentialCase::NoPressure),
        ContactStatus::Stick => (NormalCase::Closed, TangentialCase::Stick),
        // Without friction the tangential force of a slipping node is prescribed.
        ContactStatus::Slip => (NormalCase::Closed, TangentialCase::NoPressure),
    }));

    let slipping = (0..problem.contacts()).filter(|&i| statuses[i] == ContactStatus::Slip);
    let sliders: Vec<Slider> = slipping
        .filter_map(|i| {
            let mut forces = layout.tangential(i).into_iter().zip([state.p_t[i], state.p_o[i]]);
            let (p_t, force) = forces.find_map(|(place, force)| Some((place?, force)))?;
            Some(Slider { p_t, p_n: layout.p_n(i), drive: increment.mu[i] * force.signum() })
        })
        .collect();
    let factor = match sliders.as_slice() {
        [] => f64::INFINITY,
        sliders => match response(&tangent, sliders, linear) {
            Ok(Some(response)) => 1.0 / largest_real(&response)?,
            Ok(None) | Err(LinearError::Singular { .. } | LinearError::NotFinite) => 0.0,
            Err(error) => return Err(error.into()),
        },
    };
    Ok(Some(CriticalFriction { factor, slipping: sliders.len() }))
}

/// Returns `T`, column by column, or `None` if `J_0` is singular.
fn response(tangent: &Bdiff, sliders: &[Slider], linear: &mut RefinedSolver) -> Computed<Option<Mat<f64>>> {
    if tangent.unconstrained_mode().is_some() {
        return Ok(None);
    }
    let jacobian = tangent.jacobian();
    linear.analyze(jacobian)?;
    linear.factorize(jacobian)?;
    // In units in which stiffness and compliance are of order one, such a value is zero up to rounding.
    if linear.reciprocal_condition(jacobian)? < f64::EPSILON {
        return Ok(None);
    }
    let mut response = Mat::zeros(sliders.len(), sliders.len());
    let (mut b, mut x) = (vec![0.0; tangent.unknowns()], vec![0.0; tangent.unknowns()]);
    for (k, slider) in sliders.iter().enumerate() {
        // The row is -dp_t.
        b[slider.p_t] = -slider.drive;
        linear.solve(jacobian, &b, &mut x)?.within(UNSOLVED)?;
        b[slider.p_t] = 0.0;
        for (i, at) in sliders.iter().enumerate() {
            response[(i, k)] = x[at.p_n];
        }
    }
    Ok(Some(response))
}

/// An eigenvalue counts as real if its imaginary part is below this share of it. Rounding by `ε` splits a double real
/// eigenvalue into a pair that is `√ε` = 1.5e-8 apart. If a pair is truly complex but this near, the matrix at
/// `κ = 1/Re λ` is nevertheless singular to seven digits.
const REAL: f64 = 1e-7;

/// Returns the largest real positive eigenvalue of `t`, or 0 if there is none.
fn largest_real(t: &Mat<f64>) -> Computed<f64> {
    let eigenvalues =
        t.eigenvalues().map_err(|_| LinearError::Backend { backend: "faer", step: "eigenvalues", status: -1 })?;
    // An eigenvalue below the rounding of the largest entries counts as zero.
    let negligible = t.nrows() as f64 * f64::EPSILON * t.norm_max();
    let real = eigenvalues.iter().filter(|value| value.im.abs() <= REAL * value.re && value.re > negligible);
    Ok(real.map(|value| value.re).fold(0.0, f64::max))
}

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
    let frictional = closed().filter(|&i| increment.mu[i] > 0.0);
    let tangential = frictional.flat_map(|i| problem.tangential_maps().map(|map| map.row(i)));
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
        let limit = &mut room[usize::from(approach < 0.0)];
        *limit = limit.min(distance / approach.abs());
    }
    NeutralMotion { weights, room }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_positive_real_eigenvalues_count() {
        let largest = |rows: &[[f64; 2]; 2]| largest_real(&Mat::from_fn(2, 2, |i, j| rows[i][j])).unwrap();
        assert_eq!(largest(&[[2.0, 0.0], [0.0, -3.0]]), 2.0);
        assert_eq!(largest(&[[-2.0, 0.0], [0.0, -3.0]]), 0.0);
        // A rotation: 1 ± i.
        assert_eq!(largest(&[[1.0, -1.0], [1.0, 1.0]]), 0.0);
        // A double eigenvalue, exact and split by rounding: 1 ± 1e-8 i.
        assert!((largest(&[[1.0, 1.0], [0.0, 1.0]]) - 1.0).abs() < 1e-7);
        assert!((largest(&[[1.0, 1.0], [-1e-16, 1.0]]) - 1.0).abs() < 1e-7);
        // A zero up to rounding.
        assert_eq!(largest(&[[1e-17, 1.0], [0.0, -1.0]]), 0.0);
    }

    use crate::algebra::sparse::{Csr, Symmetric};
    use crate::solver::problem::Parts;

    /// The motions that a closed node leaves to a point with the free `motions`, whose row is `length` times that of unit length.
    fn remaining_motions(motions: Vec<Vec<f64>>, length: f64) -> Vec<NeutralMotion> {
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
                let motions = remaining_motions(vec![vec![size, 0.0], vec![0.0, size]], length);
                assert_eq!(motions.len(), 1, "{length} {size}");
                let [x, y] = motions[0].weights[..] else { panic!("{motions:?}") };
                assert!(y.abs() < 1e-15 * x.abs(), "{motions:?}");
                // A remainder along the row that is only rounding stops nothing.
                assert_eq!(remaining_motions(vec![vec![size, 1e-15 * size]], length).len(), 1, "{length} {size}");
            }
        }
    }
}
