//! Observers of a history.

use super::record::{ContactCounts, IncrementRecord, Seconds};
use super::state::StepResult;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::events::Event;
use crate::solver::laws::{ContactStatus, statuses_of};
use crate::solver::newton::{Iteration, IterationRecord, LinearSystem};
use crate::solver::problem::{ContactProblem, Increment, State};
use std::ops::ControlFlow;

/// An increment with its data and state, for an observer.
#[derive(Debug, Clone, Copy)]
pub struct IncrementView<'a> {
    /// The record of the increment.
    pub record: &'a IncrementRecord,
    /// The data of the increment.
    pub increment: &'a Increment<'a>,
    /// The state at the end of the increment.
    pub state: &'a State,
    /// The status of each contact node.
    pub statuses: &'a [ContactStatus],
}

/// An observer of a history: for progress, files and plots, or to stop it.
pub trait Observer {
    /// Called before the first increment, when the patterns are analysed and the first matrix is factored.
    fn ready(&mut self) {}
    /// Called at the start of the iteration of increment `index`, and after each of its steps.
    fn iteration(&mut self, _index: usize, _record: &IterationRecord) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// Called after each step of increment `index`, before [`Observer::iteration`], with the linearised equations of
    /// the step as they were solved. If the body is condensed, they are those of the contact displacements.
    fn linear_system(&mut self, _index: usize, _system: &LinearSystem<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called after a contact node has changed its status in increment `index` of an exact path.
    fn event(&mut self, _index: usize, _event: &Event) {}

    /// Called after each substep of a halved increment except the last. The record is that of the increment so far:
    /// its `time` is the end of the substep, its `parts` the number of the substep from 1.
    fn part(&mut self, _part: &IncrementView<'_>) {}

    /// Called after each increment, including a failed one.
    fn increment(&mut self, _step: &IncrementView<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called between two increments and after the last, where the history can be resumed. `here` makes the
    /// checkpoint, which costs a copy of the state.
    fn rest(&mut self, _here: &dyn Fn() -> Checkpoint) {}
}

/// An observer that does nothing.
impl Observer for () {}

/// The observer of increment `index`.
pub(super) struct IncrementObserver<'a> {
    pub problem: &'a ContactProblem,
    pub index: usize,
    pub observer: &'a mut dyn Observer,
}

impl IncrementObserver<'_> {
    pub(super) fn iteration(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        let flow = iteration
            .system
            .map_or(ControlFlow::Continue(()), |system| self.observer.linear_system(self.index, &system));
        if flow.is_break() { flow } else { self.observer.iteration(self.index, &iteration.record) }
    }

    /// Reports a converged substep that ends at `time`. `data` is relative to the rigid offset; observers receive
    /// `increment` and `state` relative to the initial configuration.
    pub(super) fn part(
        &mut self,
        time: f64,
        data: &Increment<'_>,
        result: &StepResult,
        increment: &Increment<'_>,
        state: &State,
    ) {
        let statuses = statuses_of(self.problem, data, &result.state);
        let counts = ContactCounts::of(&statuses);
        let record = record(self.problem, data.force, self.index, time, result, counts, Seconds::default());
        self.observer.part(&IncrementView { record: &record, increment, state, statuses: &statuses });
    }
}

/// Creates the record of an increment, or of an increment so far.
pub(super) fn record(
    problem: &ContactProblem,
    force: &[f64],
    index: usize,
    time: f64,
    result: &StepResult,
    contact: ContactCounts,
    seconds: Seconds,
) -> IncrementRecord {
    let solved = &result.solved;
    IncrementRecord {
        index,
        time,
        status: result.status,
        parts: result.ends.len(),
        part_ends: if result.ends == [time] { Vec::new() } else { result.ends.clone() },
        joined: 0,
        jumps: 0,
        attempts: solved.attempts,
        rescued: solved.rescued,
        iterations: solved.iterations,
        backtracks: solved.backtracks,
        theta: solved.theta,
        kkt: result.kkt,
        backward_error: solved.backward_error,
        contact,
        friction_work: result.friction_work,
        strain_energy: problem.energy_in_equilibrium(force, &result.state),
        seconds,
    }
}
