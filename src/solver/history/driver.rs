//! The driver of a history: the loop over its increments, within a loop over stages.

use super::body::Body;
use super::increment::{IncrementDriver, IncrementEnd, IncrementObserver, WorkingSet};
use super::record::{IncrementRecord, IncrementView, Observer, Seconds, Status};
use super::saved::{RunOf, Saved, SavedStage};
use super::settings::HistorySettings;
use super::stage::Stage;
use super::state::{HistoryState, Step};
use super::system::statistics;
use super::task::Algorithm;
use super::{Error, HistoryOutcome};
use crate::algebra::linear::{Dense, LinearError, RefinedSolver, Statistics};
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::condensation::{Condensation, Condensed};
use crate::solver::laws::{Judgement, statuses_of};
use crate::solver::loading::Loading;
use crate::solver::newton::Termination;
use crate::solver::problem::ContactProblem;
use std::time::Instant;

/// The driver of a history with one or several stages.
pub(super) struct HistoryDriver<'a> {
    /// The whole body.
    pub body: Body<'a>,
    /// The ends of all increments, s.
    pub times: &'a [f64],
    pub settings: &'a HistorySettings,
    pub observer: &'a mut dyn Observer,
    pub outcome: HistoryOutcome,
    pub history: &'a mut HistoryState,
    /// The start of the history.
    pub start: Instant,
    /// The start of the increment in progress, and the statistics of the linear solver at that time.
    pub increment_clock: Option<(Instant, Statistics)>,
    /// The statistics of the linear solver in the earlier stages.
    pub done: Statistics,
    /// The number of contact nodes that joined the working set since the end of the last increment.
    pub joined: usize,
    /// `true` if [`super::Observer::ready`] has been called.
    pub is_ready: bool,
    /// The saved stage, until it is restored.
    pub saved: Option<SavedStage>,
}

impl<'a> HistoryDriver<'a> {
    /// Creates a driver that has solved nothing and goes on from `history`.
    pub(super) fn new(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        times: &'a [f64],
        settings: &'a HistorySettings,
        observer: &'a mut dyn Observer,
        history: &'a mut HistoryState,
    ) -> Self {
        HistoryDriver {
            body: Body { problem, loading, condensed: None },
            times,
            settings,
            observer,
            outcome: HistoryOutcome::unsolved(problem),
            history,
            start: Instant::now(),
            increment_clock: None,
            done: Statistics::default(),
            joined: 0,
            is_ready: false,
            saved: None,
        }
    }

    /// Resumes from the checkpoint in the settings, if there is one.
    ///
    /// # Errors
    /// If the checkpoint belongs to another history.
    pub(super) fn resume(&mut self) -> Result<(), Error> {
        let Some(from) = &self.settings.from else { return Ok(()) };
        let Saved { outcome, history, stage, statistics, .. } =
            Saved::read(from, self.body.problem, self.body.loading, self.times, self.settings)?;
        self.outcome.resume(outcome);
        (*self.history, self.done, self.saved) = (history, statistics, Some(stage));
        Ok(())
    }

    /// Solves the history on the contact displacements.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(super) fn condensed(&mut self, algorithm: &dyn Algorithm, condensation: &Condensation) -> Result<(), Error> {
        let all = self.body.problem.contacts();
        let asked_for = self.settings.working_set.as_ref().filter(|_| self.body.problem.rigid_modes().is_empty());
        let mut nodes = asked_for.filter(|nodes| nodes.len() < all).cloned();
        let mut resumes = self.saved.is_some();
        if let Some(saved) = &mut self.saved {
            nodes = saved.nodes.take();
        }
        loop {
            let subset = nodes.take().and_then(|nodes| Some((algorithm.of_nodes(&nodes)?, nodes)));
            let size = subset.as_ref().map_or(all, |(_, nodes)| nodes.len());
            if !std::mem::take(&mut resumes) && (subset.is_some() || self.outcome.working_set.is_some()) {
                let first = WorkingSet { first: size, last: size, all, grown: 0 };
                let grown = |before: WorkingSet| WorkingSet { last: size, grown: before.grown + 1, ..before };
                self.outcome.working_set = Some(self.outcome.working_set.map_or(first, grown));
            }
            match self.condensed_stage(algorithm, condensation, subset) {
                Ok(None) => return Ok(()),
                Ok(Some(more)) => {
                    self.joined += more.len() - size;
                    nodes = (more.len() < all).then_some(more);
                }
                Err(Error::Linear(LinearError::OutOfMemory { .. })) if self.increment_clock.is_some() => {
                    self.outcome.status = Status::OutOfMemory;
                    return Ok(());
                }
                Err(error) => return Err(error),
            }
        }
    }

    /// Solves one stage on all contact nodes, or on a working set with a method for it.
    fn condensed_stage(
        &mut self,
        algorithm: &dyn Algorithm,
        condensation: &Condensation,
        subset: Option<(Box<dyn Algorithm>, Vec<usize>)>,
    ) -> Result<Option<Vec<usize>>, Error> {
        let (own, condensed) = match subset {
            Some((own, nodes)) => {
                (Some(own), Condensed::of_nodes(self.body.problem, self.body.loading, nodes, condensation.cholesky()))
            }
            None => (None, Condensed::new(self.body.problem, self.body.loading, condensation.clone())),
        };
        let condensed = match condensed {
            Ok(condensed) => condensed,
            Err(LinearError::Singular { .. }) => {
                self.outcome.end_unconstrained(algorithm, self.body.problem, self.body.loading);
                return Ok(None);
            }
            Err(error) => return Err(error.into()),
        };
        let mut dense = RefinedSolver::new(Box::new(Dense::default())).after(self.done);
        let body = Body { condensed: Some(&condensed), ..self.body };
        self.stage(own.as_deref().unwrap_or(algorithm), body, &mut dense)
    }

    /// Solves the rest of the history of the `body` with `linear`. Returns `None` at its end, or the
    /// larger working set needed to continue.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(super) fn stage(
        &mut self,
        algorithm: &dyn Algorithm,
        body: Body<'_>,
        linear: &mut RefinedSolver,
    ) -> Result<Option<Vec<usize>>, Error> {
        match self.set_up(algorithm, body, linear)? {
            Some(mut stage) => self.increments(&mut stage, body, linear),
            None => Ok(None),
        }
    }

    /// Sets up the equations. Returns `None`, and the outcome has the verdict, if the body is unconstrained even with
    /// clamped contact nodes.
    pub(super) fn set_up(
        &mut self,
        algorithm: &dyn Algorithm,
        body: Body<'_>,
        linear: &mut RefinedSolver,
    ) -> Result<Option<Stage>, Error> {
        let stage = Stage::new(body, self.settings, algorithm, linear)?;
        let factor = body.condensed.map(Condensed::info);
        self.outcome.linear = statistics(*linear.statistics(), factor, self.history.worst_backward_error);
        let mut stage = match stage {
            Ok(stage) => stage,
            Err(free_motion) => {
                self.outcome.status = Status::Singular;
                self.outcome.free_motion = free_motion;
                return Ok(None);
            }
        };
        if !std::mem::replace(&mut self.is_ready, true) {
            self.outcome.setup_seconds = self.start.elapsed().as_secs_f64();
            self.observer.ready();
        }
        stage.continue_from(self.history, body);
        Ok(Some(stage))
    }

    /// Solves the increments that are left, up to the first that does not converge. Returns the larger working set
    /// needed to continue, if the equations lack contact nodes.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(super) fn increments(
        &mut self,
        stage: &mut Stage,
        body: Body<'_>,
        linear: &mut RefinedSolver,
    ) -> Result<Option<Vec<usize>>, Error> {
        let HistoryDriver { times, settings, .. } = *self;
        let (problem, factor) = (body.problem, body.condensed.map(Condensed::info));
        let mut driver = IncrementDriver { body, settings, stage, history: &mut *self.history };
        let (outcome, observer) = (&mut self.outcome, &mut *self.observer);

        if let Some(saved) = self.saved.take() {
            if !driver.stage.method.restore(saved.snapshot, linear)? {
                return Err(CheckpointError::Other { what: "the method" }.into());
            }
            // Keeps the earlier value if there is nothing left to solve.
            outcome.linear.factor = statistics(self.done, factor, 0.0).factor;
        }
        while let Some(&time) = times.get(outcome.tally.increments) {
            let index = outcome.tally.increments + 1;
            let (began, before) = self.increment_clock.take().unwrap_or_else(|| (Instant::now(), *linear.statistics()));
            let mut progress = IncrementObserver { problem, index, observer: &mut *observer, has_stopped: false };
            let increment = match driver.increment(time, linear, &mut progress) {
                Ok(IncrementEnd::Ended(increment)) => increment,
                Ok(IncrementEnd::NeedsNodes(nodes)) => {
                    self.increment_clock = Some((began, before));
                    self.done = *linear.statistics();
                    return Ok(Some(nodes));
                }
                Err(error) => return outcome.end_by(error).map(|()| None),
            };
            let statuses = statuses_of(problem, &driver.data(), &increment.state);
            let seconds = Seconds::between(
                &before,
                linear.statistics(),
                increment.solved.assembly_seconds,
                began.elapsed().as_secs_f64(),
            );
            let joined = std::mem::take(&mut self.joined);
            let at = (index, time, driver.data().force);
            let record = IncrementRecord { joined, ..increment.record(problem, at, &statuses, seconds) };
            let Step { solved, state, scales, status, slip, .. } = *increment;
            let (flow, shown) = driver.show(&state, |increment, state| {
                let step = IncrementView { record: &record, increment, state, statuses: &statuses };
                (progress.observer.increment(&step), state.clone())
            });
            outcome.push(record, settings.keeps_records);
            outcome.linear = statistics(*linear.statistics(), factor, driver.history.worst_backward_error);
            if status != Status::Converged || index == times.len() {
                let data = driver.data();
                let judgement = Judgement::near(problem, &data, &state, &scales, settings.tolerance)?;
                outcome.rounding = judgement.rounding();
                outcome.violation = (status != Status::Converged).then(|| judgement.worst());
            }
            outcome.status = status;
            outcome.reached = driver.history.reached.unwrap_or(0.0);
            outcome.slip = slip;
            if status != Status::Converged {
                if let Termination::Unconstrained(motion)
                | Termination::NoEquilibrium(motion)
                | Termination::Slips(motion) = solved.stop
                {
                    outcome.free_motion = Some(motion);
                }
                return Ok(None);
            }
            outcome.state = shown;
            outcome.increment_error = driver.increment_error();
            outcome.scales = scales;
            if flow.is_break() && index < times.len() {
                outcome.status = Status::Interrupted;
                return Ok(None);
            }
            observer.checkpoint_offered(&|| outcome.checkpoint(&driver, &times[..index], linear));
        }
        Ok(None)
    }
}

impl HistoryOutcome {
    /// Creates a checkpoint after the increments so far, which end at `times`.
    fn checkpoint(&self, driver: &IncrementDriver<'_>, times: &[f64], linear: &RefinedSolver) -> Checkpoint {
        let nodes = driver.body.nodes().map(<[usize]>::to_vec);
        let saved = Saved {
            run: RunOf::new(driver.body.problem, driver.body.loading, times, driver.settings),
            outcome: self.so_far(),
            history: driver.history.clone(),
            stage: SavedStage { snapshot: driver.stage.method.snapshot(linear), nodes },
            statistics: *linear.statistics(),
        };
        Checkpoint::new(self.tally.increments, self.reached, &saved)
    }

    /// Ends the history after an error of the linear solver. Lack of memory is a verdict.
    fn end_by(&mut self, error: LinearError) -> Result<(), Error> {
        match error {
            LinearError::OutOfMemory { .. } => {
                self.status = Status::OutOfMemory;
                Ok(())
            }
            error => Err(error.into()),
        }
    }
}
