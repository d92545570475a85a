//! Which contact nodes loads and obstacles can bring into contact: those that condensed equations begin with.
//!
//! `S` of a condensed body is dense on all contact displacements, so that a node which stays far from its obstacle costs as much as
//! one that is pressed. With the displacements `ū(t)` of the body under its loads where no contact force acts, and
//! `d_i = min_t g_i(t) - (C_n ū(t))_i` over the ends of increments, the nodes with `d_i ≤ 0` would be in their obstacle. These are within
//! reach, and as many again, the nearest ones: a round obstacle touches fewer than it would cut off, a lever brings more. So it is an
//! estimate and no bound. It decides what is solved with at first, and nothing of the answer, see [`HistorySettings::working_set`].
//!
//! [`HistorySettings::working_set`]: crate::solver::history::HistorySettings::working_set

use std::sync::Arc;

use crate::algebra::linear::cost::{self, Work};
use crate::algebra::linear::{Cholesky, LinearError, SparseCholesky};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// What contact nodes out of reach may cost, in terms of the work with the body itself: as long as it is no more, they stay.
pub const AFFORDABLE: f64 = 1.0;

/// What is left out must save this share of what all nodes cost, for it may have to join one by one.
const WORTHWHILE: f64 = 0.5;

/// A factor of `K` of a body in space has some tens of times its entries. A border whose square is less costs little more.
const ENTRIES_OF_FACTOR: usize = 32;

/// What condensed equations begin with.
#[derive(Debug, Default)]
pub struct InitialWorkingSet {
    /// The contact nodes that they hold, ascending, if not all.
    pub nodes: Option<Vec<usize>>,
    /// The factors of `K` with the displacements of all contact nodes last, where they were made to find that all stay.
    pub(crate) factor: Option<Arc<Cholesky>>,
}

/// The contact nodes that condensed equations of `problem` under `loading` begin with, over increments that end at
/// `times` (s). `None` stands for all: in a body that contact alone holds, where all are cheap, and where too many are within reach.
/// Nodes out of reach stay, the nearest first, as long as what they cost is at most `affordable` times the work with the body.
/// `condensing` says by which factorisation the body will be condensed; where that is not sure, the cheapest order answers.
///
/// # Errors
/// When memory is short for the factors of `K`, which loads ask for.
pub fn working_set(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    affordable: f64,
    condensing: Option<SparseCholesky>,
) -> Result<InitialWorkingSet, LinearError> {
    let (nodes, factor) = within(problem, loading, times, affordable, condensing)?;
    // With fewer nodes other displacements come last.
    let factor = factor.filter(|_| nodes.is_none()).map(Arc::new);
    Ok(InitialWorkingSet { nodes, factor })
}

/// The nodes, if not all, and the factors of `K` with all contact displacements last, if they were needed.
fn within(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    affordable: f64,
    condensing: Option<SparseCholesky>,
) -> Result<(Option<Vec<usize>>, Option<Cholesky>), LinearError> {
    let all = problem.contacts();
    if all == 0 || !problem.rigid_modes().is_empty() {
        return Ok((None, None));
    }
    let (m, increments) = (problem.contact_displacements().len(), times.len());
    // Most nodes out of reach are open, and so are many within it.
    let work = Work { increments: increments as f64, factorizations: increments as f64, all_free: true };
    let of_contact = |nodes: usize| cost::border((m * nodes).div_ceil(all), &work);
    let most = (1.0 - WORTHWHILE) * of_contact(all);
    let spare =
        affordable * cost::body(problem.displacements(), problem.stiffness().lower().values().len(), increments);
    if of_contact(all) <= spare {
        return Ok((None, None));
    }
    let mut least = least_distances(loading, times, &[]);
    // Loads are not asked where obstacles alone meet too many.
    if of_contact(within_reach(&least).0) > most {
        return Ok((None, None));
    }
    let mut made = None;
    if loading.largest_force() > 0.0 {
        let last = problem.contact_displacements();
        let few =
            condensing.is_some() && last.len().pow(2) <= ENTRIES_OF_FACTOR * problem.stiffness().lower().values().len();
        let factor = match condensing.unwrap_or_default().factor(problem.stiffness(), if few { &last } else { &[] }) {
            // Without contact forces it has no bounds.
            Err(LinearError::Singular { .. }) => return Ok((None, None)),
            factor => factor?,
        };
        let moved = unopposed(problem, loading, &factor)?;
        made = Some(factor).filter(|_| few);
        least = least_distances(loading, times, &moved);
    }
    let (within, nearest) = within_reach(&least);
    let affordable = (0..all).find(|nodes| of_contact(nodes + 1) > spare).unwrap_or(all);
    let held = within.max(affordable).max(1);
    if of_contact(held) > most {
        return Ok((None, made));
    }
    let mut nodes = nearest[..held].to_vec();
    nodes.sort_unstable();
    Ok((Some(nodes), made))
}

/// `C_n K⁻¹ f` of each load, n_c, m: how far it moves the contact nodes where no contact force acts.
fn unopposed(problem: &ContactProblem, loading: &Loading, factor: &Cholesky) -> Result<Vec<Vec<f64>>, LinearError> {
    let mut u = vec![0.0; problem.displacements()];
    let mut moved = Vec::with_capacity(loading.cases().len());
    for case in loading.cases() {
        factor.solve(case.force(), &mut u)?;
        moved.push(problem.c_n().mul(&u));
    }
    Ok(moved)
}

/// `d`, n_c, m, where each load in proportion to its factor moves the contact nodes by `moved`.
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

/// How many contact nodes are within reach, and all of them, the nearest first.
fn within_reach(least: &[f64]) -> (usize, Vec<usize>) {
    let mut nearest: Vec<usize> = (0..least.len()).collect();
    nearest.sort_by(|&i, &k| least[i].total_cmp(&least[k]));
    let inside = nearest.partition_point(|&i| least[i] <= 0.0);
    (least.len().min(2 * inside), nearest)
}
