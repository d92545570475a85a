//! Collects the data for a report during the increments.

use serde::{Deserialize, Serialize};

use super::force_jumps::JumpDetector;
use super::recording::RecordedIncrement;
use crate::body::model::Model;
use crate::run::report::{
    Accumulated, BalanceRecord, BalanceWatch, CycleWatch, EstimateWatch, ForceRecord, HistoryCurves, KeyWatch, Validity,
};
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::events::Event;
use crate::solver::history::{IncrementRecord, IncrementView, Observer, Status};
use crate::solver::newton::{IterationRecord, LinearSystem};
use crate::solver::problem::State;
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
    /// A ledger, which takes the records in place of the report.
    RecordWriter(&'a mut dyn RecordWriter),
}

impl Sink<'_> {
    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        match self {
            Sink::Observer(observer) => *observer,
            Sink::RecordWriter(ledger) => *ledger,
        }
    }
}

/// The collector of report data, which passes all calls on to the observer of a run.
pub(super) struct ReportCollector<'a, 'b> {
    model: &'a Model,
    audience: &'a mut Sink<'b>,
    pub validity: Validity,
    pub estimates: EstimateWatch,
    pub balance: BalanceWatch,
    pub curves: HistoryCurves,
    pub key: KeyWatch,
    /// The load cycle, if one is asked for.
    pub cycle: Option<CycleWatch>,
    /// The records of all increments so far; empty with a ledger.
    pub increments: Vec<IncrementRecord>,
    /// The resultants of the contact forces at the ends of increments.
    pub forces: Vec<ForceRecord>,
    /// The other forces on the body at the ends of increments.
    pub reactions: Vec<BalanceRecord>,
    /// The other forces on the body at the end of the last converged increment.
    pub last_reactions: Option<BalanceRecord>,
    keeps_last: bool,
    /// The last converged increment, if it must be kept or an exact path has ended early.
    pub last: Option<RecordedIncrement>,
    /// The increments, ascending from 1, for which the contact forces at the end are kept in `states`.
    numbers: &'a [usize],
    pub states: Vec<State>,
    pub leaps: JumpDetector,
}

/// The data between two increments.
#[derive(Serialize, Deserialize)]
struct Known {
    validity: Validity,
    seen: Accumulated,
    balance: BalanceWatch,
    curves: HistoryCurves,
    key: KeyWatch,
    cycle: Option<CycleWatch>,
    last_reactions: Option<BalanceRecord>,
    last: Option<RecordedIncrement>,
    states: Vec<State>,
    leaps: JumpDetector,
}

impl<'a, 'b> ReportCollector<'a, 'b> {
    pub(super) fn new(
        model: &'a Model,
        keeps_last: bool,
        numbers: &'a [usize],
        cycle: Option<CycleWatch>,
        leaps: JumpDetector,
        audience: &'a mut Sink<'b>,
    ) -> Self {
        ReportCollector {
            model,
            audience,
            validity: Validity::new(model),
            estimates: EstimateWatch::new(model),
            balance: BalanceWatch::default(),
            curves: HistoryCurves::default(),
            key: KeyWatch::default(),
            cycle,
            increments: Vec::new(),
            forces: Vec::new(),
            reactions: Vec::new(),
            last_reactions: None,
            keeps_last,
            last: None,
            numbers,
            states: Vec::new(),
            leaps,
        }
    }

    /// Resumes from the data in a `checkpoint`.
    pub(super) fn continue_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        let Known { validity, seen, balance, curves, key, cycle, last_reactions, last, states, leaps } =
            checkpoint.part(1)?;
        if !validity.fits(self.model) || !leaps.fit(self.model) || !self.estimates.go_on_with(self.model, seen) {
            return Err(CheckpointError::Other { what: "the mesh or its contact" });
        }
        let is_same_cycle = cycle.is_some() == self.cycle.is_some() && cycle.iter().all(|cycle| cycle.fits(self.model));
        if !is_same_cycle {
            return Err(CheckpointError::Other { what: "the load cycle" });
        }
        let before = self.numbers.iter().filter(|number| **number <= checkpoint.increments()).count();
        if states.len() != before || last.is_some() != self.keeps_last {
            return Err(CheckpointError::Other { what: "what is asked for (--companion, --uniqueness)" });
        }
        (self.validity, self.balance, self.curves) = (validity, balance, curves);
        (self.key, self.cycle) = (key, cycle);
        (self.last_reactions, self.last, self.states, self.leaps) = (last_reactions, last, states, leaps);
        Ok(())
    }

    /// Returns the record of a step with the strain energy of the body, if it differs from that of the history, which
    /// knows only nodal forces.
    fn record(&self, step: &IncrementView<'_>) -> Option<IncrementRecord> {
        let strain_energy = self.model.strain_energy(step.record.time, step.state)?;
        Some(IncrementRecord { strain_energy, ..step.record.clone() })
    }

    /// Passes an increment on to the observer, and its records to the ledger or the report.
    fn enter(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let flow = self.audience.observer().increment(step);
        let converged = step.record.status == Status::Converged;
        let forces = if converged { ForceRecord::all(self.model, step) } else { Vec::new() };
        let reactions = converged.then(|| BalanceRecord::new(self.model, step));
        self.curves.add(step.record, &forces);
        self.key.see(self.model.mesh.geometry, step, &forces);
        if let Some(reactions) = &reactions {
            self.balance.see(reactions);
        }
        match self.audience {
            Sink::RecordWriter(ledger) => ledger.add(step.record, &forces, reactions.as_ref()),
            Sink::Observer(_) => {
                self.increments.push(step.record.clone());
                self.forces.extend(forces);
                self.reactions.extend(reactions.clone());
            }
        }
        self.last_reactions = reactions.or(self.last_reactions.take());
        flow
    }
}

impl Observer for ReportCollector<'_, '_> {
    fn ready(&mut self) {
        self.audience.observer().ready();
    }

    fn linear_system(&mut self, index: usize, system: &LinearSystem<'_>) -> ControlFlow<()> {
        self.audience.observer().linear_system(index, system)
    }

    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.audience.observer().iteration(index, record)
    }

    fn event(&mut self, index: usize, event: &Event) {
        self.audience.observer().event(index, event);
    }

    fn part(&mut self, part: &IncrementView<'_>) {
        self.leaps.see(self.model, part);
        if let Some(cycle) = &mut self.cycle {
            cycle.part(self.model, part);
        }
        let record = self.record(part);
        self.audience.observer().part(&IncrementView { record: record.as_ref().unwrap_or(part.record), ..*part });
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let record = self.record(step);
        let step = &IncrementView { record: record.as_ref().unwrap_or(step.record), ..*step };
        self.validity.see(self.model, step);
        self.estimates.see(self.model, step);
        self.leaps.see(self.model, step);
        if let Some(cycle) = &mut self.cycle {
            cycle.see(self.model, step);
        }
        let converged = step.record.status == Status::Converged;
        if converged && self.numbers.binary_search(&step.record.index).is_ok() {
            self.states.push(tangential_forces(step.state));
        }
        if self.keeps_last && converged || step.record.status == Status::NoContinuation {
            self.last = Some(RecordedIncrement::new(step));
        }
        self.enter(step)
    }

    fn rest(&mut self, here: &dyn Fn() -> Checkpoint) {
        let ReportCollector {
            validity,
            estimates,
            balance,
            curves,
            key,
            cycle,
            last_reactions,
            last,
            states,
            leaps,
            audience,
            ..
        } = self;
        let known = || Known {
            validity: validity.clone(),
            seen: estimates.seen().clone(),
            balance: *balance,
            curves: curves.clone(),
            key: key.clone(),
            cycle: cycle.clone(),
            last_reactions: last_reactions.clone(),
            last: last.clone(),
            states: states.clone(),
            leaps: leaps.clone(),
        };
        audience.observer().rest(&|| here().with(&known()));
    }
}

/// Returns the tangential forces of a state, which a companion run compares.
pub(super) fn tangential_forces(State { p_t, p_o, .. }: &State) -> State {
    State { p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() }
}
