//! A history that is put away between two increments.

use serde::{Deserialize, Serialize};

use super::memory::Memory;
use super::position::Position;
use super::record::{IncrementRecord, Tally};
use super::settings::HistorySettings;
use super::{HistoryOutcome, IncrementError, WorkingSet};
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::contact::KktScales;
use crate::formulation::Layout;
use crate::linear::Statistics;
use crate::problem::{ContactProblem, State};

/// All that a history goes on from.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Saved {
    pub run: RunOf,
    pub outcome: Done,
    pub position: Position,
    pub stage: SavedStage,
    /// What the linear algebra has done.
    pub statistics: Statistics,
}

/// What a checkpoint is of.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunOf {
    method: String,
    displacements: usize,
    contacts: usize,
}

/// What has come of it so far.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Done {
    tally: Tally,
    state: State,
    scales: KktScales,
    reached: f64,
    working_set: Option<WorkingSet>,
    increment_error: Option<IncrementError>,
}

/// The stage on the way.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct SavedStage {
    pub memory: Memory,
    /// The contact nodes that condensed equations hold, if not all.
    pub nodes: Option<Vec<usize>>,
    /// How many increments go together.
    pub together: usize,
}

impl RunOf {
    pub(super) fn new(layout: &Layout, settings: &HistorySettings) -> Self {
        let method = format!("{:?}", (settings.method, settings.scaling));
        RunOf { method, displacements: layout.displacements(), contacts: layout.contacts() }
    }
}

impl Done {
    pub(super) fn of(outcome: &HistoryOutcome) -> Self {
        let HistoryOutcome { tally, state, scales, reached, working_set, increment_error, .. } = outcome;
        Done {
            tally: *tally,
            state: state.clone(),
            scales: *scales,
            reached: *reached,
            working_set: *working_set,
            increment_error: *increment_error,
        }
    }

    pub(super) fn resume(self, begun: HistoryOutcome) -> HistoryOutcome {
        let Done { tally, state, scales, reached, working_set, increment_error } = self;
        HistoryOutcome { tally, state, reached, scales, working_set, increment_error, ..begun }
    }
}

impl Saved {
    /// What the `checkpoint` has, if it is one of this history.
    pub(super) fn read(
        checkpoint: &Checkpoint,
        problem: &ContactProblem,
        times: &[f64],
        settings: &HistorySettings,
    ) -> Result<Self, CheckpointError> {
        let saved: Saved = checkpoint.part(0)?;
        let other = |what| Err(CheckpointError::Other { what });
        let now = RunOf::new(&Layout::new(problem), settings);
        if saved.run != now {
            return other(if saved.run.method == now.method { "the mesh or its contact" } else { "the method" });
        }
        let done = saved.outcome.tally.increments;
        if done == 0 || done != checkpoint.increments() || times.get(done - 1) != Some(&checkpoint.time()) {
            return other("the times of the increments");
        }
        if !saved.fits(problem) {
            return Err(CheckpointError::Damaged);
        }
        Ok(saved)
    }

    fn fits(&self, problem: &ContactProblem) -> bool {
        let (n, contacts) = (problem.displacements(), problem.contacts());
        let state = |state: &State| {
            let State { u, u_rest, p_t, p_o, p_n } = state;
            u.len() == n && [0, n].contains(&u_rest.len()) && [p_t, p_o, p_n].iter().all(|p| p.len() == contacts)
        };
        let nodes = self
            .stage
            .nodes
            .iter()
            .all(|nodes| nodes.is_sorted_by(|a, b| a < b) && nodes.last().is_some_and(|last| *last < contacts));
        state(&self.outcome.state) && nodes && self.position.fits(problem, state)
    }
}

impl HistoryOutcome {
    /// Takes the record of an increment in; of all, or of the last two.
    pub(super) fn push(&mut self, record: IncrementRecord, keeps: bool) {
        self.tally.add(&record);
        if !keeps && self.records.len() > 1 {
            self.records.remove(0);
        }
        self.records.push(record);
    }
}
