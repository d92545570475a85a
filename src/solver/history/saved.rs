//! Snapshots of a history between two increments.

use super::increment_error::IncrementErrors;
use super::record::{IncrementRecord, Tally};
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::{HistoryOutcome, IncrementError, Method, WorkingSet};
use crate::algebra::linear::Statistics;
use crate::base::units::Scaling;
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::events::{ExactPath, Jump, SavedExactPath};
use crate::solver::formulation::{Layout, Linearization};
use crate::solver::laws::KktScales;
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// The data from which a history continues.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Saved {
    pub run: RunOf,
    pub outcome: Done,
    pub position: HistoryState,
    pub stage: SavedStage,
    /// The statistics of the linear solver.
    pub statistics: Statistics,
}

/// Identifies the run of a checkpoint: a history can resume from a checkpoint only if both have equal keys.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct RunOf {
    version: u32,
    method: Method,
    scaling: Scaling,
    displacements: usize,
    contacts: usize,
}

/// The version of the stored data and of their use by the methods.
const VERSION: u32 = 3;

/// The results so far.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Done {
    tally: Tally,
    state: State,
    scales: KktScales,
    reached: f64,
    working_set: Option<WorkingSet>,
    increment_error: Option<IncrementError>,
    event_count: usize,
    jumps: Vec<Jump>,
}

/// A snapshot of an exact path.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct SavedPath {
    pub run: RunOf,
    pub outcome: Done,
    pub walk: SavedExactPath,
    /// As [`super::ExactPathSettings::jump`].
    jump: bool,
    /// The scales of the steps from event to event, and of the increments.
    pub scales: [KktScales; 2],
}

/// A snapshot of the stage in progress.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct SavedStage {
    pub snapshot: Snapshot,
    /// The working set of the condensed equations, if it is not all contact nodes.
    pub nodes: Option<Vec<usize>>,
}

impl RunOf {
    pub(super) fn new(layout: &Layout, settings: &HistorySettings) -> Self {
        RunOf {
            version: VERSION,
            method: settings.method,
            scaling: settings.scaling,
            displacements: layout.displacements(),
            contacts: layout.contacts(),
        }
    }

    /// # Errors
    /// [`CheckpointError::Other`] unless the key is that of this problem and method.
    fn is_that_of(&self, problem: &ContactProblem, settings: &HistorySettings) -> Result<(), CheckpointError> {
        let now = RunOf::new(&Layout::new(problem), settings);
        if *self == now {
            return Ok(());
        }
        Err(CheckpointError::Other { what: self.difference(&now) })
    }

    fn difference(&self, now: &RunOf) -> &'static str {
        if self.version != now.version {
            "the version of stickslip"
        } else if (self.method, self.scaling) == (now.method, now.scaling) {
            "the mesh or its contact"
        } else {
            "the method"
        }
    }
}

impl Done {
    pub(super) fn of(outcome: &HistoryOutcome) -> Self {
        let HistoryOutcome { tally, state, scales, reached, working_set, increment_error, .. } = outcome;
        let (event_count, jumps) = (outcome.event_count, outcome.jumps.clone());
        Done {
            tally: *tally,
            state: state.clone(),
            scales: scales.clone(),
            reached: *reached,
            working_set: *working_set,
            increment_error: *increment_error,
            event_count,
            jumps,
        }
    }

    /// # Errors
    /// [`CheckpointError::Other`] unless an increment of these `times` ends at the time of the checkpoint.
    fn ends_at(&self, checkpoint: &Checkpoint, times: &[f64]) -> Result<(), CheckpointError> {
        let done = self.tally.increments;
        if done == 0 || done != checkpoint.increments() || times.get(done - 1) != Some(&checkpoint.time()) {
            return Err(CheckpointError::Other { what: "the times of the increments" });
        }
        Ok(())
    }

    pub(super) fn resume(self, begun: HistoryOutcome) -> HistoryOutcome {
        let Done { tally, state, scales, reached, working_set, increment_error, event_count, jumps } = self;
        let done = HistoryOutcome { tally, state, reached, scales, working_set, increment_error, ..begun };
        HistoryOutcome { event_count, jumps, ..done }
    }
}

impl Saved {
    /// Reads the `checkpoint`, which must belong to this history.
    pub(super) fn read(
        checkpoint: &Checkpoint,
        problem: &ContactProblem,
        times: &[f64],
        settings: &HistorySettings,
    ) -> Result<Self, CheckpointError> {
        let saved: Saved = checkpoint.part(0)?;
        saved.run.is_that_of(problem, settings)?;
        saved.outcome.ends_at(checkpoint, times)?;
        if !saved.fits(problem) {
            return Err(CheckpointError::Damaged);
        }
        Ok(saved)
    }

    fn fits(&self, problem: &ContactProblem) -> bool {
        let contacts = problem.contacts();
        let state = |state: &State| state.check(problem).is_ok();
        let nodes = self
            .stage
            .nodes
            .iter()
            .all(|nodes| nodes.is_sorted_by(|a, b| a < b) && nodes.last().is_some_and(|last| *last < contacts));
        state(&self.outcome.state) && nodes && self.position.fits(problem, state)
    }
}

impl SavedPath {
    /// Creates a checkpoint of an exact path after the increments so far.
    pub(super) fn checkpoint(
        settings: &HistorySettings,
        jump: bool,
        outcome: &HistoryOutcome,
        walk: &ExactPath<'_>,
        scales: [KktScales; 2],
    ) -> Checkpoint {
        let run = RunOf::new(&outcome.layout, settings);
        let saved = SavedPath { run, outcome: Done::of(outcome), walk: walk.save(), jump, scales };
        Checkpoint::new(outcome.tally.increments, outcome.reached, &saved)
    }

    /// Reads the `checkpoint`, which must belong to this history.
    pub(super) fn read(
        checkpoint: &Checkpoint,
        problem: &ContactProblem,
        times: &[f64],
        settings: &HistorySettings,
        jump: bool,
    ) -> Result<Self, CheckpointError> {
        let saved: SavedPath = checkpoint.part(0)?;
        saved.run.is_that_of(problem, settings)?;
        if saved.jump != jump {
            return Err(CheckpointError::Other { what: "the method" });
        }
        saved.outcome.ends_at(checkpoint, times)?;
        if saved.outcome.state.check(problem).is_err() {
            return Err(CheckpointError::Damaged);
        }
        Ok(saved)
    }
}

impl HistoryOutcome {
    /// Adds the record of an increment. Keeps all records, or only the last two.
    pub(super) fn push(&mut self, record: IncrementRecord, keeps: bool) {
        self.tally.add(&record);
        if !keeps && self.records.len() > 1 {
            self.records.remove(0);
        }
        self.records.push(record);
    }
}

/// The snapshot of a method: all data besides the input on which its next increment depends. A restored method
/// continues to the same bits.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Snapshot {
    /// The state, for a method without other data.
    pub(super) state: Option<State>,
    /// The unknowns, in the method's own units.
    pub(super) unknowns: Vec<f64>,
    /// The low-order part of the unknowns.
    pub(super) rest: Vec<f64>,
    /// The end of the last increment.
    pub(super) last: Option<Vec<f64>>,
    /// The accumulated time-step error.
    pub(super) errors: Option<IncrementErrors>,
    /// The last linearisation.
    pub(super) linearization: Option<Linearization>,
    /// `true` if the last linearisation was factored.
    pub(super) is_factored: bool,
    /// The snapshot of the fallback method.
    pub(super) rescue: Option<Box<Snapshot>>,
}

impl Snapshot {
    /// Creates the snapshot of a method whose only internal data is its state.
    pub fn of_state(state: State) -> Self {
        Snapshot { state: Some(state), ..Snapshot::default() }
    }

    /// Returns the state in the snapshot of such a method.
    pub fn into_state(self) -> Option<State> {
        self.state
    }
}

/// Copies `kept` to `values`. Returns `false` if the lengths differ.
pub(super) fn take_over(values: &mut [f64], kept: &[f64]) -> bool {
    let fits = values.len() == kept.len();
    if fits {
        values.copy_from_slice(kept);
    }
    fits
}
