//! What a report needs of the increments, gathered while they go by.

use super::recording::RecordedIncrement;
use crate::history::{Observer, Status, Step};
use crate::model::Model;
use crate::nonlinear::{Flow, IterationRecord, LinearSystem};
use crate::report::{ForceRecord, Validity};

/// Stands before the observer of a run.
pub(super) struct Watch<'a> {
    model: &'a Model,
    observer: &'a mut dyn Observer,
    pub validity: Validity,
    /// The resultants of each increment so far.
    pub forces: Vec<ForceRecord>,
    keeps_last: bool,
    /// The last converged increment, where it is to be kept.
    pub last: Option<RecordedIncrement>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(model: &'a Model, keeps_last: bool, observer: &'a mut dyn Observer) -> Self {
        Watch { model, observer, validity: Validity::new(model), forces: Vec::new(), keeps_last, last: None }
    }
}

impl Observer for Watch<'_> {
    fn ready(&mut self) {
        self.observer.ready();
    }

    fn linear_system(&mut self, index: usize, system: &LinearSystem<'_>) -> Flow {
        self.observer.linear_system(index, system)
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> Flow {
        self.observer.iteration(index, record)
    }

    fn part(&mut self, part: &Step<'_>) {
        self.observer.part(part);
    }

    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.validity.see(self.model, step);
        self.forces.extend(ForceRecord::all(self.model, step));
        if self.keeps_last && step.record.status == Status::Converged {
            self.last = Some(RecordedIncrement::new(step));
        }
        self.observer.increment(step)
    }
}
