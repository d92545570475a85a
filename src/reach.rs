//! Which contact nodes loads and obstacles can bring into contact: those that condensed equations begin with.
//!
//! `S` of a condensed body is dense on all contact displacements, so that a node which stays far from its obstacle costs as much as
//! one that is pressed. With the displacements `ū(t)` of the body under its loads where no contact force acts, and
//! `d_i = min_t g_i(t) - (C_n ū(t))_i` over the ends of increments, obstacles go as deep as `D = max_i -d_i` into the body; what
//! bears them moves it about as far, so nodes with `d_i ≤ D` are within reach. That is an estimate and no bound: a lever moves more.
//! It decides what is solved with at first, and nothing of the answer, see [`HistorySettings::working_set`].
//!
//! [`HistorySettings::working_set`]: crate::history::HistorySettings::working_set

use crate::linear::cost::{self, Work};
use crate::linear::{LinearError, SparseCholesky};
use crate::loading::Loading;
use crate::problem::ContactProblem;

/// What contact nodes out of reach may cost, in terms of the work with the body itself: as long as it is no more, they stay.
pub const AFFORDABLE: f64 = 1.0;

/// What is left out must save this share of what all nodes cost, for it may have to join one by one.
const WORTHWHILE: f64 = 0.5;

/// The contact nodes, ascending, that condensed equations of `problem` under `loading` begin with, over increments that end at
/// `times` (s). `None` stands for all: in a body that contact alone holds, where all are cheap, and where too many are within reach.
/// Nodes out of reach stay, the nearest first, as long as what they cost is at most `affordable` times the work with the body.
///
/// # Errors
/// When memory is short for the factors of `K`, which loads ask for.
pub fn working_set(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    affordable: f64,
) -> Result<Option<Vec<usize>>, LinearError> {
    let all = problem.contacts();
    if all == 0 || !problem.free_motions().is_empty() {
        return Ok(None);
    }
    let (m, increments) = (problem.contact_displacements().len(), times.len());
    let work = Work { increments, factorizations: increments as f64, all_free: false };
    let of_contact = |nodes: usize| cost::border((m * nodes).div_ceil(all), &work);
    let most = (1.0 - WORTHWHILE) * of_contact(all);
    let spare =
        affordable * cost::body(problem.displacements(), problem.stiffness().lower().values().len(), increments);
    if of_contact(all) <= spare {
        return Ok(None);
    }
    let mut least = least_distances(loading, times, &[]);
    // Loads are not asked where obstacles alone meet too many.
    if of_contact(within_reach(&least).0) > most {
        return Ok(None);
    }
    if loading.largest_force() > 0.0 {
        let Some(moved) = unopposed(problem, loading)? else { return Ok(None) };
        least = least_distances(loading, times, &moved);
    }
    let (within, nearest) = within_reach(&least);
    let affordable = (0..all).find(|nodes| of_contact(nodes + 1) > spare).unwrap_or(all);
    let held = within.max(affordable).max(1);
    if of_contact(held) > most {
        return Ok(None);
    }
    let mut nodes = nearest[..held].to_vec();
    nodes.sort_unstable();
    Ok(Some(nodes))
}

/// `C_n K⁻¹ f` of each load, n_c, m: how far it moves the contact nodes where no contact force acts. `None` if that is without bounds.
fn unopposed(problem: &ContactProblem, loading: &Loading) -> Result<Option<Vec<Vec<f64>>>, LinearError> {
    let factor = match SparseCholesky::default().factor(problem.stiffness(), &[]) {
        Ok(factor) => factor,
        Err(LinearError::Singular { .. }) => return Ok(None),
        Err(error) => return Err(error),
    };
    let mut u = vec![0.0; problem.displacements()];
    let mut moved = Vec::with_capacity(loading.cases().len());
    for case in loading.cases() {
        factor.solve(case.force(), &mut u)?;
        moved.push(problem.c_n().mul(&u));
    }
    Ok(Some(moved))
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
    let deepest = nearest.first().map_or(0.0, |&i| (-least[i]).max(0.0));
    (nearest.partition_point(|&i| least[i] <= deepest), nearest)
}
