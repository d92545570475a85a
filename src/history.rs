//! A load history: one contact problem after the other, each starting from the last solution.

mod bn;
mod held;
mod ip;
mod method;
mod newton_end;
mod observer;
mod path;
mod predictor_corrector;
mod record;
mod settings;
mod whole;

use std::time::Instant;

pub use observer::{Observer, Step};
pub use record::{ContactCounts, IncrementRecord, Seconds, Status};
pub use settings::{FirstGuess, HistorySettings, Method, Start};

use crate::condense::Condensed;
use crate::contact::{KktScales, Violation, rounding_level, statuses};
use crate::formulation::Layout;
use crate::linear::{Direct, LinearError, Statistics};
use crate::loading::Loading;
use crate::nonlinear::{Flow, Stop};
use crate::problem::{ContactProblem, State};
use held::HeldBody;
use path::{Path, Walked};

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
    /// contact forces: the weights of the problem's `free_motions` in it.
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
/// When the linear algebra cannot go on. If memory runs out in an increment, that is its verdict.
///
/// # Panics
/// If the arrays of `problem`, `loading` and `settings` do not have the lengths they say.
pub fn run(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    settings: &HistorySettings,
    linear: &mut Direct,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, LinearError> {
    let start = Instant::now();
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
        linear: *linear.statistics(),
        setup_seconds: 0.0,
    };
    if outcome.layout.has_second_tangent() && !settings.method.knows_two_tangents() {
        return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
    }
    let condensed = match linear.condenses().then(|| Condensed::new(problem, loading)).transpose() {
        Ok(condensed) => condensed,
        Err(LinearError::Singular { .. }) => {
            let free_motion = method::new(problem, loading, settings).hold_contacts().err();
            return Ok(HistoryOutcome { status: Status::Singular, free_motion, ..outcome });
        }
        Err(error) => return Err(error),
    };
    let (small, loads) = match &condensed {
        Some(condensed) => {
            linear.stand_on(condensed.info());
            (&condensed.problem, &condensed.loading)
        }
        None => (problem, loading),
    };
    let mut method = method::new(small, loads, settings);
    linear.analyze(&method.matrix().pattern)?;
    outcome.linear = *linear.statistics();
    let held = match HeldBody::new(method.as_mut(), small, loads, &settings.scaling, linear)? {
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
        let increment = match path.increment(time, linear, &mut |record| observer.iteration(index, record)) {
            Ok(increment) => increment,
            Err(LinearError::OutOfMemory { .. }) => {
                outcome.status = Status::OutOfMemory;
                break;
            }
            Err(error) => return Err(error),
        };
        let Walked { solved, attempt, kkt, status, parts, friction_work } = increment;
        let statuses = statuses(problem, &path.data(), &attempt.state, &attempt.scales);
        let after = *linear.statistics();
        let seconds = Seconds::between(&before, &after, solved.assembly_seconds, start.elapsed().as_secs_f64());
        let record = IncrementRecord {
            index,
            time,
            status,
            parts,
            rescued: solved.rescued,
            iterations: solved.iterations,
            backtracks: solved.backtracks,
            theta: solved.theta,
            kkt,
            backward_error: solved.backward_error,
            contact: ContactCounts::of(&statuses),
            friction_work,
            seconds,
        };
        let data = path.data();
        let flow =
            observer.increment(&Step { record: &record, increment: &data, state: &attempt.state, statuses: &statuses });
        outcome.records.push(record);
        outcome.linear = after;
        if status != Status::Converged || index == times.len() {
            outcome.rounding = rounding_level(problem, &attempt.state, &attempt.scales);
        }
        outcome.status = status;
        outcome.reached = path.reached.unwrap_or(0.0);
        if status != Status::Converged {
            outcome.violation = Some(Violation::worst(problem, &data, &attempt.state, &attempt.scales));
            if let Stop::Unheld(motion) | Stop::NoEquilibrium(motion) = solved.stop {
                outcome.free_motion = Some(motion);
            }
            break;
        }
        outcome.state = attempt.state;
        outcome.scales = attempt.scales;
        if flow == Flow::Stop && index < times.len() {
            outcome.status = Status::Interrupted;
            break;
        }
    }
    Ok(outcome)
}
