//! What a report needs of the increments, gathered while they go by.

use serde::{Deserialize, Serialize};

use super::leaps::Leaps;
use super::recording::RecordedIncrement;
use crate::body::model::Model;
use crate::run::report::{BalanceRecord, BalanceWatch, EstimateWatch, ForceRecord, HistoryCurves, Seen, Validity};
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::events::Event;
use crate::solver::history::{IncrementRecord, IncrementView, Observer, Status};
use crate::solver::newton::{IterationRecord, LinearSystem};
use crate::solver::problem::State;
use std::ops::ControlFlow;

/// Where the records of a run go as they are made, instead of into its report: of millions of increments they would fill the
/// memory.
pub trait Ledger: Observer {
    /// Takes the record of an increment, and the forces at its end if it converged; after [`Observer::increment`].
    fn add(&mut self, record: &IncrementRecord, forces: &[ForceRecord], reactions: Option<&BalanceRecord>);
}

/// Who watches a run.
pub(super) enum Audience<'a> {
    /// Somebody who finds the records in the report.
    Observer(&'a mut dyn Observer),
    /// Somebody who takes them.
    Ledger(&'a mut dyn Ledger),
}

impl Audience<'_> {
    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        match self {
            Audience::Observer(observer) => *observer,
            Audience::Ledger(ledger) => *ledger,
        }
    }
}

/// Stands before the observer of a run.
pub(super) struct Watch<'a, 'b> {
    model: &'a Model,
    audience: &'a mut Audience<'b>,
    pub validity: Validity,
    pub estimates: EstimateWatch,
    pub balance: BalanceWatch,
    pub curves: HistoryCurves,
    /// The records of each increment so far, if nobody else takes them.
    pub increments: Vec<IncrementRecord>,
    /// The resultants of each.
    pub forces: Vec<ForceRecord>,
    /// What else acted on the body.
    pub reactions: Vec<BalanceRecord>,
    /// The same at the end of the last one that converged.
    pub last_reactions: Option<BalanceRecord>,
    keeps_last: bool,
    /// The last converged increment, where it is to be kept, or where an exact path is lost.
    pub last: Option<RecordedIncrement>,
    /// The increments, ascending from 1, at whose ends contact forces are kept; and these.
    numbers: &'a [usize],
    pub states: Vec<State>,
    pub leaps: Leaps,
}

/// What it knows between two increments.
#[derive(Serialize, Deserialize)]
struct Known {
    validity: Validity,
    seen: Seen,
    balance: BalanceWatch,
    curves: HistoryCurves,
    last_reactions: Option<BalanceRecord>,
    last: Option<RecordedIncrement>,
    states: Vec<State>,
    leaps: Leaps,
}

impl<'a, 'b> Watch<'a, 'b> {
    pub(super) fn new(
        model: &'a Model,
        keeps_last: bool,
        numbers: &'a [usize],
        leaps: Leaps,
        audience: &'a mut Audience<'b>,
    ) -> Self {
        Watch {
            model,
            audience,
            validity: Validity::new(model),
            estimates: EstimateWatch::new(model),
            balance: BalanceWatch::default(),
            curves: HistoryCurves::default(),
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

    /// Goes on where it left its part in a `checkpoint`.
    pub(super) fn go_on_from(&mut self, checkpoint: &Checkpoint) -> Result<(), CheckpointError> {
        let Known { validity, seen, balance, curves, last_reactions, last, states, leaps } = checkpoint.part(1)?;
        if !validity.fits(self.model) || !leaps.fit(self.model) || !self.estimates.go_on_with(self.model, seen) {
            return Err(CheckpointError::Other { what: "the mesh or its contact" });
        }
        let before = self.numbers.iter().filter(|number| **number <= checkpoint.increments()).count();
        if states.len() != before || last.is_some() != self.keeps_last {
            return Err(CheckpointError::Other { what: "what is asked for (--companion, --uniqueness)" });
        }
        (self.validity, self.balance, self.curves) = (validity, balance, curves);
        (self.last_reactions, self.last, self.states, self.leaps) = (last_reactions, last, states, leaps);
        Ok(())
    }

    /// The record of a step with the energy of the body, where a history, which knows the forces of loads and supports only,
    /// has another.
    fn record(&self, step: &IncrementView<'_>) -> Option<IncrementRecord> {
        let strain_energy = self.model.strain_energy(step.record.time, step.state)?;
        Some(IncrementRecord { strain_energy, ..step.record.clone() })
    }

    /// Shows an increment, and hands its records on or keeps them.
    fn enter(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let flow = self.audience.observer().increment(step);
        let converged = step.record.status == Status::Converged;
        let forces = if converged { ForceRecord::all(self.model, step) } else { Vec::new() };
        let reactions = converged.then(|| BalanceRecord::new(self.model, step));
        self.curves.add(step.record, &forces);
        if let Some(reactions) = &reactions {
            self.balance.see(reactions);
        }
        match self.audience {
            Audience::Ledger(ledger) => ledger.add(step.record, &forces, reactions.as_ref()),
            Audience::Observer(_) => {
                self.increments.push(step.record.clone());
                self.forces.extend(forces);
                self.reactions.extend(reactions.clone());
            }
        }
        self.last_reactions = reactions.or(self.last_reactions.take());
        flow
    }
}

impl Observer for Watch<'_, '_> {
    fn ready(&mut self) {
        self.audience.observer().ready();
    }

    fn waits_for(&mut self, index: usize) -> bool {
        self.audience.observer().waits_for(index)
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
        let record = self.record(part);
        self.audience.observer().part(&IncrementView { record: record.as_ref().unwrap_or(part.record), ..*part });
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        let record = self.record(step);
        let step = &IncrementView { record: record.as_ref().unwrap_or(step.record), ..*step };
        self.validity.see(self.model, step);
        self.estimates.see(self.model, step);
        self.leaps.see(self.model, step);
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
        let Watch { validity, estimates, balance, curves, last_reactions, last, states, leaps, audience, .. } = self;
        let known = || Known {
            validity: validity.clone(),
            seen: estimates.seen().clone(),
            balance: *balance,
            curves: curves.clone(),
            last_reactions: last_reactions.clone(),
            last: last.clone(),
            states: states.clone(),
            leaps: leaps.clone(),
        };
        audience.observer().rest(&|| here().with(&known()));
    }
}

/// What a companion compares.
pub(super) fn tangential_forces(State { p_t, p_o, .. }: &State) -> State {
    State { p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() }
}
