//! A load history: a sequence of contact problems, each starting from the last solution.
//!
//! | content | file |
//! | --- | --- |
//! | the interface of a method ([`IncrementSolver`]) and its input ([`Task`]) | `task.rs` |
//! | BN and IP along a history: starts and snapshots (the algorithms are in `newton/`) | `bn.rs`, `ip.rs` |
//! | the default interior point method | `predictor_corrector.rs` |
//! | what is tried for an increment, in which order; joints that slip as a whole | `strategy.rs` |
//! | the algorithm of an increment ([`Method`]), its construction, and the settings | `method.rs`, `algorithm.rs`, `settings.rs` |
//! | what a user chooses: increments or the exact path, tolerance, linear solver | `choice.rs` |
//! | the linear system: whole or condensed | `system.rs` |
//! | one increment: its substeps, its verdict and its working set | `increment.rs` |
//! | the loop over increments, within a loop over stages | `driver.rs` |
//! | a stage: one set-up of the equations, and their responses | `stage.rs` |
//! | the state that the history has reached, with the rigid offset of a body that only contact holds | `state.rs` |
//! | the body, whole or condensed; its interior at the end of a substep | `body.rs` |
//! | one increment at a time, under loads that are not known in advance | `stepper.rs` |
//! | the exact path in time, from event to event | `events.rs` |
//! | the time-step error of the friction work and of the tangential forces | `increment_error.rs` |
//! | records and observers; checkpoints | `record.rs`, `saved.rs` |
//!
//! ```
//! use stickslip::solver::history::{self, HistorySettings, Method, Status, SystemSolver};
//! use stickslip::solver::{LoadCase, Loading};
//! use stickslip::solver::{ContactProblem, Parts};
//! use stickslip::algebra::{Csr, Symmetric};
//!
//! // A node on two springs of 2 N/m, pressed on a floor with 1 N and pulled along it with 0.1 N; friction 0.3.
//! let stiffness = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0)])?;
//! let c_n = Csr::from_rows(2, [[(1, -1.0)]])?;
//! let c_t = Csr::from_rows(2, [[(0, 1.0)]])?;
//! let problem = ContactProblem::new(Parts { c_t, mu: vec![0.3], ..Parts::new(stiffness, c_n) })?;
//! let load = LoadCase::new(vec![0.1, -1.0], vec![[0.0, 0.0], [1.0, 1.0]])?;
//! let loading = Loading::new(vec![load], vec![0.0])?;
//!
//! let settings = HistorySettings::new(&problem, &loading, Method::BN)?;
//! let outcome = history::run(&problem, &loading, &[0.5, 1.0], &settings, SystemSolver::default(), &mut ())?;
//! assert_eq!(outcome.status, Status::Converged);
//! assert!((outcome.state.p_n[0] - 1.0).abs() < 1e-12 && (outcome.state.p_t[0] - 0.1).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod algorithm;
mod bn;
mod body;
mod choice;
mod driver;
mod events;
mod first_touch;
mod increment;
mod increment_error;
mod ip;
mod method;
mod predictor_corrector;
mod record;
mod saved;
mod settings;
mod stage;
mod state;
mod stepper;
mod strategy;
mod system;
mod task;

use crate::algebra::linear::{LinearError, Statistics};
use crate::solver::checkpoint::CheckpointError;
use crate::solver::events::{Event, PathEnd, PathError};
use crate::solver::formulation::Layout;
use crate::solver::laws::{KktScales, Violation};
use crate::solver::loading::Loading;
use crate::solver::problem::error::{expect_each, expect_finite, expect_increasing};
use crate::solver::problem::{ContactProblem, ProblemError, State};
use driver::HistoryDriver;
use serde::{Deserialize, Serialize};
use state::HistoryState;
use std::time::Instant;

pub use choice::{HistoryMethod, SolverChoice};
pub(crate) use events::RestartPoint;
pub use events::follow_exact_path;
pub use increment::WorkingSet;
pub use increment_error::{IncrementError, IncrementErrors};
pub use method::{Method, Start};
pub use record::{ContactCounts, IncrementRecord, IncrementView, Observer, Seconds, Status, Tally};
pub use saved::Snapshot;
pub use settings::HistorySettings;
pub use stepper::{Stepper, StepperState};
pub use system::{LinearAlgebra, SystemSolver};
pub use task::{Algorithm, IncrementSolver, Observe, Response, Task};

/// The result of a history.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[non_exhaustive]
pub struct HistoryOutcome {
    /// The verdict of the set-up, or of the first increment that did not converge, or [`Status::Converged`].
    #[serde(skip)]
    pub status: Status,
    /// The record of each increment, up to the first that failed. Only the last two are kept unless the settings ask
    /// for all.
    #[serde(skip)]
    pub records: Vec<IncrementRecord>,
    /// The totals over all increments, including those before a checkpoint.
    pub tally: Tally,
    /// The state at the end of the last converged increment.
    pub state: State,
    /// The time reached, s; it may lie within the increment that failed, if that was halved.
    pub reached: f64,
    /// The scales of the error measure, from all converged increments.
    pub scales: KktScales,
    /// The largest violation of the law in the increment that failed.
    #[serde(skip)]
    pub violation: Option<Violation>,
    /// The changes of status, if the exact path was followed and the settings ask for all.
    #[serde(skip)]
    pub events: Vec<Event>,
    /// The number of changes of status.
    pub event_count: usize,
    /// The end of the quasi-static motion, if the path ended early.
    #[serde(skip)]
    pub lost: Option<PathEnd>,
    /// The equilibrium error due to rounding of the displacements in the last increment.
    #[serde(skip)]
    pub rounding: f64,
    /// The weights of the problem's rigid modes in a motion that caused the failure, if there is one: nothing stops
    /// it, or the loads drive it against all contact forces.
    #[serde(skip)]
    pub free_motion: Option<Vec<f64>>,
    /// The slip of a joint as a whole, with [`Status::Slips`].
    #[serde(skip)]
    pub slip: Option<Slip>,
    /// The layout of the unknowns.
    #[serde(skip)]
    pub layout: Layout,
    /// The working set, if not all contact nodes were in the equations at first.
    pub working_set: Option<WorkingSet>,
    /// The estimated time-step error, if there is friction and the method estimates it.
    pub increment_error: Option<IncrementError>,
    /// The statistics of the linear solver.
    #[serde(skip)]
    pub linear: Statistics,
    /// The time for patterns and symbolic analysis, before the first increment, s.
    #[serde(skip)]
    pub setup_seconds: f64,
}

/// The slip of a joint as a whole, after the time that the history has reached.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Slip {
    /// A time at which the joint slips, s.
    pub by: f64,
    /// The normal contact forces at the time reached, n_c, N.
    pub p_n: Vec<f64>,
}

impl HistoryOutcome {
    /// Ends a history whose body is unconstrained even with clamped contact nodes.
    fn end_unconstrained(&mut self, algorithm: &dyn Algorithm, problem: &ContactProblem, loading: &Loading) {
        self.free_motion = algorithm.start(problem, loading).clamp_contacts().err();
        self.status = Status::Singular;
    }

    /// Creates the outcome of a history before its first increment.
    fn unsolved(problem: &ContactProblem) -> Self {
        HistoryOutcome { state: State::zero(problem), layout: Layout::new(problem), ..HistoryOutcome::default() }
    }
}

/// Runs a history with increments that end at `times` (s), and stops at the first increment that does not converge.
///
/// # Errors
/// If an array does not fit the problem or has an invalid value, or if the linear solver fails. If memory runs out in
/// an increment, there is no error, but a verdict.
pub fn run(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    settings: &HistorySettings,
    system: SystemSolver,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, Error> {
    run_with(problem, loading, times, settings, settings, system, observer)
}

/// Runs a history as [`run`] does, with a caller's method in place of the one in `settings`.
///
/// # Errors
/// As [`run`].
pub fn run_with(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    algorithm: &dyn Algorithm,
    settings: &HistorySettings,
    system: SystemSolver,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, Error> {
    let start = Instant::now();
    loading.check(problem)?;
    settings.check(problem)?;
    check_times(times)?;
    let outcome = HistoryOutcome::unsolved(problem);
    if !algorithm.knows(&outcome.layout) {
        return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
    }
    let mut history = HistoryState::start(problem);
    let mut driver = HistoryDriver::new(problem, loading, times, settings, observer, &mut history);
    driver.start = start;
    driver.resume()?;
    match system {
        SystemSolver::Whole(linear) => {
            let mut linear = linear.after(driver.done);
            driver.stage(algorithm, driver.body, &mut linear)?;
        }
        SystemSolver::Condensed(condensation) => driver.condensed(algorithm, &condensation)?,
    }
    Ok(driver.outcome)
}

/// Checks the ends of increments: at least one, finite, increasing, and not before 0, where the body is undeformed.
pub(crate) fn check_times(times: &[f64]) -> Result<(), ProblemError> {
    if times.is_empty() {
        return Err(ProblemError::Nothing { array: "times".to_string() });
    }
    expect_finite("times", times)?;
    expect_each("times", times, "0 or more: a history begins at 0", |time| time >= 0.0)?;
    expect_increasing("times", times.iter().copied())
}

/// The reason why a history cannot be run or continued. An increment that does not converge is no error; it has a
/// [`Status`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An array does not fit the problem or has an invalid value.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The constants of the paper are stresses, which need weights.
    #[error("the method {method} has constants per area: give the problem the weight of each contact node")]
    NoWeight {
        /// The method.
        method: Method,
    },
    /// The linear solver failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// A checkpoint is damaged, or belongs to another run.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// An exact path cannot be followed.
    #[error(transparent)]
    Path(PathError),
}

impl From<PathError> for Error {
    fn from(error: PathError) -> Self {
        match error {
            PathError::Problem(error) => Error::Problem(error),
            PathError::Linear(error) => Error::Linear(error),
            other => Error::Path(other),
        }
    }
}
