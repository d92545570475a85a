//! What a report needs of the increments, gathered while they go by.

use super::recording::RecordedIncrement;
use crate::events::Event;
use crate::history::{IncrementRecord, Observer, Status, Step};
use crate::model::Model;
use crate::nonlinear::{Flow, IterationRecord, LinearSystem};
use crate::report::{BalanceRecord, EstimateWatch, ForceRecord, Validity};

/// Stands before the observer of a run.
pub(super) struct Watch<'a> {
    model: &'a Model,
    observer: &'a mut dyn Observer,
    pub validity: Validity,
    pub estimates: EstimateWatch,
    /// The strain energy at the end of each increment so far, J.
    pub energies: Vec<f64>,
    /// The resultants of each increment so far.
    pub forces: Vec<ForceRecord>,
    /// What else acted on the body.
    pub reactions: Vec<BalanceRecord>,
    keeps_last: bool,
    /// The last converged increment, where it is to be kept, or where an exact path is lost.
    pub last: Option<RecordedIncrement>,
}

impl<'a> Watch<'a> {
    pub(super) fn new(model: &'a Model, keeps_last: bool, observer: &'a mut dyn Observer) -> Self {
        Watch {
            model,
            observer,
            validity: Validity::new(model),
            estimates: EstimateWatch::new(model),
            energies: Vec::new(),
            forces: Vec::new(),
            reactions: Vec::new(),
            keeps_last,
            last: None,
        }
    }
}

impl Watch<'_> {
    /// The record of a step with the energy of the body, where a history, which knows the forces of loads and supports only,
    /// has another.
    fn record(&self, step: &Step<'_>) -> Option<IncrementRecord> {
        let strain_energy = self.model.strain_energy(step.record.time, step.state)?;
        Some(IncrementRecord { strain_energy, ..step.record.clone() })
    }
}

impl Observer for Watch<'_> {
    fn ready(&mut self) {
        self.observer.ready();
    }

    fn waits_for(&mut self, index: usize) -> bool {
        self.observer.waits_for(index)
    }

    fn linear_system(&mut self, index: usize, system: &LinearSystem<'_>) -> Flow {
        self.observer.linear_system(index, system)
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> Flow {
        self.observer.iteration(index, record)
    }

    fn event(&mut self, index: usize, event: &Event) {
        self.observer.event(index, event);
    }

    fn part(&mut self, part: &Step<'_>) {
        let record = self.record(part);
        self.observer.part(&Step { record: record.as_ref().unwrap_or(part.record), ..*part });
    }

    fn increment(&mut self, step: &Step<'_>) -> Flow {
        let record = self.record(step);
        let step = &Step { record: record.as_ref().unwrap_or(step.record), ..*step };
        self.energies.push(step.record.strain_energy);
        self.validity.see(self.model, step);
        self.estimates.see(self.model, step);
        if step.record.status == Status::Converged {
            self.forces.extend(ForceRecord::all(self.model, step));
            self.reactions.push(BalanceRecord::new(self.model, step));
        }
        let is_lost = step.record.status == Status::NoContinuation;
        if is_lost || self.keeps_last && step.record.status == Status::Converged {
            self.last = Some(RecordedIncrement::new(step));
        }
        self.observer.increment(step)
    }
}
