//! What an observer is told while an increment is solved.

use super::observer::{Observer, Step};
use super::record::{ContactCounts, IncrementRecord, Seconds};
use super::walked::Walked;
use crate::laws::statuses_of;
use crate::nonlinear::{Flow, Iteration};
use crate::problem::{ContactProblem, Increment, State};

/// The observer of increment `index`.
pub(super) struct Told<'a> {
    pub problem: &'a ContactProblem,
    pub index: usize,
    pub observer: &'a mut dyn Observer,
}

impl Told<'_> {
    pub(super) fn iteration(&mut self, iteration: &Iteration<'_>) -> Flow {
        let flow = iteration.system.map_or(Flow::Continue, |system| self.observer.linear_system(self.index, &system));
        if flow == Flow::Stop { flow } else { self.observer.iteration(self.index, &iteration.record) }
    }

    /// A part that ends at `time` before the increment does, by its `data` from where the body has been carried; observers are
    /// shown its `increment` and `state` from where it was at first.
    pub(super) fn part(
        &mut self,
        time: f64,
        data: &Increment<'_>,
        walked: &Walked,
        increment: &Increment<'_>,
        state: &State,
    ) {
        let statuses = statuses_of(self.problem, data, &walked.attempt.state, &walked.attempt.scales);
        let counts = ContactCounts::of(&statuses);
        let record = record(self.problem, data.force, self.index, time, walked, counts, Seconds::default());
        self.observer.part(&Step { record: &record, increment, state, statuses: &statuses });
    }
}

/// What is recorded of an increment, or of it so far.
pub(super) fn record(
    problem: &ContactProblem,
    force: &[f64],
    index: usize,
    time: f64,
    walked: &Walked,
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
        strain_energy: problem.energy_in_equilibrium(force, &walked.attempt.state),
        seconds,
    }
}
