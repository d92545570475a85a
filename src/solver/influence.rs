//! The influence function of a contact force: the displacements z to which the error of the force is dual.
//!
//! Along fixed contact statuses a sum `J = Σ a_n p_n + a_T p_T` of contact forces depends linearly on the loads, and z
//! solves the transposed equations: `K z + C_nᵀ q_n + C_Tᵀ q_T = 0` with
//!
//! - `w_n(z) = a_n` and `w_T(z) = a_T` where nodes stick;
//! - `w_n(z) + μ n w_T(z) = a_n + μ n a_T` and `q_T = 0` where they slip along n;
//! - `q = 0` where they are open.
//!
//! Displacements u of the body and their mesh error e then have `J - J_h = -a(u - u_h, z - z_h)`. If loads alone
//! determine J, z is a rigid motion and J has no such error.

use crate::algebra::linear::{Computed, Dense, LinearError, RefinedSolver};
use crate::base::units::Scaling;
use crate::solver::condensation::Condensed;
use crate::solver::formulation::{Bdiff, FormulationScaling};
use crate::solver::history::SystemSolver;
use crate::solver::laws::coulomb::TangentialCase;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// A contact node in a sum of contact forces.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Weighted {
    /// `true` if the node is closed.
    pub closed: bool,
    /// `μ n` if the node slips.
    pub slips: Option<[f64; 2]>,
    /// `a_n` and `a_T`.
    pub normal: f64,
    pub tangential: [f64; 2],
}

/// The substitutions by which the motion of slipping nodes is found, and the relative change at which they end.
const MOST: usize = 30;
const SETTLED: f64 = 1e-6;

/// Returns the influence function of the sum of the forces of these `nodes`, with one entry for each displacement;
/// `None` if it is not unique, or friction makes it so large that it is not found.
///
/// # Errors
/// If the linear solver fails, for example for lack of memory.
pub(crate) fn influence(
    problem: &ContactProblem,
    scaling: Scaling,
    nodes: &[Weighted],
    system: SystemSolver,
) -> Computed<Option<Vec<f64>>> {
    match system {
        SystemSolver::Whole(mut linear) => along(problem, scaling, nodes, &mut linear),
        SystemSolver::Condensed(condensation) => {
            let closed: Vec<usize> = (0..nodes.len()).filter(|&i| nodes[i].closed).collect();
            let problem = problem.of_nodes(&closed);
            let condensed = Condensed::new(&problem, &Loading::default(), condensation.cholesky())?;
            let nodes: Vec<Weighted> = closed.into_iter().map(|i| nodes[i]).collect();
            let Some(z) =
                along(&condensed.problem, scaling, &nodes, &mut RefinedSolver::new(Box::new(Dense::default())))?
            else {
                return Ok(None);
            };
            let free = condensed.reduce(&vec![0.0; problem.displacements()])?;
            condensed.displacements(&free, &z).map(Some)
        }
    }
}

fn along(
    problem: &ContactProblem,
    scaling: Scaling,
    nodes: &[Weighted],
    linear: &mut RefinedSolver,
) -> Computed<Option<Vec<f64>>> {
    let mut tangent = Bdiff::new(problem, scaling, &FormulationScaling::natural(problem));
    let case = |node: &Weighted| match (node.closed, node.slips) {
        (true, None) => (true, TangentialCase::Stick),
        (closed, _) => (closed, TangentialCase::NoPressure),
    };
    tangent.linearize_for(&nodes.iter().map(case).collect::<Vec<_>>());
    if tangent.unpinned_mode().is_some() {
        return Ok(None);
    }
    let jacobian = tangent.jacobian();
    linear.analyze(jacobian)?;
    match linear.factorize(jacobian) {
        Err(LinearError::Singular { .. } | LinearError::NotFinite) => return Ok(None),
        other => other?,
    };
    let along: Vec<[f64; 2]> = nodes.iter().map(|node| node.tangential).collect();
    let (mut gap, mut z) = (nodes.iter().map(|node| node.normal).collect::<Vec<_>>(), vec![0.0; tangent.unknowns()]);
    for _ in 0..MOST {
        linear.solve(jacobian, &tangent.change([], &gap, &along), &mut z)?;
        let (mut change, mut size) = (0.0_f64, 0.0_f64);
        for (i, node) in nodes.iter().enumerate() {
            let Some(drive) = node.slips.filter(|_| node.closed) else { continue };
            let w = tangent.w_t(i, &z);
            let ahead = [0, 1].map(|d| drive[d] * (node.tangential[d] - w[d]));
            let next = node.normal + ahead[0] + ahead[1];
            change = change.max((next - std::mem::replace(&mut gap[i], next)).abs());
            size = size.max(1.0_f64.max(next.abs()));
        }
        if change <= SETTLED * size {
            z.truncate(problem.displacements());
            return Ok(z.iter().all(|z| z.is_finite()).then_some(z));
        }
    }
    Ok(None)
}
