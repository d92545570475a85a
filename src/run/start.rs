//! Loads and interference that exist at t = 0.
//!
//! The first increment leads from the unloaded body to its own end. It applies the actions at t = 0 together with their
//! changes until then, so the friction at its end depends on its length. To estimate this error, the first two
//! increments are solved again after an additional increment, which is as short as rounding permits and applies the
//! actions at t = 0. Interference that is too small to matter, such as the rounding of gaps, is none.

use super::{Run, RunError};
use crate::body::model::Model;
use crate::solver::formulation::Layout;
use crate::solver::history::{HistorySettings, Observer, Status};
use crate::solver::newton::IterationRecord;
use crate::solver::problem::State;
use std::ops::ControlFlow;

/// The length of the increment that applies the actions at t = 0, relative to the first increment.
const AT_ONCE: f64 = 1e-9;

/// Interference is none if the contact forces that press it back, those of one node after the other, are at most this share of
/// the largest contact forces: a fiftieth of the error of friction that is told.
const NONE: f64 = 1e-3;

impl Run<'_> {
    /// Returns the error of the friction forces at the end of the second increment, or of the only one, as a share of
    /// the largest possible friction there, both as the root of `Σ |p|² / l`. The reference has an increment of its own
    /// for the actions at t = 0. Returns `None` if there are no such actions, nothing changes, or a history does not
    /// converge. `largest` are the largest contact forces of the history, as the root of `Σ |p|² / l`.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    pub(super) fn friction_by_start(&self, largest: f64, observer: &mut dyn Observer) -> Result<Option<f64>, RunError> {
        let times = &self.times[..self.times.len().min(2)];
        let Some(&first) = times.first() else { return Ok(None) };
        if self.solver.method.is_exact_path() || !begins_loaded(&self.model, first, largest) {
            return Ok(None);
        }
        let settings = HistorySettings { keeps_records: false, ..self.settings()? };
        let mut last = |times: &[f64]| -> Result<Option<State>, RunError> {
            let outcome = self.history_with(self.system(), times, &settings, &mut OnlyIterations(observer))?;
            Ok((outcome.status == Status::Converged).then_some(outcome.state))
        };
        let Some(together) = last(times)? else { return Ok(None) };
        let Some(apart) = last(&[&[AT_ONCE * first], times].concat())? else { return Ok(None) };
        Ok(times.last().and_then(|&at| difference(&self.model, at, &together, &apart)))
    }
}

/// An observer of a run that sees only the iterations of an additional solution, at which it may stop it.
struct OnlyIterations<'a>(&'a mut dyn Observer);

impl Observer for OnlyIterations<'_> {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.0.iteration(index, record)
    }
}

/// Returns `true` if a problem with friction has loads or interference at t = 0 that change until the time `first` (s).
fn begins_loaded(model: &Model, first: f64, largest: f64) -> bool {
    let (problem, loading) = (&model.problem, &model.loading);
    let layout = Layout::new(problem);
    if !(0..layout.contacts()).any(|i| layout.has_friction(i)) {
        return false;
    }
    let forces = [0.0, first].map(|t| {
        let mut force = vec![0.0; problem.displacements()];
        loading.force(t, &mut force);
        force
    });
    let gaps = [0.0, first].map(|t| loading.gaps_at(t));
    let drifts = [0.0, first].map(|t| [0, 1].map(|k| loading.drift_at(t, k)));
    let interferes = || {
        let stiffness = problem.contact_stiffness();
        problem.force_norm(|i| [stiffness[i] * gaps[0][i].min(0.0)]) > NONE * largest
    };
    let overlap = gaps[0].iter().any(|gap| *gap < 0.0);
    let is_loaded = forces[0].iter().any(|f| *f != 0.0) || overlap && interferes();
    is_loaded && (forces[0] != forces[1] || gaps[0] != gaps[1] || drifts[0] != drifts[1])
}

/// Returns the difference of the friction forces of two states at the time `at` (s), as a share of the largest friction
/// possible in `b`.
fn difference(model: &Model, at: f64, a: &State, b: &State) -> Option<f64> {
    let problem = &model.problem;
    let mu = model.loading.friction().map_or_else(|| problem.mu().to_vec(), |friction| friction.at(at));
    let apart = problem.force_norm(|i| [a.p_t[i] - b.p_t[i], a.p_o[i] - b.p_o[i]]);
    let bound = problem.force_norm(|i| [mu[i] * b.p_n[i]]);
    (bound > 0.0).then(|| apart / bound)
}
