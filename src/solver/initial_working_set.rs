//! The initial working set: the contact nodes that loads and obstacles can probably bring into contact.

use std::sync::Arc;

use crate::algebra::linear::{Cholesky, Computed, LinearError, SparseCholesky};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// The most entries of the Schur complement relative to those of the lower triangle of `K`, up to which contact nodes
/// out of reach are kept.
pub const AFFORDABLE: f64 = 1.0;

/// The smallest share of the Schur complement that omitting nodes must save, since they may have to join one by one.
const WORTHWHILE: f64 = 0.5;

/// The factor of `K` of a three-dimensional body has some tens of times the entries of `K`. A contact block with
/// fewer entries costs little more.
const ENTRIES_OF_FACTOR: usize = 32;

/// The initial working set of condensed equations.
#[derive(Debug, Default)]
pub struct InitialWorkingSet {
    /// The contact nodes in the set, ascending; `None` means all.
    pub nodes: Option<Vec<usize>>,
    /// The factors of `K` with the displacements of all contact nodes last, if they were computed and all nodes are
    /// kept.
    pub(crate) factor: Option<Arc<Cholesky>>,
}

impl InitialWorkingSet {
    /// Returns the number of displacements of `problem` on which the forces of its nodes act.
    pub(crate) fn displacements(&self, problem: &ContactProblem) -> usize {
        match &self.nodes {
            Some(nodes) => problem.contact_displacements_of(nodes.iter().copied()).len(),
            None => problem.contact_displacements().len(),
        }
    }
}

/// Returns the initial working set of `problem` under `loading`, over increments that end at `times` (s). It has all
/// nodes (`None`) if only contact holds the body, if all nodes are cheap, or if too many are within reach. Nodes out
/// of reach are kept, the nearest first, as long as the Schur complement has at most `affordable` times the entries of
/// the lower triangle of `K`.
/// `condensing` is the factorisation by which the body will be condensed; if that is not decided yet, the cheapest
/// ordering is used.
///
/// # Errors
/// If memory is short for the factors of `K`, which are needed if there are loads.
///
/// `S` of a condensed body is dense on all contact displacements, so that a node far from its obstacle costs as much
/// as a closed one. Let `ū(t)` be the displacements of the body under its loads without contact forces, and
/// `d_i = min_t g_i(t) - (C_n ū(t))_i` over the ends of increments. The nodes with `d_i ≤ 0` would penetrate. They
/// are in the set, and as many others, the nearest ones: a round obstacle touches fewer nodes than it would
/// penetrate, a lever brings more. The set is therefore an estimate and no bound. It affects only the start of the
/// solution, not the result, see [`HistorySettings::working_set`].
///
/// [`HistorySettings::working_set`]: crate::solver::history::HistorySettings::working_set
pub fn working_set(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    affordable: f64,
    condensing: Option<SparseCholesky>,
) -> Computed<InitialWorkingSet> {
    // All nodes, with the factors of `K` with all contact displacements last, if they were needed.
    let whole = |made: Option<Cholesky>| Ok(InitialWorkingSet { nodes: None, factor: made.map(Arc::new) });
    let all = problem.contacts();
    if all == 0 || !problem.rigid_modes().is_empty() {
        return whole(None);
    }
    let m = problem.contact_displacements().len();
    // The entries of the Schur complement on so many nodes.
    let entries = |nodes: usize| (m as f64 * nodes as f64 / all as f64).powi(2);
    let most = (1.0 - WORTHWHILE) * entries(all);
    let spare = affordable * problem.stiffness().lower_entries() as f64;
    if entries(all) <= spare {
        return whole(None);
    }
    let mut least = least_distances(loading, times, &[]);
    // The loads do not matter if the obstacles alone bring too many nodes within reach.
    if entries(within_reach(&least).0) > most {
        return whole(None);
    }
    let mut made = None;
    if loading.largest_force() > 0.0 {
        let last = problem.contact_displacements();
        let few = condensing.is_some() && last.len().pow(2) <= ENTRIES_OF_FACTOR * problem.stiffness().lower_entries();
        let stiffness = problem.stiffness().assembled()?;
        let factor = match condensing.unwrap_or_default().factor(&stiffness, if few { &last } else { &[] }) {
            // Without contact forces the displacements have no bounds.
            Err(LinearError::Singular { .. }) => return whole(None),
            factor => factor?,
        };
        let moved = unopposed(problem, loading, &factor)?;
        made = Some(factor).filter(|_| few);
        least = least_distances(loading, times, &moved);
    }
    let (within, nearest) = within_reach(&least);
    let affordable = (0..all).find(|nodes| entries(nodes + 1) > spare).unwrap_or(all);
    let size = within.max(affordable).max(1);
    if entries(size) > most {
        return whole(made);
    }
    let mut nodes = nearest[..size].to_vec();
    nodes.sort_unstable();
    // A smaller set puts other displacements last.
    Ok(InitialWorkingSet { nodes: Some(nodes), factor: None })
}

/// Returns `C_n K⁻¹ f` of each load, n_c, m: the normal displacements of the contact nodes without contact forces.
fn unopposed(problem: &ContactProblem, loading: &Loading, factor: &Cholesky) -> Computed<Vec<Vec<f64>>> {
    let mut u = vec![0.0; problem.displacements()];
    let mut moved = Vec::with_capacity(loading.cases().len());
    for case in loading.cases() {
        factor.solve(case.force(), &mut u)?;
        moved.push(problem.c_n().mul(&u));
    }
    Ok(moved)
}

/// Returns `d`, n_c, m, if each load at factor 1 displaces the contact nodes by `moved`.
fn least_distances(loading: &Loading, times: &[f64], moved: &[Vec<f64>]) -> Vec<f64> {
    let mut least = vec![f64::INFINITY; loading.gap().len()];
    for &time in times {
        let mut distance = loading.gaps_at(time);
        for (case, moved) in loading.cases().iter().zip(moved) {
            let factor = case.factor(time);
            distance.iter_mut().zip(moved).for_each(|(distance, w_n)| *distance -= factor * w_n);
        }
        least.iter_mut().zip(distance).for_each(|(least, distance)| *least = least.min(distance));
    }
    least
}

/// Returns the number of contact nodes within reach, and all contact nodes, the nearest first.
fn within_reach(least: &[f64]) -> (usize, Vec<usize>) {
    let mut nearest: Vec<usize> = (0..least.len()).collect();
    nearest.sort_by(|&i, &k| least[i].total_cmp(&least[k]));
    let inside = nearest.partition_point(|&i| least[i] <= 0.0);
    (least.len().min(2 * inside), nearest)
}
