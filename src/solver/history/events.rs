//! A history along its exact path in time. An increment here is the interval between two output times; it does not affect
//! the path.
//!
//! # Jumps
//!
//! A jump is an increment beyond the end of the quasi-static motion, to a state that the laws of an increment allow.
//!
//! Which of these states a body reaches is a question of dynamics. Newton's method starts from the last state, the
//! interior point method from a point of its own. If neither reaches the end of the increment, both try half of the
//! increment, a quarter, and so on.

use super::body::{Body, RecoveredState, Responds};
use super::driver::HistoryDriver;
use super::record::{IncrementRecord, IncrementView, Observer, Seconds, Status, is_solution};
use super::saved::{RunOf, SavedPath};
use super::settings::HistorySettings;
use super::state::{HistoryState, Step};
use super::system::{SystemSolver, statistics};
use super::{Error, HistoryOutcome, Slip, check_times};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};
use crate::solver::checkpoint::CheckpointError;
use crate::solver::condensation::{Condensation, Condensed};
use crate::solver::events::{Equations, Event, ExactPath, Jump, PathEnd, PathError, SegmentEnd};
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

/// The settings of an exact path in time.
#[derive(Debug, Clone, PartialEq)]
pub struct ExactPathSettings {
    /// `true` if the path continues by a jump beyond the end of the quasi-static motion, to a state that the laws of an
    /// increment allow.
    pub jump: bool,
    /// The settings of the increments that are solved where the path jumps. The path itself has their scaling,
    /// tolerance, choice of records, and checkpoint.
    pub increments: HistorySettings,
}

/// A history in which each step from event to event is judged, and each end of an increment on the whole body.
struct ExactHistory<'a> {
    body: Body<'a>,
    condensation: Option<&'a Condensation>,
    /// The ends of all increments, s.
    times: &'a [f64],
    jump: bool,
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
    time: f64,
}

/// An increment so far.
struct IncrementSoFar {
    index: usize,
    /// The end of the increment, s.
    end: f64,
    clock: Instant,
    before: Statistics,
    rates: usize,
    jumps: usize,
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
    settings: &ExactPathSettings,
    system: SystemSolver,
    observer: &mut dyn Observer,
) -> Result<HistoryOutcome, Error> {
    let start = Instant::now();
    let ExactPathSettings { jump, increments: ref settings } = *settings;
    loading.check(problem)?;
    settings.check(problem)?;
    check_times(times)?;
    // Rates of dependent rows are not unique, and nodes that touch two obstacles hardly slide.
    let mut mu = problem.mu().to_vec();
    problem.dependent_nodes().into_iter().for_each(|i| mu[i] = 0.0);
    let problem = &problem.with_friction(mu)?;
    let mut outcome = HistoryOutcome::unsolved(problem);
    let saved = settings.from.as_ref().map(|from| SavedPath::read(from, problem, loading, times, settings, jump));
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
    let (condensation, scales) = (condensation.as_ref(), Default::default());
    let mut history = ExactHistory { body, condensation, times, jump, settings, observer, path, scales, outcome };
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
                end: time,
                clock: Instant::now(),
                before: self.path.statistics(),
                rates: self.path.effort().solves,
                jumps: 0,
                sum: Step::default(),
            };
            let (step_start, lost) = loop {
                let step_start = StepStart { slips: self.path.slips(), time: self.path.time() };
                let step = self.path.step(time)?;
                step.events.into_iter().for_each(|event| self.report(in_progress.index, event));
                in_progress.sum.friction_work += step.friction_work;
                match step.stop {
                    SegmentEnd::PathEnd(lost) if self.jump => {
                        if !self.jump(lost, &step_start, &mut in_progress)? {
                            break (step_start, Some(lost));
                        }
                    }
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
            let data = StepData::new(problem, loading, reached, &step_start);
            in_progress.sum.ends.push(reached);
            let balanced = self.balanced(&data)?;
            self.outcome.lost = lost;
            let slide = lost.and_then(|_| self.sliding_motion(time, &data, &balanced.state));
            self.outcome.slip = slide.is_some().then(|| Slip { by: time, p_n: balanced.state.p_n.clone() });
            self.outcome.free_motion = slide.or_else(|| lost.and_then(|_| self.driven_motion(time)));
            let flow = self.end(in_progress, &data, balanced, lost.map(|_| Status::NoContinuation))?;
            self.outcome.linear = statistics(self.path.statistics(), factor, 0.0);
            if self.outcome.status != Status::Converged {
                return Ok(());
            }
            if flow.is_break() && k + 1 < self.times.len() {
                self.outcome.status = Status::Interrupted;
                return Ok(());
            }
            let ExactHistory { jump, outcome, path, scales, times, settings, .. } = self;
            let run = || RunOf::new(problem, loading, &times[..=k], settings);
            let here = || SavedPath::checkpoint(run(), *jump, outcome, path, scales.clone());
            self.observer.rest(&here);
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
    ) -> Result<(), LinearError> {
        let (problem, _) = self.body.solved();
        let (state, now) = (self.path.state(), self.path.time());
        let data = StepData::of(problem, now, self.path.given(), step_start);
        let increment = data.increment();
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

    /// Returns the rigid motion along the contact in which the loads at `time` overcome friction, if the friction of
    /// `state` against it is used up at the end of the path.
    fn sliding_motion(&self, time: f64, end: &StepData, state: &State) -> Option<Vec<f64>> {
        let (problem, mu, p_n) = (self.body.problem, self.body.problem.mu(), &state.p_n);
        let motion = self.under_load(time, |load| sliding_motion(problem, mu, load, p_n))?;
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

    /// Continues by a jump from the end of the quasi-static motion, at most to the end of the increment. Returns
    /// `true` if a state was found.
    fn jump(&mut self, lost: PathEnd, step_start: &StepStart, in_progress: &mut IncrementSoFar) -> Result<bool, Error> {
        let (Body { problem, loading, .. }, settings) = (self.body, self.settings);
        let data = StepData::new(problem, loading, lost.time, step_start);
        let RecoveredState { state, .. } = self.balanced(&data)?;
        let scales = &mut self.scales[1];
        *scales = Judgement::near(problem, &data.increment(), &state, scales, settings.tolerance)?.scales();
        let edge = RestartPoint { problem, loading, settings, time: lost.time, state, scales: scales.clone() };
        let landed = match (self.condensation, self.path.linear_mut()) {
            (Some(condensation), _) => edge.jump(in_progress.end, &mut JumpSolver::Condensed(condensation))?,
            (None, Some(linear)) => edge.jump(in_progress.end, &mut JumpSolver::Whole(linear))?,
            (None, None) => None,
        };
        let Some((time, HistoryOutcome { state, records, .. })) = landed else { return Ok(false) };
        let data = StepData::new(problem, loading, time, &StepStart { slips: self.path.slips(), time: lost.time });
        let statuses = statuses_of(problem, &data.increment(), &state);
        let before = self.path.statuses().to_vec();
        self.path.continue_from(time, &self.body.restricted(&state), &statuses);
        let after = self.path.statuses().to_vec();
        for (node, (from, to)) in before.into_iter().zip(after).enumerate().filter(|(_, (a, b))| a != b) {
            self.report(in_progress.index, Event { time, node, from, to });
        }
        if let Some(record) = records.last() {
            in_progress.sum.kkt = in_progress.sum.kkt.max(&record.kkt);
            in_progress.sum.friction_work += record.friction_work;
        }
        in_progress.jumps += 1;
        in_progress
            .sum
            .ends
            .extend([lost.time, time].into_iter().filter(|end| *end < in_progress.end && *end > step_start.time));
        self.outcome.jumps.push(Jump { from: lost.time, to: time, certain: lost.certain });
        Ok(true)
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
    ) -> Result<ControlFlow<()>, LinearError> {
        let (problem, tolerance) = (self.body.problem, self.settings.tolerance);
        let RecoveredState { state, backward_error, .. } = balanced;
        let increment = data.increment();
        let judgement = Judgement::near(problem, &increment, &state, &self.scales[1], tolerance)?;
        let kkt = in_progress.sum.kkt.max(&judgement.errors());
        self.outcome.rounding = judgement.rounding();
        let violation = judgement.worst();
        let scales = judgement.scales();
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
        let IncrementSoFar { index, sum, jumps, .. } = in_progress;
        let result = Step { solved, state, scales, kkt, status, ..sum };
        let record = result.record(problem, (index, data.time, &data.force), &statuses, seconds);
        let (record, Step { state, scales, .. }) = (IncrementRecord { jumps, ..record }, result);
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
            self.outcome.violation = Some(violation);
        }
        self.outcome.push(record, self.settings.keeps_records);
        Ok(flow)
    }
}

/// Between two events an exact path responds as its rates do.
impl Responds for ExactPath<'_> {
    fn is_regular(&mut self) -> Result<bool, LinearError> {
        Ok(true)
    }

    fn respond(&mut self, forces: &[f64]) -> Result<State, LinearError> {
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
    /// Creates the data of a step from `step_start` to `time`.
    fn new(problem: &ContactProblem, loading: &Loading, time: f64, step_start: &StepStart) -> Self {
        let mut force = vec![0.0; problem.displacements()];
        loading.force(time, &mut force);
        let drift = [0, 1].map(|k| loading.drift_at(time, k));
        Self::of(problem, time, (force, loading.gaps_at(time), drift), step_start)
    }

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

/// The start of a jump, or of increments that are solved again.
pub(crate) struct RestartPoint<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub settings: &'a HistorySettings,
    /// The time at which the motion ended, s.
    pub time: f64,
    /// The state at that time.
    pub state: State,
    pub scales: KktScales,
}

/// The linear solver of a jump.
pub(crate) enum JumpSolver<'m> {
    /// The solver of the whole body.
    Whole(&'m mut RefinedSolver),
    /// The factorisation of the condensed body.
    Condensed(&'m Condensation),
}

impl RestartPoint<'_> {
    /// Jumps to the time `to` (s), or as far towards it as a solution is found. Returns the time reached with its outcome,
    /// or `None` if none is found.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(super) fn jump(&self, to: f64, solver: &mut JumpSolver<'_>) -> Result<Option<(f64, HistoryOutcome)>, Error> {
        let settings = HistorySettings { halvings: 0, ..self.settings.clone() };
        for halvings in 0..=self.settings.halvings {
            let time = self.time + (to - self.time) * 0.5_f64.powi(halvings as i32);
            if time <= self.time {
                break;
            }
            let outcome = self.try_to(&[time], &settings, &mut (), solver)?;
            if outcome.status == Status::Converged && !outcome.records.is_empty() {
                return Ok(Some((time, outcome)));
            }
        }
        Ok(None)
    }

    /// Solves the increments that end at `times` (s), as far as they converge, and shows them to `observer`. Returns
    /// the last outcome.
    ///
    /// # Errors
    /// As [`super::run`].
    pub(crate) fn proceed(
        &self,
        times: &[f64],
        observer: &mut dyn Observer,
        solver: &mut JumpSolver<'_>,
    ) -> Result<Status, Error> {
        Ok(self.try_to(times, self.settings, observer, solver)?.status)
    }

    fn try_to(
        &self,
        times: &[f64],
        settings: &HistorySettings,
        observer: &mut dyn Observer,
        solver: &mut JumpSolver<'_>,
    ) -> Result<HistoryOutcome, Error> {
        let &RestartPoint { problem, loading, ref state, ref scales, .. } = self;
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
        match solver {
            JumpSolver::Whole(linear) => {
                driver.stage(settings, driver.body, linear)?;
            }
            JumpSolver::Condensed(condensation) => driver.condensed(settings, condensation)?,
        }
        Ok(driver.outcome)
    }
}
