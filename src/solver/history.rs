//! A load history: one contact problem after the other, each starting from the last solution.
//!
//! | what | file |
//! | --- | --- |
//! | what a history asks of a method ([`IncrementSolver`]), and what it hands over ([`Task`]) | `task.rs` |
//! | BN; the paper's interior point method; the default one; BN with that for its rescue | `bn.rs`, `ip.rs`, `predictor_corrector.rs`, `rescue.rs` |
//! | which of them a [`Method`] names, and how a history is solved | `method.rs`, `settings.rs` |
//! | one increment: its substeps, its verdict, increments that are judged together | `increment.rs` |
//! | from increment to increment, in one set-up of the equations after the other | `driver.rs`, `state.rs` |
//! | which contact nodes join condensed equations that do not hold all | `working_set.rs` |
//! | the interior of a condensed body at the start and at the end of an increment | `interior.rs` |
//! | a body that contact alone holds, carried to where it rests | `rigid_offset.rs` |
//! | one increment at a time, under loads that are not known beforehand | `stepper.rs` |
//! | the exact path in time, from event to event; jumps | `events.rs`, `jump.rs` |
//! | the error of the increments: the work of friction and the tangential forces | `increment_error.rs` |
//! | observers, records, checkpoints | `observer.rs`, `record.rs`, `saved.rs` |
//!
//! ```
//! use stickslip::solver::history::{self, HistorySettings, Method, Status, SystemSolver};
//! use stickslip::solver::loading::{LoadCase, Loading};
//! use stickslip::solver::problem::{ContactProblem, Parts};
//! use stickslip::algebra::sparse::{Csr, Symmetric};
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
mod driver;
mod error;
mod events;
mod increment;
mod increment_error;
mod interior;
mod ip;
mod jump;
mod method;
mod observer;
mod predictor_corrector;
mod record;
mod rescue;
mod rigid_offset;
mod saved;
mod settings;
mod state;
mod stepper;
mod system;
mod task;
mod working_set;

use crate::algebra::linear::Statistics;
use crate::solver::events::{Event, Jump, PathEnd};
use crate::solver::formulation::Layout;
use crate::solver::laws::{KktScales, Violation};
use crate::solver::loading::Loading;
use crate::solver::problem::error::{expect_each, expect_finite, expect_increasing};
use crate::solver::problem::{ContactProblem, ProblemError, State};
use driver::HistoryDriver;
use events::ExactHistory;
use std::time::Instant;

pub use error::Error;
pub use increment_error::{IncrementError, IncrementErrors};
pub(crate) use jump::{JumpSolver, RestartPoint};
pub use method::{Method, Start};
pub use observer::{IncrementView, Observer};
pub use record::{ContactCounts, IncrementRecord, Seconds, Status, Tally};
pub use saved::Snapshot;
pub use settings::HistorySettings;
pub use settings::SolverChoice;
pub use stepper::Stepper;
pub use system::{LinearAlgebra, SystemSolver, UnknownLinearAlgebra};
pub use task::{Algorithm, IncrementSolver, Observe, Response, Task};
pub use working_set::WorkingSet;

/// The result of a history.
#[derive(Debug, Clone)]
pub struct HistoryOutcome {
    /// The verdict: that of the first increment that did not converge, if there is one.
    pub status: Status,
    /// One record per increment, up to the one that failed; the last two where the settings do not ask for all.
    pub records: Vec<IncrementRecord>,
    /// What all of them add up to, those before a checkpoint included.
    pub tally: Tally,
    /// The state at the end of the last converged increment.
    pub state: State,
    /// How far the history got, s: within the increment that failed, if that was halved.
    pub reached: f64,
    /// The scales of the error measure, from all converged increments.
    pub scales: KktScales,
    /// Where the increment that failed violates the law most.
    pub violation: Option<Violation>,
    /// The changes of status on the way, where the path was followed from one to the next and the settings ask for all.
    pub events: Vec<Event>,
    /// How many there were.
    pub event_count: usize,
    /// Where it went on by a jump.
    pub jumps: Vec<Jump>,
    /// Where and how that path ended before its time.
    pub lost: Option<PathEnd>,
    /// The equilibrium error that rounding the displacements makes in the last increment.
    pub rounding: f64,
    /// If a rigid motion is to blame, one that nothing stops or that the loads drive against all
    /// contact forces: the weights of the problem's free motions in it.
    pub free_motion: Option<Vec<f64>>,
    /// Which unknowns there were.
    pub layout: Layout,
    /// The contact nodes that the equations held, if those were not all at first.
    pub working_set: Option<WorkingSet>,
    /// What the increments leave, where there is friction and the method estimates that.
    pub increment_error: Option<IncrementError>,
    /// What the linear algebra did.
    pub linear: Statistics,
    /// Seconds for patterns and symbolic analysis, before the first increment.
    pub setup_seconds: f64,
}

impl HistoryOutcome {
    /// That of a history that has not begun.
    fn begun(problem: &ContactProblem) -> Self {
        HistoryOutcome {
            status: Status::Converged,
            records: Vec::new(),
            tally: Tally::default(),
            state: State::zero(problem),
            reached: 0.0,
            scales: KktScales::default(),
            violation: None,
            events: Vec::new(),
            event_count: 0,
            jumps: Vec::new(),
            lost: None,
            rounding: 0.0,
            free_motion: None,
            layout: Layout::new(problem),
            working_set: None,
            increment_error: None,
            linear: Statistics::default(),
            setup_seconds: 0.0,
        }
    }
}

/// Runs a history over increments that end at `times` (s), and stops at the first increment that
/// does not converge.
///
/// # Errors
/// When an array does not fit the problem or holds what it must not, and when the linear algebra cannot go on. If
/// memory runs out in an increment, that is its verdict.
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

/// As [`run`], with a method of one's own in place of the one that `settings` name.
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
    let outcome = HistoryOutcome::begun(problem);
    if let Method::Events { .. } = settings.method {
        let history = ExactHistory { problem, loading, times, settings, observer, outcome };
        return history.follow(system, start);
    }
    if !algorithm.knows(&outcome.layout) {
        return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
    }
    let mut stages = HistoryDriver::new(problem, loading, times, settings, observer, outcome, start)?;
    match system {
        SystemSolver::Whole(linear) => {
            let mut linear = linear.after(stages.done);
            stages.stage(algorithm, None, &mut linear)?;
        }
        SystemSolver::Condensed(condensation) => stages.condensed(algorithm, &condensation)?,
    }
    Ok(stages.outcome)
}

/// The ends of increments: at least one, finite, increasing from 0 or later: there the body is undeformed.
pub(crate) fn check_times(times: &[f64]) -> Result<(), ProblemError> {
    if times.is_empty() {
        return Err(ProblemError::Nothing { array: "times".to_string() });
    }
    expect_finite("times", times)?;
    expect_each("times", times, "0 or more: a history begins at 0", |time| time >= 0.0)?;
    expect_increasing("times", times.iter().copied())
}
