//! A load history: one contact problem after the other, each starting from the last solution.

mod interior;

use std::fmt;
use std::time::Instant;

use serde::Serialize;

use crate::contact::{ContactStatus, KktErrors, KktScales, rounding_level, statuses};
use crate::formulation::{Bdiff, Conventions, Formulation, Layout};
use crate::linear::{Direct, LinearError, Statistics};
use crate::loading::Loading;
use crate::nonlinear::{Bn, BnSettings, Flow, IterationRecord, Outcome, Stop};
use crate::problem::{ContactProblem, Increment, State};
use crate::units::Scaling;
use interior::Interior;

/// How a history is solved.
#[derive(Debug, Clone, PartialEq)]
pub struct HistorySettings {
    /// The constants of Algorithm BN.
    pub bn: BnSettings,
    /// `r_i` and the units of `Theta`.
    pub conventions: Conventions,
    /// The units of the numbers inside.
    pub scaling: Scaling,
    /// The normal stress every contact node has before the first increment, Pa. A guess that the
    /// iteration starts from; it has no part in the solution.
    pub start_pressure: f64,
    /// An increment has converged when every component of its [`KktErrors`] is at most this.
    pub tolerance: f64,
}

impl HistorySettings {
    /// The paper's conventions: `p_n = 1 MPa · l` to start from, 10 MPa from 100 contact nodes on.
    pub fn paper(problem: &ContactProblem, scaling: Scaling, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings {
            bn: BnSettings::paper(max_iterations),
            conventions: Conventions::paper(problem),
            scaling,
            start_pressure: if problem.contacts() < 100 { 1e6 } else { 1e7 },
            tolerance,
        }
    }
}

/// The verdict on an increment and on a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Every law holds within the tolerance, by the independent error measure.
    Converged,
    /// The solver's own stop test was met, but a law is violated by more than the tolerance.
    Inaccurate,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The iteration left the range of numbers.
    Diverged,
    /// The linearised problem is singular, as when nothing holds the body.
    Singular,
    /// Stopped on request.
    Interrupted,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Status::Converged => "converged",
            Status::Inaccurate => "inaccurate",
            Status::MaxIterations => "max-iterations",
            Status::Diverged => "diverged",
            Status::Singular => "singular",
            Status::Interrupted => "interrupted",
        })
    }
}

/// How many contact nodes are in each status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct ContactCounts {
    /// Apart from the obstacle.
    pub open: usize,
    /// In contact without slip.
    pub stick: usize,
    /// In contact and sliding.
    pub slip: usize,
}

/// Where the wall time of an increment went, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Residuals, merits and Jacobian values.
    pub assembly: f64,
    /// Factorisations.
    pub factorization: f64,
    /// Solves with refinement and backward error.
    pub solve: f64,
    /// Everything else: loads, the error measure, records.
    pub rest: f64,
}

/// One increment, as reported.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IncrementRecord {
    /// Its number, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The verdict.
    pub status: Status,
    /// Linear systems solved (nle).
    pub iterations: usize,
    /// Steps shortened.
    pub backtracks: usize,
    /// The last `Theta` of the solver.
    pub theta: f64,
    /// The error measure.
    pub kkt: KktErrors,
    /// The largest componentwise backward error of the linear solves.
    pub backward_error: f64,
    /// Statuses of the contact nodes.
    pub contact: ContactCounts,
    /// Wall time.
    pub seconds: Seconds,
}

/// An increment with its data and state, for an observer.
#[derive(Debug, Clone, Copy)]
pub struct Step<'a> {
    /// The record.
    pub record: &'a IncrementRecord,
    /// What drove the increment.
    pub increment: &'a Increment<'a>,
    /// The state at its end.
    pub state: &'a State,
    /// The status of each contact node.
    pub statuses: &'a [ContactStatus],
}

/// Watches a history: for progress, files, plots, or to stop it.
pub trait Observer {
    /// When the patterns are analysed and the first matrix is factored, before the first increment.
    fn ready(&mut self) {}
    /// After each iteration of increment `index`.
    fn iteration(&mut self, _index: usize, _record: &IterationRecord) -> Flow {
        Flow::Continue
    }
    /// After each increment, the failed one included.
    fn increment(&mut self, _step: &Step<'_>) -> Flow {
        Flow::Continue
    }
}

/// An observer that only lets things happen.
impl Observer for () {}

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
    /// If the status is singular because a rigid motion is free: the weights of the problem's
    /// `free_motions` in it.
    pub unheld: Option<Vec<f64>>,
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
    let scaling = settings.scaling;
    let mut formulation = Bdiff::new(problem, scaling, &settings.conventions);
    let mut bn = Bn::new(settings.bn, formulation.unknowns());
    linear.analyze(&formulation.jacobian().pattern)?;
    let mut outcome = HistoryOutcome {
        status: Status::Converged,
        records: Vec::with_capacity(times.len()),
        state: State::zero(problem),
        scales: KktScales::default(),
        rounding: 0.0,
        unheld: None,
        layout: formulation.layout().clone(),
        linear: *linear.statistics(),
        setup_seconds: 0.0,
    };
    let mut interior = match Interior::new(&mut formulation, loading, linear)? {
        Ok(interior) => interior,
        Err(unheld) => {
            return Ok(HistoryOutcome { status: Status::Singular, unheld, ..outcome });
        }
    };
    outcome.setup_seconds = start.elapsed().as_secs_f64();
    observer.ready();

    let mut force = vec![0.0; problem.displacements()];
    let mut gap = vec![0.0; problem.contacts()];
    let start = State { p_n: start_forces(problem, loading, settings), ..State::zero(problem) };
    let mut z = outcome.layout.pack(&start, &scaling);

    for (k, &time) in times.iter().enumerate() {
        let start = Instant::now();
        let before = *linear.statistics();
        loading.force(time, &mut force);
        loading.gap_at(time, &mut gap);
        let w_t_last = problem.c_t.mul(&outcome.state.u);
        let increment = Increment { force: &force, gap: &gap, w_t_last: &w_t_last };
        formulation.begin(&increment);
        interior.advance(loading, time, &mut z);
        let index = k + 1;
        let solved = bn.solve(&mut formulation, linear, &mut z, &mut |record| observer.iteration(index, record))?;

        let state = outcome.layout.unpack(&z, &scaling);
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
            contact: count(&statuses),
            seconds,
        };
        let flow =
            observer.increment(&Step { record: &record, increment: &increment, state: &state, statuses: &statuses });
        outcome.records.push(record);
        outcome.linear = after;
        outcome.status = status;
        if status != Status::Converged {
            outcome.rounding = rounding_level(problem, &state, &scales);
            if let Stop::Unheld(motion) = stop {
                outcome.unheld = Some(motion);
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

/// `p_n` before the first increment. Without load or interference that is 0, the solution. A body
/// that only contact holds starts with every node closed, `p_n > r g`: its first matrix would be
/// singular with open ones.
fn start_forces(problem: &ContactProblem, loading: &Loading, settings: &HistorySettings) -> Vec<f64> {
    if loading.largest_force() == 0.0 && loading.largest_interference() == 0.0 {
        return vec![0.0; problem.contacts()];
    }
    let held = problem.free_motions.is_empty();
    let closing = |i: usize| if held { 0.0 } else { 2.0 * settings.conventions.r[i] * loading.gap[i] };
    let guess = problem.weight.iter().map(|l| l * settings.start_pressure);
    guess.enumerate().map(|(i, p_n)| p_n.max(closing(i))).collect()
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
        Stop::Unheld(_) | Stop::Singular(_) => Status::Singular,
    }
}

fn count(statuses: &[ContactStatus]) -> ContactCounts {
    let mut counts = ContactCounts::default();
    for status in statuses {
        match status {
            ContactStatus::Open => counts.open += 1,
            ContactStatus::Stick => counts.stick += 1,
            ContactStatus::Slip => counts.slip += 1,
        }
    }
    counts
}
