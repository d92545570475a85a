//! What an observer is told while an increment is solved.

use super::increment_result::IncrementResult;
use super::observer::{IncrementView, Observer};
use super::record::{ContactCounts, IncrementRecord, Seconds};
use crate::solver::laws::statuses_of;
use crate::solver::newton::Iteration;
use crate::solver::problem::{ContactProblem, Increment, State};
use std::ops::ControlFlow;

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
