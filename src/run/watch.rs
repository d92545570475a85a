//! Collects the data for a report during the increments.

use serde::{Deserialize, Serialize};

use super::checks::{BalanceWatch, Checks};
use super::force_jumps::JumpDetector;
use super::recording::RecordedIncrement;
use crate::body::model::Model;
use crate::run::report::{
    BalanceRecord, CycleWatch, EstimateWatch, ForceRecord, HistoryCurves, KeyWatch, PretensionForce,
};
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::events::Event;
use crate::solver::history::{IncrementRecord, IncrementView, Observer, Status};
use crate::solver::newton::{IterationRecord, LinearSystem};
use std::ops::ControlFlow;

/// Takes the records of a run as they are made, in place of its report. The records of millions of increments would
/// fill the memory.
pub trait RecordWriter: Observer {
    /// Takes the record of an increment, and the forces at its end if it converged. Called after
    /// [`Observer::increment`].
    fn add(&mut self, record: &IncrementRecord, forces: &[ForceRecord], reactions: Option<&BalanceRecord>);
}

/// The receiver of the results of a run.
pub enum Sink<'a> {
    /// An observer; the records go into the report.
    Observer(&'a mut dyn Observer),
    /// A writer, which takes the records in place of the report.
    RecordWriter(&'a mut dyn RecordWriter),
}

impl Sink<'_> {
    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        match self {
            Sink::Observer(observer) => *observer,
            Sink::RecordWriter(writer) => *writer,
        }
    }
}

/// All that a run collects in its increments: the state that a checkpoint stores, from which the report is made.
#[derive(Default, Serialize, Deserialize)]
pub(super) struct Watches {
    /// The sizes of the model, to which all indices belong.
    sizes: [usize; 7],
    pub checks: Checks,
    pub estimates: EstimateWatch,
    pub balance: BalanceWatch,
    pub curves: HistoryCurves,
    pub key: KeyWatch,
    pub pretensions: Vec<PretensionForce>,
    /// The load cycle, if one is asked for.
    pub cycle: Option<CycleWatch>,
    pub jumps: JumpDetector,
    /// The other forces on the body at the end of the last converged increment.
    pub last_reactions: Option<BalanceRecord>,
    /// The last converged increment, if it must be kept or an exact path has ended early.
    pub last: Option<RecordedIncrement>,
    /// The records of the increments of this process; empty with a writer.
    #[serde(skip)]
    pub increments: Vec<IncrementRecord>,
    /// The resultants of the contact forces at the ends of these increments.
    #[serde(skip)]
    pub forces: Vec<ForceRecord>,
    /// The other forces on the body at the ends of these increments.
    #[serde(skip)]
    pub reactions: Vec<BalanceRecord>,
}

impl Watches {
    /// Begins with the first increment of `model`.
    pub(super) fn new(model: &Model, cycle: Option<CycleWatch>, jumps: JumpDetector) -> Self {
        let sizes = [
            model.mesh.nodes.len(),
            model.contact.nodes.len(),
            model.contact.boundaries.len(),
            model.contact.pairs.len(),
            model.contact.obstacles.len(),
            model.description().couplings.len(),
            model.constraints.rigid_motions.len(),
        ];
        Watches { sizes, estimates: EstimateWatch::new(model), cycle, jumps, ..Watches::default() }
    }
}

/// The collector of report data, which passes all calls on to the observer of a run.
pub(super) struct ReportCollector<'a, 'b> {
    pub model: &'a Model,
    pub sink: &'a mut Sink<'b>,
    pub watches: Watches,
    pub keeps_last: bool,
}

impl ReportCollector<'_, '_> {
    /// Resumes from the data in a `checkpoint`.
    pub(super) fn continue_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        let stored: Watches = checkpoint.part(1)?;
        let what = if stored.sizes != self.watches.sizes {
            "the mesh or its contact"
        } else if stored.cycle.is_some() != self.watches.cycle.is_some() {
            "the load cycle"
        } else if stored.last.is_some() != self.keeps_last {
            "what is asked for (--uniqueness)"
        } else {
            let fit = stored.checks.fit(self.model)
                && stored.jumps.fit(self.model)
                && stored.cycle.iter().all(|cycle| cycle.fits(self.model));
            let estimates = stored.estimates.of(self.model).filter(|_| fit);
            let estimates = estimates.ok_or(CheckpointError::Damaged)?;
            self.watches = Watches { estimates, ..stored };
            return Ok(());
        };
        Err(CheckpointError::Other { what })
    }

    /// Returns the record of a step with the strain energy of the body, if it differs from that of the history, which
    /// knows only nodal forces.
    fn record(&self, step: &IncrementView<'_>) -> Option<IncrementRecord> {
        let strain_energy = self.model.strain_energy(step.record.time, step.state)?;
        Some(IncrementRecord { strain_energy, ..step.record.clone() })
    }
}

impl Observer for ReportCollector<'_, '_> {
    fn ready(&mut self) {
        self.sink.observer().ready();
    }

    fn linear_system(&mut self, index: usize, system: &LinearSystem<'_>) -> ControlFlow<()> {
        self.sink.observer().linear_system(index, system)
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.sink.observer().iteration(index, record)
    }

    fn event(&mut self, index: usize, event: &Event) {
        self.sink.observer().event(index, event);
    }

    fn substep(&mut self, substep: &IncrementView<'_>) {
        self.watches.jumps.observe(self.model, substep);
        if let Some(cycle) = &mut self.watches.cycle {
            cycle.substep(self.model, substep);
        }
        let record = self.record(substep);
        self.sink.observer().substep(&IncrementView { record: record.as_ref().unwrap_or(substep.record), ..*substep });
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let record = self.record(step);
        let (model, step) = (self.model, &IncrementView { record: record.as_ref().unwrap_or(step.record), ..*step });
        let converged = step.record.status == Status::Converged;
        let watches = &mut self.watches;
        watches.checks.observe(model, step);
        watches.estimates.observe(model, step);
        watches.jumps.observe(model, step);
        if let Some(cycle) = &mut watches.cycle {
            cycle.observe(model, step);
        }
        if self.keeps_last && converged || step.record.status == Status::NoContinuation {
            watches.last = Some(RecordedIncrement::new(step));
        }
        let flow = self.sink.observer().increment(step);
        let forces = if converged { ForceRecord::all(model, step) } else { Vec::new() };
        let reactions = converged.then(|| BalanceRecord::new(model, step));
        watches.curves.add(step.record, &forces);
        watches.key.observe(model.mesh.geometry, step, &forces);
        if let Some(reactions) = &reactions {
            watches.balance.observe(reactions);
            PretensionForce::observe(&mut watches.pretensions, reactions, &model.description().pretensions);
        }
        match self.sink {
            Sink::RecordWriter(writer) => writer.add(step.record, &forces, reactions.as_ref()),
            Sink::Observer(_) => {
                watches.increments.push(step.record.clone());
                watches.forces.extend(forces);
                watches.reactions.extend(reactions.clone());
            }
        }
        watches.last_reactions = reactions.or(watches.last_reactions.take());
        flow
    }

    fn checkpoint_offered(&mut self, here: &dyn Fn() -> Checkpoint) {
        let watches = &self.watches;
        self.sink.observer().checkpoint_offered(&|| here().with(watches));
    }
}
