//! Watching a history.

use super::record::{ContactCounts, IncrementRecord, Seconds};
use super::state::IncrementResult;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::events::Event;
use crate::solver::laws::{ContactStatus, statuses_of};
use crate::solver::newton::{Iteration, IterationRecord, LinearSystem};
use crate::solver::problem::{ContactProblem, Increment, State};
use std::ops::ControlFlow;

/// An increment with its data and state, for an observer.
#[derive(Debug, Clone, Copy)]
pub struct IncrementView<'a> {
    /// The record.
    pub record: &'a IncrementRecord,
    /// What drove the increment.
    pub increment: &'a Increment<'a>,
    /// The state at its end.
    pub state: &'a State,
    /// The status of each contact node.
    pub statuses: &'a [ContactStatus],
}

/// Watches a history: for progress, files, plots, or to stop it.
pub trait Observer {
    /// When the patterns are analysed and the first matrix is factored, before the first increment.
    fn ready(&mut self) {}
    /// Whether it wants to see increment `index` before the next one is begun. On a condensed body increments that nobody waits
    /// for are solved up to sixteen at a time, and shown, each with its verdict, when all of them are judged: that takes less
    /// time, and iterations of later ones have been told by then.
    fn waits_for(&mut self, _index: usize) -> bool {
        true
    }
    /// At the start of the iteration of increment `index`, and after each of its steps.
    fn iteration(&mut self, _index: usize, _record: &IterationRecord) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// After each step of increment `index`, before [`Observer::iteration`]: the linearised equations that gave it, as
    /// they were solved. Where the body is condensed, they are those of the contact displacements.
    fn linear_system(&mut self, _index: usize, _system: &LinearSystem<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// After a contact node has changed its status in increment `index`, where the exact path is followed.
    fn event(&mut self, _index: usize, _event: &Event) {}

    /// After each part of an increment that had to be halved, but the one that ends it. The record is that of the increment
    /// so far: its `time` is the end of the part, its `parts` the number of the part from 1.
    fn part(&mut self, _part: &IncrementView<'_>) {}

    /// After each increment, the failed one included.
    fn increment(&mut self, _step: &IncrementView<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Between two increments, and after the last: where the history can be taken up again. `here` makes the checkpoint, which
    /// costs a copy of the state. Increments that are solved together have one such place, after all of them.
    fn rest(&mut self, _here: &dyn Fn() -> Checkpoint) {}
}

/// An observer that only lets things happen.
impl Observer for () {
    fn waits_for(&mut self, _index: usize) -> bool {
        false
    }
}

/// The observer of increment `index`.
pub(super) struct Progress<'a> {
    pub problem: &'a ContactProblem,
    pub index: usize,
    pub observer: &'a mut dyn Observer,
}

impl Progress<'_> {
    pub(super) fn iteration(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        let flow = iteration
            .system
            .map_or(ControlFlow::Continue(()), |system| self.observer.linear_system(self.index, &system));
        if flow.is_break() { flow } else { self.observer.iteration(self.index, &iteration.record) }
    }

    /// A part that ends at `time` before the increment does, by its `data` from where the body has been carried; observers are
    /// shown its `increment` and `state` from where it was at first.
    pub(super) fn part(
        &mut self,
        time: f64,
        data: &Increment<'_>,
        walked: &IncrementResult,
        increment: &Increment<'_>,
        state: &State,
    ) {
        let statuses = statuses_of(self.problem, data, &walked.substep.state, &walked.substep.scales);
        let counts = ContactCounts::of(&statuses);
        let record = record(self.problem, data.force, self.index, time, walked, counts, Seconds::default());
        self.observer.part(&IncrementView { record: &record, increment, state, statuses: &statuses });
    }
}

/// What is recorded of an increment, or of it so far.
pub(super) fn record(
    problem: &ContactProblem,
    force: &[f64],
    index: usize,
    time: f64,
    walked: &IncrementResult,
    contact: ContactCounts,
    seconds: Seconds,
) -> IncrementRecord {
    let solved = &walked.solved;
    IncrementRecord {
        index,
        time,
        status: walked.status,
        parts: walked.ends.len(),
        part_ends: if walked.ends == [time] { Vec::new() } else { walked.ends.clone() },
        joined: 0,
        jumps: 0,
        rescued: solved.rescued,
        iterations: solved.iterations,
        backtracks: solved.backtracks,
        theta: solved.theta,
        kkt: walked.kkt,
        backward_error: solved.backward_error,
        contact,
        friction_work: walked.friction_work,
        strain_energy: problem.energy_in_equilibrium(force, &walked.substep.state),
        seconds,
    }
}
