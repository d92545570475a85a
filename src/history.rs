//! A load history: one contact problem after the other, each starting from the last solution.

mod bn;
mod held;
mod ip;
mod method;
mod observer;
mod predictor_corrector;
mod record;
mod settings;

use std::time::Instant;

pub use observer::{Observer, Step};
pub use record::{ContactCounts, IncrementRecord, Seconds, Status};
pub use settings::{HistorySettings, Method, Start};

use crate::contact::{KktErrors, KktScales, rounding_level, statuses};
use crate::formulation::Layout;
use crate::linear::{Direct, LinearError, Statistics};
use crate::loading::Loading;
use crate::nonlinear::{Flow, Outcome, Stop};
use crate::problem::{ContactProblem, Increment, State};
use crate::solvability::rigid_equilibrium;
use held::HeldBody;
use method::Task;

/// The result of a history.
#[derive(Debug, Clone)]
pub struct HistoryOutcome {
    /// The verdict: that of the first increment that did not converge, if there is one.
    pub status: Status,
    /// One record per increment, up to the one that failed.
    pub records: Vec<IncrementRecord>,
    /// The state at the end of the last converged increment.
    pub state: State,
    /// The scales of the error measure, from all converged increments.
    pub scales: KktScales,
    /// The equilibrium error that rounding alone makes in the last increment.
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
/// When the linear algebra cannot go on, as for want of memory.
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
    let mut method = method::new(problem, loading, settings);
    linear.analyze(&method.matrix().pattern)?;
    let mut outcome = HistoryOutcome {
        status: Status::Converged,
        records: Vec::with_capacity(times.len()),
        state: State::zero(problem),
        scales: KktScales::default(),
        rounding: 0.0,
        free_motion: None,
        layout: Layout::new(problem),
        linear: *linear.statistics(),
        setup_seconds: 0.0,
    };
    let mut held = match HeldBody::new(method.as_mut(), problem, loading, &settings.scaling, linear)? {
        Ok(held) => held,
        Err(free_motion) => {
            return Ok(HistoryOutcome { status: Status::Singular, free_motion, ..outcome });
        }
    };
    outcome.setup_seconds = start.elapsed().as_secs_f64();
    observer.ready();

    let mut force = vec![0.0; problem.displacements()];
    let mut gap = vec![0.0; problem.contacts()];

    for (k, &time) in times.iter().enumerate() {
        let start = Instant::now();
        let before = *linear.statistics();
        loading.force(time, &mut force);
        loading.gap_at(time, &mut gap);
        let w_t_last = problem.c_t.mul(&outcome.state.u);
        let increment = Increment { force: &force, gap: &gap, w_t_last: &w_t_last };
        let response = held.advance(loading, time);
        let index = k + 1;
        let task = Task { first: k == 0, increment: &increment, response: &response, scales: &outcome.scales };
        let solved = match rigid_equilibrium(problem, &force) {
            Ok(()) => method.solve(&task, linear, &mut |record| observer.iteration(index, record))?,
            Err(motion) => Outcome { stop: Stop::NoEquilibrium(motion), ..Outcome::new(f64::NAN) },
        };

        let state = method.state();
        let scales = KktScales::after(&outcome.scales, &increment, &state);
        let kkt = KktErrors::measure(problem, &increment, &state, &scales);
        let statuses = statuses(problem, &increment, &state, &scales);
        let after = *linear.statistics();
        let mut seconds = Seconds {
            assembly: solved.assembly_seconds,
            factorization: after.factor_seconds - before.factor_seconds,
            solve: after.solve_seconds - before.solve_seconds,
            rest: 0.0,
        };
        seconds.rest = start.elapsed().as_secs_f64() - seconds.assembly - seconds.factorization - seconds.solve;
        let status = verdict(&solved, &kkt, settings.tolerance);
        let Outcome { stop, iterations, backtracks, theta, backward_error, .. } = solved;
        let record = IncrementRecord {
            index,
            time,
            status,
            iterations,
            backtracks,
            theta,
            kkt,
            backward_error,
            contact: ContactCounts::of(&statuses),
            seconds,
        };
        let flow =
            observer.increment(&Step { record: &record, increment: &increment, state: &state, statuses: &statuses });
        outcome.records.push(record);
        outcome.linear = after;
        outcome.status = status;
        if status != Status::Converged {
            outcome.rounding = rounding_level(problem, &state, &scales);
            if let Stop::Unheld(motion) | Stop::NoEquilibrium(motion) = stop {
                outcome.free_motion = Some(motion);
            }
            break;
        }
        outcome.state = state;
        outcome.scales = scales;
        if flow == Flow::Stop && index < times.len() {
            outcome.status = Status::Interrupted;
            break;
        }
    }
    Ok(outcome)
}

/// Converged is what the error measure says, whatever the solver thinks; how the solver ended only
/// tells why it did not. An increment that was interrupted is not judged.
fn verdict(solved: &Outcome, kkt: &KktErrors, tolerance: f64) -> Status {
    match solved.stop {
        Stop::Interrupted => Status::Interrupted,
        _ if kkt.worst().1 <= tolerance => Status::Converged,
        Stop::Met => Status::Inaccurate,
        Stop::MaxIterations => Status::MaxIterations,
        Stop::Diverged => Status::Diverged,
        Stop::Stalled => Status::Stalled,
        Stop::Unheld(_) | Stop::Singular(_) => Status::Singular,
        Stop::NoEquilibrium(_) => Status::NoEquilibrium,
    }
}
