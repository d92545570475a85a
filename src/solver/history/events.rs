//! A history along its exact path in time. An increment here is the interval between two output times; it does not affect
//! the path.

use super::body::{Body, RecoveredState, Responds};
use super::driver::HistoryDriver;
use super::record::{IncrementView, Observer, Seconds, Status, is_solution};
use super::saved::{RunOf, SavedPath};
use super::settings::HistorySettings;
use super::state::{HistoryState, Step};
use super::system::{SystemSolver, statistics};
use super::{Error, HistoryOutcome, Slip, check_times};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver, Statistics};
use crate::solver::checkpoint::CheckpointError;
use crate::solver::condensation::Condensed;
use crate::solver::events::{Equations, Event, ExactPath, PathError, SegmentEnd};
use crate::solver::laws::{Judgement, KktScales, statuses_of};
use crate::solver::loading::Loading;
use crate::solver::newton::{IterationRecord, MethodResult};
use crate::solver::problem::{ContactProblem, Increment, State};
use crate::solver::solvability::{Load, driven_motion, excess, friction_work, sliding_motion};
use std::ops::ControlFlow;
use std::time::Instant;

/// A joint slips as a whole if the work of its loads is that of all friction, within this share: a path ends where the
/// last node begins to slip, with this many digits.
const USED_UP: f64 = 1e-6;

/// The share by which the pressure falls in the search for the motion of such a joint.
const FALLING: f64 = 1e-3;

/// A history in which each step from event to event is judged, and each end of an increment on the whole body.
struct ExactHistory<'a> {
    body: Body<'a>,
    /// The ends of all increments, s.
    times: &'a [f64],
    settings: &'a HistorySettings,
    observer: &'a mut dyn Observer,
    path: ExactPath<'a>,
    /// The scales of the steps from event to event, and of the increments.
    scales: [KktScales; 2],
    outcome: HistoryOutcome,
}

/// The start of a step, for the friction law.
struct StepStart {
    /// The displacements relative to the obstacles along both tangents, n_c, m.
    slips: [Vec<f64>; 2],
    /// The gaps, n_c, m.
    gap: Vec<f64>,
    time: f64,
}

/// An increment so far.
struct IncrementSoFar {
    index: usize,
    clock: Instant,
    before: Statistics,
    rates: usize,
    /// The sum of its steps, with the state of none.
    sum: Step,
}

/// Follows the exact path in time from event to event, to the end of the history or to the end of the quasi-static
/// motion. All nodes must slide along lines, as in the plane. Nodes whose contact rows depend on others have no friction
/// here. `observer` sees the path at the `times` (s), which do not affect it.
///
/// # Errors
/// As [`super::run`].
pub fn follow_exact_path(
    problem: &ContactProblem,
    loading: &Loading,
    times: &[f64],
    settings: &HistorySettings,
    system: SystemSolver,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, Error> {
    let start = Instant::now();
    loading.check(problem)?;
    settings.check(problem)?;
    check_times(times)?;
    // Rates of dependent rows are not unique, and nodes that touch two obstacles hardly slide.
    let mut mu = problem.mu().to_vec();
    problem.dependent_nodes().into_iter().for_each(|i| mu[i] = 0.0);
    let problem = &problem.with_friction(mu)?;
    let mut outcome = HistoryOutcome::unsolved(problem);
    let saved = settings.from.as_ref().map(|from| SavedPath::read(from, problem, loading, times, settings));
    let saved = saved.transpose()?;
    let (mut linear, condensation) = match system {
        SystemSolver::Whole(linear) => (linear, None),
        SystemSolver::Condensed(condensation) => (RefinedSolver::default(), Some(condensation)),
    };
    if let Some(saved) = &saved {
        linear = linear.after(saved.path.statistics());
    }
    let condensed = condensation.as_ref().map(|body| Condensed::new(problem, loading, body.clone())).transpose();
    let path = match &condensed {
        Ok(Some(Condensed { problem, loading, .. })) => {
            ExactPath::new(problem, loading, settings.scaling, Equations::Dense)
        }
        Ok(None) => ExactPath::new(problem, loading, settings.scaling, Equations::Sparse(&mut linear)),
        Err(error) => Err(error.clone().into()),
    };
    let path = match path {
        Ok(path) => path,
        Err(PathError::Linear(LinearError::Singular { .. })) => {
            outcome.end_unconstrained(settings, problem, loading);
            return Ok(outcome);
        }
        Err(PathError::SlidesInAPlane | PathError::FrictionChanges | PathError::DependentRows) => {
            return Ok(HistoryOutcome { status: Status::Unsupported, ..outcome });
        }
        Err(error) => return Err(error.into()),
    };
    outcome.setup_seconds = start.elapsed().as_secs_f64();
    observer.ready();
    let body = Body { problem, loading, condensed: condensed.as_ref().ok().and_then(Option::as_ref) };
    let scales = Default::default();
    let mut history = ExactHistory { body, times, settings, observer, path, scales, outcome };
    match history.follow(saved) {
        Err(Error::Linear(LinearError::OutOfMemory { .. })) => history.outcome.status = Status::OutOfMemory,
        followed => followed?,
    }
    Ok(history.outcome)
}

impl ExactHistory<'_> {
    fn follow(&mut self, saved: Option<SavedPath>) -> Result<(), Error> {
        let Body { problem, loading, condensed } = self.body;
        let factor = condensed.map(Condensed::info);
        if let Some(saved) = saved {
            if !self.path.resume(saved.path)? {
                return Err(CheckpointError::Damaged.into());
            }
            self.outcome.resume(saved.outcome);
            self.scales = saved.scales;
            // Keeps the earlier value if there is nothing left to solve.
            self.outcome.linear = statistics(self.path.statistics(), factor, 0.0);
        }
        for (k, &time) in self.times.iter().enumerate().skip(self.outcome.tally.increments) {
            let mut in_progress = IncrementSoFar {
                index: k + 1,
                clock: Instant::now(),
                before: self.path.statistics(),
                rates: self.path.effort().solves,
                sum: Step::default(),
            };
            let (step_start, lost) = loop {
                let step_start =
                    StepStart { slips: self.path.slips(), gap: self.path.given().1, time: self.path.time() };
                let step = self.path.step(time)?;
                step.events.into_iter().for_each(|event| self.report(in_progress.index, event));
                in_progress.sum.friction_work += step.friction_work;
                match step.stop {
                    SegmentEnd::PathEnd(lost) => break (step_start, Some(lost)),
                    SegmentEnd::Event if self.path.is_beginning() => {}
                    stop => {
                        self.judge_step(stop, &step_start, &mut in_progress)?;
                        if stop == SegmentEnd::Until {
                            break (step_start, None);
                        }
                    }
                }
                let error = Some(in_progress.sum.kkt.worst().1);
                let iteration = self.path.effort().solves - in_progress.rates;
                let progress = IterationRecord { iteration, error, ..IterationRecord::start(f64::NAN) };
                if self.observer.iteration(in_progress.index, &progress).is_break() {
                    self.outcome.status = Status::Interrupted;
                    return Ok(());
                }
            };
            let reached = lost.map_or(time, |lost| lost.time);
            // The gaps of the path itself: others would differ by rounding, which counts while there are no forces yet.
            let (_, gap, drift) = self.path.given();
            let force = self.under_load(reached, |load| load.force.to_vec());
            let data = StepData::of(problem, reached, (force, gap, drift), &step_start);
            in_progress.sum.ends.push(reached);
            let balanced = self.balanced(&data)?;
            self.outcome.lost = lost;
            let slide = lost.and_then(|_| self.sliding_motion(time, &data, &balanced.state));
            self.outcome.slip = slide.is_some().then(|| Slip { by: time, p_n: balanced.state.p_n.clone() });
            self.outcome.free_motion = slide.or_else(|| lost.and_then(|_| self.driven_motion(time)));
            let ended = if self.outcome.slip.is_some() { Status::Slips } else { Status::NoContinuation };
            let flow = self.end(in_progress, &data, balanced, lost.map(|_| ended))?;
            self.outcome.linear = statistics(self.path.statistics(), factor, 0.0);
            if self.outcome.status != Status::Converged {
                return Ok(());
            }
            if flow.is_break() && k + 1 < self.times.len() {
                self.outcome.status = Status::Interrupted;
                return Ok(());
            }
            let ExactHistory { outcome, path, scales, times, settings, .. } = self;
            let run = || RunOf::new(problem, loading, &times[..=k], settings);
            let here = || SavedPath::checkpoint(run(), outcome, path, scales.clone());
            self.observer.checkpoint_offered(&here);
        }
        Ok(())
    }

    /// Reports a change of status in increment `index`.
    fn report(&mut self, index: usize, event: Event) {
        self.observer.event(index, &event);
        self.outcome.event_count += 1;
        if self.settings.keeps_records {
            self.outcome.events.push(event);
        }
    }

    /// Judges a step from event to event, on the problem of the path.
    fn judge_step(
        &mut self,
        stop: SegmentEnd,
        step_start: &StepStart,
        in_progress: &mut IncrementSoFar,
    ) -> Computed<()> {
        let (problem, _) = self.body.solved();
        let (state, now) = (self.path.state(), self.path.time());
        let data = StepData::of(problem, now, self.path.given(), step_start);
        let increment = data.increment();
        // The rounding of the gaps at its start is left in those at its end.
        let start = Increment { gap: &step_start.gap, ..increment };
        for (scales, problem) in self.scales.iter_mut().zip([problem, self.body.problem]) {
            *scales = scales.with_terms(problem, &[]).with_gaps(problem, &start, &vec![0.0; problem.displacements()]);
        }
        let judgement = Judgement::near(problem, &increment, &state, &self.scales[0], self.settings.tolerance)?;
        in_progress.sum.kkt = in_progress.sum.kkt.max(&judgement.errors());
        self.scales[0] = judgement.scales();
        // Loads at t = 0 are applied in a substep of their own, which takes no time.
        if stop != SegmentEnd::Until && (now > step_start.time || now == 0.0) {
            in_progress.sum.ends.push(now);
        }
        Ok(())
    }

    /// Returns a rigid motion that the loads at `time` drive against all contact forces, if there is one.
    fn driven_motion(&self, time: f64) -> Option<Vec<f64>> {
        self.under_load(time, |load| driven_motion(self.body.problem, self.body.problem.mu(), load))
    }

    /// Returns the rigid motion along the contact in which the loads at `time`, or those at the end of the path after a small loss
    /// of pressure, overcome friction, if the friction of `state` against it is used up at that end.
    fn sliding_motion(&self, time: f64, end: &StepData, state: &State) -> Option<Vec<f64>> {
        let (problem, mu, p_n) = (self.body.problem, self.body.problem.mu(), &state.p_n);
        // Where the pressure falls, loads of the same size overcome less friction.
        let less: Vec<f64> = p_n.iter().map(|p| (1.0 - FALLING) * p).collect();
        let at_end = || self.under_load(end.time, |load| sliding_motion(problem, mu, load, &less));
        let motion = self.under_load(time, |load| sliding_motion(problem, mu, load, p_n)).or_else(at_end)?;
        let most = friction_work(problem, mu, p_n, &problem.rigid_motion(&motion));
        let left = excess(problem, mu, &end.force, p_n, &motion).abs();
        (left <= USED_UP * most).then_some(motion)
    }

    /// Evaluates `evaluate` for the loads at `time`.
    fn under_load<T>(&self, time: f64, evaluate: impl FnOnce(&Load<'_>) -> T) -> T {
        let Body { problem, loading, .. } = self.body;
        let n = problem.displacements();
        let (mut force, sizes) = (vec![0.0; n], loading.force_sizes(time, n));
        loading.force(time, &mut force);
        evaluate(&Load { force: &force, sizes: &sizes })
    }

    /// Returns the state of the whole body at the time that the path has reached, with the loads there in the scales.
    fn balanced(&mut self, data: &StepData) -> Result<RecoveredState, Error> {
        let (body, scales) = (self.body, &mut self.scales[1]);
        *scales = scales.with_terms(body.problem, &body.loading.force_sizes(data.time, body.problem.displacements()));
        let recovered = body.recovered(data.time, self.path.state(), &data.force)?;
        Ok(body.refined(recovered, (&data.increment(), scales, self.settings.tolerance), &mut self.path)?)
    }

    /// Judges the end of an increment on the whole body, and reports it.
    fn end(
        &mut self,
        in_progress: IncrementSoFar,
        data: &StepData,
        balanced: RecoveredState,
        status: Option<Status>,
    ) -> Computed<ControlFlow<()>> {
        let (problem, tolerance) = (self.body.problem, self.settings.tolerance);
        let RecoveredState { state, backward_error, .. } = balanced;
        let increment = data.increment();
        let judgement = Judgement::near(problem, &increment, &state, &self.scales[1], tolerance)?;
        let kkt = in_progress.sum.kkt.max(&judgement.errors());
        self.outcome.rounding = judgement.rounding();
        let (violation, scales) = (judgement.worst(), judgement.scales());
        self.scales[1] = scales.clone();
        let judged = if is_solution(&kkt, tolerance) { Status::Converged } else { Status::Inaccurate };
        let status = status.unwrap_or(judged);
        let statuses = statuses_of(problem, &increment, &state);
        let after = self.path.statistics();
        let solved = MethodResult {
            iterations: self.path.effort().solves - in_progress.rates,
            backward_error: after.worst_backward_error.max(backward_error),
            theta: 0.0,
            ..MethodResult::nothing()
        };
        let seconds = Seconds::between(&in_progress.before, &after, 0.0, in_progress.clock.elapsed().as_secs_f64());
        let IncrementSoFar { index, sum, .. } = in_progress;
        let result = Step { solved, state, scales, kkt, status, ..sum };
        let record = result.record(problem, (index, data.time, &data.force), &statuses, seconds);
        let Step { state, scales, .. } = result;
        let flow = self.observer.increment(&IncrementView {
            record: &record,
            increment: &increment,
            state: &state,
            statuses: &statuses,
        });
        self.outcome.status = status;
        self.outcome.reached = data.time;
        if status == Status::Converged {
            (self.outcome.state, self.outcome.scales) = (state, scales);
        } else {
            // The largest error of a step from event to event belongs to another state, and so does its place.
            self.outcome.violation = (violation.error >= kkt.worst().1).then_some(violation);
        }
        self.outcome.push(record, self.settings.keeps_records);
        Ok(flow)
    }
}

/// Between two events an exact path responds as its rates do.
impl Responds for ExactPath<'_> {
    fn is_regular(&mut self) -> Computed<bool> {
        Ok(true)
    }

    fn respond(&mut self, forces: &[f64]) -> Computed<State> {
        self.response(forces)
    }

    /// Does nothing: the path continues from the state of its own problem, so that it does not depend on the output
    /// times.
    fn add_response(&mut self) {}
}

/// The data of a step, with the arrays that an [`Increment`] borrows.
struct StepData {
    time: f64,
    force: Vec<f64>,
    gap: Vec<f64>,
    mu: Vec<f64>,
    w_last: [Vec<f64>; 2],
}

impl StepData {
    /// Creates the data of a step from `step_start` to `time` from the forces, the gaps and the motions of the obstacles
    /// then.
    fn of(
        problem: &ContactProblem,
        time: f64,
        (force, gap, drift): (Vec<f64>, Vec<f64>, [Vec<f64>; 2]),
        step_start: &StepStart,
    ) -> Self {
        let past = |k: usize| step_start.slips[k].iter().zip(&drift[k]).map(|(slip, drift)| slip + drift).collect();
        StepData { time, force, gap, mu: problem.mu().to_vec(), w_last: [0, 1].map(past) }
    }

    fn increment(&self) -> Increment<'_> {
        let StepData { force, gap, mu, w_last: [w_t_last, w_o_last], .. } = self;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }
}

/// The start of increments that are solved again.
pub(crate) struct RestartPoint<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub settings: &'a HistorySettings,
    /// The time at their start, s.
    pub time: f64,
    /// The state at that time.
    pub state: State,
    pub scales: KktScales,
}

impl RestartPoint<'_> {
    /// Solves the increments that end at `times` (s), as far as they converge, and shows them to `observer`. Returns
    /// the last outcome.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(crate) fn proceed(
        &self,
        times: &[f64],
        observer: &mut dyn Observer,
        system: &mut SystemSolver,
    ) -> Result<Status, Error> {
        let &RestartPoint { problem, loading, settings, ref state, ref scales, .. } = self;
        let [w_n, w_t, w_o] = problem.contact_motion(&state.u);
        let mut history = HistoryState {
            reached: Some(self.time),
            state: Some(state.clone()),
            scales: scales.clone(),
            w_n,
            w_t,
            w_o,
            ..HistoryState::start(problem)
        };
        let mut driver = HistoryDriver::new(problem, loading, times, settings, observer, &mut history);
        driver.is_ready = true;
        match system {
            SystemSolver::Whole(linear) => drop(driver.stage(settings, driver.body, linear)?),
            SystemSolver::Condensed(condensation) => driver.condensed(settings, condensation)?,
        }
        Ok(driver.outcome.status)
    }
}
