//! The contact nodes that condensed equations hold: a working set, as of an active set method.
//!
//! Nodes that stay apart have `p = 0`, so that a state in which they are left out is a solution of all laws, if they do not
//! penetrate and the laws of the others hold. The verdict is that of all contact nodes, always; where it is that nodes which are left
//! out penetrate, they join, with the nearest others. None ever leaves.

use super::state::SubstepResult;
use crate::solver::newton::Termination;
use crate::solver::problem::{ContactProblem, Increment};
use serde::{Deserialize, Serialize};

/// The contact nodes that the condensed equations of a history held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WorkingSet {
    /// How many they held at first.
    pub first: usize,
    /// How many at the end.
    pub last: usize,
    /// All that there are.
    pub all: usize,
    /// How often nodes joined.
    pub grown: usize,
}

/// What equations must hold to go on.
pub(super) struct MissingNodes {
    /// The contact nodes, ascending.
    pub nodes: Vec<usize>,
    /// Whether the state that the attempt ended in solves the equations without those that are new.
    pub solved: bool,
}

/// The contact nodes with which to go on after an `substep` with `held`, by what drove it; `None` if those will do.
///
/// A set that grows at least doubles, so that there are few of them. A failure that has another reason than nodes left out is
/// never told by fewer than all.
pub(super) fn lack(
    problem: &ContactProblem,
    data: &Increment<'_>,
    substep: &SubstepResult,
    held: &[usize],
    tolerance: f64,
) -> Option<MissingNodes> {
    let all = problem.contacts();
    if substep.kkt.worst().1 <= tolerance || substep.outcome.stop == Termination::Interrupted {
        return None;
    }
    let mut is_held = vec![false; all];
    for &i in held {
        is_held[i] = true;
    }
    let distance = |i: usize| data.gap[i] - problem.c_n().dot(i, &substep.state.u);
    let mut others: Vec<(usize, f64)> = (0..all).filter(|&i| !is_held[i]).map(|i| (i, distance(i))).collect();
    others.sort_by(|a, b| a.1.total_cmp(&b.1));
    let allowed = tolerance * substep.scales.length;
    let penetrating = others.iter().filter(|(_, distance)| -distance > allowed).count();
    let solved = substep.outcome.stop == Termination::Converged && penetrating > 0;
    let joining = if solved { held.len().max(2 * penetrating) } else { all };
    // The last quarter saves little.
    if 4 * (held.len() + joining) >= 3 * all {
        return Some(MissingNodes { nodes: (0..all).collect(), solved });
    }
    for (i, _) in others.iter().take(joining) {
        is_held[*i] = true;
    }
    Some(MissingNodes { nodes: (0..all).filter(|&i| is_held[i]).collect(), solved })
}
