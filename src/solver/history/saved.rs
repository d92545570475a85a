//! Snapshots of a history between two increments.

use super::increment_error::IncrementErrors;
use super::record::IncrementRecord;
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::{HistoryOutcome, Method};
use crate::algebra::linear::Statistics;
use crate::base::units::Scaling;
use crate::solver::checkpoint::{Checkpoint, CheckpointError};
use crate::solver::events::{ExactPath, SavedExactPath};
use crate::solver::formulation::Linearization;
use crate::solver::laws::KktScales;
use crate::solver::loading::Loading;
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// The data from which a history continues.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Saved {
    pub run: RunOf,
    pub outcome: HistoryOutcome,
    pub history: HistoryState,
    pub stage: SavedStage,
    /// The statistics of the linear solver.
    pub statistics: Statistics,
}

/// Identifies the run of a checkpoint: a history can resume only from a checkpoint of the same problem, loading, method
/// and times so far.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct RunOf {
    version: u32,
    displacements: usize,
    contacts: usize,
    /// The fingerprints of the arrays of each of [`PARTS`].
    parts: [Vec<Fingerprint>; PARTS.len()],
    method: Method,
    scaling: Scaling,
    tolerance: f64,
}

/// The version of the stored data and of their use by the methods.
const VERSION: u32 = 8;

/// The data that determine the increments so far.
const PARTS: [&str; 6] = [
    "the stiffness of the body",
    "the contact rows",
    "the weights of the contact nodes",
    "the friction",
    "the loads, gaps or motions",
    "the times of the increments",
];

/// The sum of the absolute values of an array, and the sum of its values with weights that differ from place to place.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Fingerprint(f64, f64);

/// Arrays are equal if their sums agree within this share of the sum of absolute values. Other processors compute the
/// same data with other rounding.
const ROUNDING: f64 = 1e-12;

/// A snapshot of an exact path.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct SavedPath {
    pub run: RunOf,
    pub outcome: HistoryOutcome,
    pub path: SavedExactPath,
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

/// Returns numbers in [-1/2, 1/2) of which no two nearby ones are equal: the multiples of the golden ratio.
fn weights() -> impl Iterator<Item = f64> {
    (1..).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract() - 0.5)
}

impl Fingerprint {
    fn of(array: &[f64]) -> Self {
        let weighted = array.iter().zip(weights()).map(|(x, weight)| x * weight).sum();
        Fingerprint(array.iter().map(|x| x.abs()).sum(), weighted)
    }
}

impl PartialEq for Fingerprint {
    fn eq(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * self.0.max(other.0);
        near(self.0, other.0) && near(self.1, other.1)
    }
}

impl RunOf {
    /// Identifies a history whose increments so far end at `times`.
    pub(super) fn new(problem: &ContactProblem, loading: &Loading, times: &[f64], settings: &HistorySettings) -> Self {
        let (stiffness, columns) = (problem.stiffness(), weights().take(problem.displacements()).collect::<Vec<_>>());
        let of = |array: &[f64]| vec![Fingerprint::of(array)];
        let mut friction = of(problem.mu());
        loading.friction().iter().for_each(|history| history.each_array(|array| friction.push(Fingerprint::of(array))));
        let mut loads = Vec::new();
        loading.each_array(|array| loads.push(Fingerprint::of(array)));
        let parts = [
            vec![Fingerprint::of(stiffness.at_hand().values()), Fingerprint::of(&stiffness.diagonal())],
            [problem.c_n(), problem.c_t(), problem.c_o()].map(|rows| Fingerprint::of(&rows.mul(&columns))).to_vec(),
            of(problem.weight().unwrap_or_default()),
            friction,
            loads,
            of(times),
        ];
        RunOf {
            version: VERSION,
            displacements: problem.displacements(),
            contacts: problem.contacts(),
            parts,
            method: settings.method,
            scaling: settings.scaling,
            tolerance: settings.tolerance,
        }
    }

    /// # Errors
    /// [`CheckpointError::Other`] unless the history of the checkpoint is that of `now`.
    fn is_that_of(&self, now: &RunOf) -> Result<(), CheckpointError> {
        let other = self.parts.iter().zip(&now.parts).position(|(then, now)| then != now);
        let what = if self.version != now.version {
            "the version of stickslip"
        } else if (self.displacements, self.contacts) != (now.displacements, now.contacts) {
            "the mesh or its contact"
        } else if let Some(part) = other {
            PARTS[part]
        } else if (self.method, self.scaling, self.tolerance) != (now.method, now.scaling, now.tolerance) {
            "the method"
        } else {
            return Ok(());
        };
        Err(CheckpointError::Other { what })
    }
}

impl HistoryOutcome {
    /// Returns the results so far from which a history continues: what a checkpoint stores of them.
    pub(super) fn so_far(&self) -> Self {
        let HistoryOutcome { tally, reached, working_set, increment_error, event_count, .. } = *self;
        let (state, scales) = (self.state.clone(), self.scales.clone());
        let layout = self.layout.clone();
        let nothing = HistoryOutcome { tally, reached, working_set, increment_error, ..HistoryOutcome::default() };
        HistoryOutcome { state, scales, event_count, layout, ..nothing }
    }

    /// Adds the record of an increment. Keeps all records, or only the last two.
    pub(super) fn push(&mut self, record: IncrementRecord, keeps: bool) {
        self.tally.add(&record);
        if !keeps && self.records.len() > 1 {
            self.records.remove(0);
        }
        self.records.push(record);
    }

    /// Goes on with the results `so_far`.
    pub(super) fn resume(&mut self, so_far: HistoryOutcome) {
        let (layout, setup_seconds) = (std::mem::take(&mut self.layout), self.setup_seconds);
        *self = HistoryOutcome { layout, setup_seconds, ..so_far };
    }

    /// Returns those of the `times` at which the increments so far end.
    ///
    /// # Errors
    /// [`CheckpointError::Other`] if there are fewer; [`CheckpointError::Damaged`] if the checkpoint is not of their end.
    fn times<'a>(&self, checkpoint: &Checkpoint, times: &'a [f64]) -> Result<&'a [f64], CheckpointError> {
        let done = self.tally.increments;
        if done == 0 || done != checkpoint.increments() || self.reached != checkpoint.time() {
            return Err(CheckpointError::Damaged);
        }
        times.get(..done).ok_or(CheckpointError::Other { what: "the times of the increments" })
    }
}

impl Saved {
    /// Reads the `checkpoint`, which must belong to this history.
    pub(super) fn read(
        checkpoint: &Checkpoint,
        problem: &ContactProblem,
        loading: &Loading,
        times: &[f64],
        settings: &HistorySettings,
    ) -> Result<Self, CheckpointError> {
        let saved: Saved = checkpoint.part(0)?;
        let times = saved.outcome.times(checkpoint, times)?;
        saved.run.is_that_of(&RunOf::new(problem, loading, times, settings))?;
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
        state(&self.outcome.state) && nodes && self.history.fits(problem, state)
    }
}

impl SavedPath {
    /// Creates a checkpoint of an exact path after the increments so far.
    pub(super) fn checkpoint(
        run: RunOf,
        outcome: &HistoryOutcome,
        path: &ExactPath<'_>,
        scales: [KktScales; 2],
    ) -> Checkpoint {
        let saved = SavedPath { run, outcome: outcome.so_far(), path: path.save(), scales };
        Checkpoint::new(outcome.tally.increments, outcome.reached, &saved)
    }

    /// Reads the `checkpoint`, which must belong to this history.
    pub(super) fn read(
        checkpoint: &Checkpoint,
        problem: &ContactProblem,
        loading: &Loading,
        times: &[f64],
        settings: &HistorySettings,
    ) -> Result<Self, CheckpointError> {
        let saved: SavedPath = checkpoint.part(0)?;
        let times = saved.outcome.times(checkpoint, times)?;
        saved.run.is_that_of(&RunOf::new(problem, loading, times, settings))?;
        if saved.outcome.state.check(problem).is_err() {
            return Err(CheckpointError::Damaged);
        }
        Ok(saved)
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
    #[serde(rename = "rest")]
    pub(super) z_lo: Vec<f64>,
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

/// Copies `saved` to `values`. Returns `false` if the lengths differ.
pub(super) fn take_over(values: &mut [f64], saved: &[f64]) -> bool {
    let fits = values.len() == saved.len();
    if fits {
        values.copy_from_slice(saved);
    }
    fits
}
