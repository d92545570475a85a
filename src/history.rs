//! A load history: one contact problem after the other, each starting from the last solution.
//!
//! | what | file |
//! | --- | --- |
//! | what a history asks of a method ([`IncrementSolver`]), and what it hands over ([`Task`]) | `task.rs` |
//! | BN; the paper's interior point method; the default one; BN with that for its rescue | `bn.rs`, `ip.rs`, `predictor_corrector.rs`, `rescue.rs` |
//! | which of them a [`Method`] names | `method.rs` |
//! | from one time to the next, in parts if need be, and what is told of them | `path.rs`, `told.rs` |
//! | how far loads have carried a body that contact alone holds | `carried.rs` |
//! | the interior at the start of an increment, and at the end of a condensed one | `held.rs`, `whole.rs` |
//!
//! ```
//! use stickslip::history::{self, HistorySettings, Method, Status, System};
//! use stickslip::loading::{LoadCase, Loading};
//! use stickslip::problem::{ContactProblem, Parts};
//! use stickslip::sparse::{Csr, Symmetric};
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
//! let outcome = history::run(&problem, &loading, &[0.5, 1.0], &settings, System::default(), &mut ())?;
//! assert_eq!(outcome.status, Status::Converged);
//! assert!((outcome.state.p_n[0] - 1.0).abs() < 1e-12 && (outcome.state.p_t[0] - 0.1).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod algorithm;
mod bn;
mod carried;
mod error;
mod held;
mod ip;
mod method;
mod newton_end;
mod observer;
mod path;
mod predictor_corrector;
mod record;
mod rescue;
mod settings;
mod solver;
mod system;
mod task;
mod told;
mod walked;
mod whole;

use std::time::Instant;

pub use error::Error;
pub use method::{Method, Start};
pub use observer::{Observer, Step};
pub use record::{ContactCounts, IncrementRecord, Seconds, Status};
pub use settings::HistorySettings;
pub use solver::Solver;
pub use system::{LinearAlgebra, System, UnknownLinearAlgebra};
pub use task::{Algorithm, IncrementSolver, Observe, Response, Task};

use crate::contact::{KktScales, Violation, rounding_level, statuses_of};
use crate::formulation::Layout;
use crate::linear::{LinearError, Statistics};
use crate::loading::Loading;
use crate::nonlinear::{Flow, Stop};
use crate::problem::error::{expect_each, expect_finite, expect_increasing};
use crate::problem::{ContactProblem, ProblemError, State};
use held::HeldBody;
use path::Path;
use system::statistics;
use told::{Told, record};
use walked::Walked;

/// The result of a history.
#[derive(Debug, Clone)]
pub struct HistoryOutcome {
    /// The verdict: that of the first increment that did not converge, if there is one.
    pub status: Status,
    /// One record per increment, up to the one that failed.
    pub records: Vec<IncrementRecord>,
    /// The state at the end of the last converged increment.
    pub state: State,
    /// How far the history got, s: within the increment that failed, if that was halved.
    pub reached: f64,
    /// The scales of the error measure, from all converged increments.
    pub scales: KktScales,
    /// Where the increment that failed violates the law most.
    pub violation: Option<Violation>,
    /// The equilibrium error that rounding the displacements makes in the last increment.
    pub rounding: f64,
    /// If a rigid motion is to blame, one that nothing stops or that the loads drive against all
    /// contact forces: the weights of the problem's free motions in it.
    pub free_motion: Option<Vec<f64>>,
    /// Which unknowns there were.
    pub layout: Layout,
    /// What the linear algebra did.
    pub linear: Statistics,
    /// Seconds for patterns and symbolic analysis, before the first increment.
    pub setup_seconds: f64,
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
    system: System,
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
    system: System,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, Error> {
    let start = Instant::now();
    loading.check(problem)?;
    settings.check(problem)?;
    check_times(times)?;
    let mut outcome = HistoryOutcome {
        status: Status::Converged,
        records: Vec::with_capacity(times.len()),
        state: State::zero(problem),
        reached: 0.0,
        scales: KktScales::default(),
        violation: None,
        rounding: 0.0,
        free_motion: None,
        layout: Layout::new(problem),
        linear: Statistics::default(),
        setup_seconds: 0.0,
    };
    if !algorithm.knows(&outcome.layout) {
        return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
    }
    let (mut linear, condensed) = match system.set_up(problem, loading) {
        Ok(set_up) => set_up,
        Err(LinearError::Singular { .. }) => {
            let free_motion = algorithm.start(problem, loading).hold_contacts().err();
            return Ok(HistoryOutcome { status: Status::Singular, free_motion, ..outcome });
        }
        Err(error) => return Err(error.into()),
    };
    let (small, loads, body) = match &condensed {
        Some(condensed) => (&condensed.problem, &condensed.loading, Some(condensed.info())),
        None => (problem, loading, None),
    };
    let mut method = algorithm.start(small, loads);
    linear.analyze(method.matrix())?;
    let held = HeldBody::new(method.as_mut(), small, loads, &settings.scaling, &mut linear)?;
    outcome.linear = statistics(&linear, body, 0.0);
    let held = match held {
        Ok(held) => held,
        Err(free_motion) => {
            return Ok(HistoryOutcome { status: Status::Singular, free_motion, ..outcome });
        }
    };
    outcome.setup_seconds = start.elapsed().as_secs_f64();
    observer.ready();
    let mut path = Path::new(problem, loading, settings, condensed.as_ref(), method, held);

    for (k, &time) in times.iter().enumerate() {
        let index = k + 1;
        let start = Instant::now();
        let before = *linear.statistics();
        let increment = match path.increment(time, &mut linear, &mut Told { problem, index, observer: &mut *observer })
        {
            Ok(increment) => increment,
            Err(LinearError::OutOfMemory { .. }) => {
                outcome.status = Status::OutOfMemory;
                break;
            }
            Err(error) => return Err(error.into()),
        };
        let statuses = statuses_of(problem, &path.data(), &increment.attempt.state, &increment.attempt.scales);
        let (assembly, all) = (increment.solved.assembly_seconds, start.elapsed().as_secs_f64());
        let seconds = Seconds::between(&before, linear.statistics(), assembly, all);
        let record = record(problem, path.data().force, index, time, &increment, ContactCounts::of(&statuses), seconds);
        let Walked { solved, attempt, status, .. } = increment;
        let (flow, state) = path.show(&attempt.state, |increment, state| {
            (observer.increment(&Step { record: &record, increment, state, statuses: &statuses }), state.clone())
        });
        outcome.records.push(record);
        outcome.linear = statistics(&linear, body, path.worst_backward_error);
        if status != Status::Converged || index == times.len() {
            outcome.rounding = rounding_level(problem, &attempt.state, &attempt.scales);
        }
        outcome.status = status;
        outcome.reached = path.reached.unwrap_or(0.0);
        if status != Status::Converged {
            outcome.violation = Some(Violation::worst(problem, &path.data(), &attempt.state, &attempt.scales));
            if let Stop::Unheld(motion) | Stop::NoEquilibrium(motion) | Stop::EdgeFriction(motion) = solved.stop {
                outcome.free_motion = Some(motion);
            }
            break;
        }
        outcome.state = state;
        outcome.scales = attempt.scales;
        if flow == Flow::Stop && index < times.len() {
            outcome.status = Status::Interrupted;
            break;
        }
    }
    Ok(outcome)
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
