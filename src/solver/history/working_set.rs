//! The working set of an active set method: the contact nodes in condensed equations.
//!
//! Open nodes have `p = 0`. A state without some nodes therefore satisfies all laws if these nodes do not penetrate
//! and the other nodes satisfy the laws. The verdict always covers all contact nodes. If nodes outside the working
//! set penetrate, they join it together with the nearest other nodes. No node leaves it.

use super::record::is_solution;
use super::state::StepResult;
use crate::algebra::linear::LinearError;
use crate::solver::laws::Judgement;
use crate::solver::newton::Termination;
use crate::solver::problem::{ContactProblem, Increment};
use serde::{Deserialize, Serialize};

/// The size of a history's working set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WorkingSet {
    /// The number of contact nodes at first.
    pub first: usize,
    /// The number of contact nodes at the end.
    pub last: usize,
    /// The number of all contact nodes.
    pub all: usize,
    /// The number of times that nodes joined.
    pub grown: usize,
}

/// The larger working set that is needed to continue.
pub(super) struct MissingNodes {
    /// The contact nodes of the larger set, ascending.
    pub nodes: Vec<usize>,
    /// `true` if the last state solves the equations of the smaller set.
    pub solved: bool,
}

/// Returns the larger working set needed after a `substep` with the nodes `held`, or `None` if these suffice.
///
/// The set at least doubles each time, which bounds the number of restarts. A failure not caused by missing nodes is
/// reported only after all nodes have been included.
pub(super) fn lack(
    problem: &ContactProblem,
    data: &Increment<'_>,
    substep: &StepResult,
    held: &[usize],
    tolerance: f64,
) -> Result<Option<MissingNodes>, LinearError> {
    let all = problem.contacts();
    if is_solution(&substep.kkt, tolerance) || substep.solved.stop == Termination::Interrupted {
        return Ok(None);
    }
    let mut is_held = vec![false; all];
    for &i in held {
        is_held[i] = true;
    }
    let distance = |i: usize| data.gap[i] - problem.c_n().dot(i, &substep.state.u);
    let mut others: Vec<(usize, f64)> = (0..all).filter(|&i| !is_held[i]).map(|i| (i, distance(i))).collect();
    others.sort_by(|a, b| a.1.total_cmp(&b.1));
    let judgement = Judgement::near(problem, data, &substep.state, &substep.scales, tolerance)?;
    let penetrating = others.iter().filter(|(i, _)| judgement.penetration(*i) > tolerance).count();
    let solved = substep.solved.stop == Termination::Converged && penetrating > 0;
    let joining = if solved { held.len().max(2 * penetrating) } else { all };
    // Leaving out less than a quarter of the nodes saves little.
    if 4 * (held.len() + joining) >= 3 * all {
        return Ok(Some(MissingNodes { nodes: (0..all).collect(), solved }));
    }
    for (i, _) in others.iter().take(joining) {
        is_held[*i] = true;
    }
    Ok(Some(MissingNodes { nodes: (0..all).filter(|&i| is_held[i]).collect(), solved }))
}
