//! One increment, halved if it fails, and divided where nodes first touch (`first_touch.rs`).
//!
//! A substep is an increment of its own; friction depends on the slip in each. A substep that is divided leaves only its
//! counts and its largest backward error. After a substep converges, the next one ends where the halved interval ended:
//! T/4, T/4, T/2.
//!
//! A joint that slips as a whole at the end of a substep (`strategy.rs`) gives way where the work of the loads reaches that of
//! friction, by linear interpolation. One substep ends a little after that time and one a little before it.
//!
//! # The working set
//!
//! Condensed equations contain the contact nodes of the working set only.
//!
//! Open nodes have `p = 0`. A state without some nodes therefore satisfies all laws if these nodes do not penetrate
//! and the other nodes satisfy the laws. The verdict always covers all contact nodes. If nodes outside the working
//! set penetrate, they join it together with the nearest other nodes. No node leaves it.

use super::body::{Body, RecoveredState};
use super::increment_error::{IncrementError, IncrementErrors};
use super::record::{IncrementView, Observer, Seconds, is_solution};
use super::settings::HistorySettings;
use super::stage::{Linearized, Stage};
use super::state::{HistoryState, IncrementInProgress, RigidOffset, Step};
use super::task::{Observe, Task};
use super::{Slip, Status, record};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::solver::laws::{ContactStatus, Judgement, KktScales, statuses_of};
use crate::solver::newton::{Iteration, MethodResult, Termination};
use crate::solver::problem::{ContactProblem, Increment, State};
use crate::solver::solvability::{Landing, Load, NEARBY, driven_motion, excess, is_held_by_friction, landing};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// The margin on either side of the time at which a joint slips, relative to the increment. Nearer to it the nodes of a
/// body that slides in a plane move far, until friction has turned.
const NEAR_SLIP: f64 = 1.0 / 16.0;

/// The largest number of touches at which an increment is divided. With one division, two nodes that touch one after the other
/// still have the wrong friction. Six divisions reduce the error of friction no further, and take five times as many iterations
/// where a slender body lands on many nodes.
const TOUCHES: usize = 2;

/// The shortest substep that ends at a touch, relative to its increment.
const NEAREST: f64 = 1e-6;

/// The increments of a stage, from the state that the history has reached.
pub(super) struct IncrementDriver<'a> {
    pub body: Body<'a>,
    pub settings: &'a HistorySettings,
    pub stage: &'a mut Stage,
    /// The state that the history has reached.
    pub history: &'a mut HistoryState,
}

/// The progress of an increment.
pub(super) enum IncrementEnd {
    /// The increment reached its end, or the place where it failed.
    Ended(Box<Step>),
    /// The equations lack contact nodes; the value is the working set needed to continue.
    NeedsNodes(Vec<usize>),
}

/// The data to which a substep that fails or is divided returns.
pub(super) struct Rollback {
    pub unknowns: Vec<f64>,
    /// The state with these unknowns.
    pub state: State,
    offset: RigidOffset,
    errors: Option<IncrementErrors>,
}

/// The input of a substep, in addition to its data.
pub(super) struct SubstepInput {
    /// The time of the state from which the method starts, s.
    begins: Option<f64>,
    /// The sizes of the loads whose sum is `force`, N.
    sizes: Vec<f64>,
    /// The nodes on which the body comes to rest.
    landed: Option<Vec<usize>>,
    /// The scales of the earlier increments and of the load.
    scales: KktScales,
}

/// The size of a history's working set.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct WorkingSet {
    /// The number of contact nodes at first.
    pub first: usize,
    /// The number of contact nodes at the end.
    pub last: usize,
    /// The number of all contact nodes.
    pub all: usize,
    /// The number of times that nodes joined.
    pub grown: usize,
}

/// The larger working set that is needed to continue.
struct MissingNodes {
    /// The contact nodes of the larger set, ascending.
    nodes: Vec<usize>,
    /// `true` if the last state solves the equations of the smaller set.
    solved: bool,
}

/// The observer of increment `index`.
pub(super) struct IncrementObserver<'a> {
    pub problem: &'a ContactProblem,
    pub index: usize,
    pub observer: &'a mut dyn Observer,
    /// `true` once the observer has asked to stop.
    pub has_stopped: bool,
}

impl IncrementObserver<'_> {
    pub(super) fn iteration(&mut self, iteration: &Iteration<'_>) -> ControlFlow<()> {
        let flow = iteration
            .system
            .map_or(ControlFlow::Continue(()), |system| self.observer.linear_system(self.index, &system));
        let flow = if flow.is_break() { flow } else { self.observer.iteration(self.index, &iteration.record) };
        self.has_stopped |= flow.is_break();
        flow
    }

    /// Reports a converged substep that ends at `time`. `data` is relative to the rigid offset; observers receive
    /// `increment` and `state` relative to the initial configuration.
    pub(super) fn report_substep(
        &mut self,
        time: f64,
        data: &Increment<'_>,
        result: &Step,
        increment: &Increment<'_>,
        state: &State,
    ) {
        let statuses = statuses_of(self.problem, data, &result.state);
        let at = (self.index, time, data.force);
        let record = result.record(self.problem, at, &statuses, Seconds::default());
        self.observer.substep(&IncrementView { record: &record, increment, state, statuses: &statuses });
    }
}

/// Removes the forces below rounding that an iterative solver leaves at open nodes.
fn release_open(problem: &ContactProblem, data: &Increment<'_>, state: &mut State) {
    let rounding = f64::EPSILON * state.p_n.iter().copied().fold(0.0, f64::max);
    for (i, status) in statuses_of(problem, data, state).into_iter().enumerate() {
        let forces = [&mut state.p_n[i], &mut state.p_t[i], &mut state.p_o[i]];
        forces.into_iter().filter(|p| status == ContactStatus::Open && p.abs() <= rounding).for_each(|p| *p = 0.0);
    }
}

impl IncrementDriver<'_> {
    /// Returns the data of the substep tried last, relative to the rigid offset, as is the state of a
    /// [`Step`].
    pub(super) fn data(&self) -> Increment<'_> {
        let Stage { force, gap, mu, w_t_last, w_o_last, .. } = &*self.stage;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }

    /// Calls `evaluate` with the last substep's data and state, both relative to the initial configuration.
    pub(super) fn show<T>(&self, state: &State, evaluate: impl FnOnce(&Increment<'_>, &State) -> T) -> T {
        let RigidOffset { w_n, w_t: [w_t, w_o], .. } = &self.history.offset;
        if !self.history.offset.is_nonzero() {
            return evaluate(&self.data(), state);
        }
        let moved = |x: &[f64], by: &[f64]| x.iter().zip(by).map(|(x, by)| x + by).collect::<Vec<f64>>();
        let gap = moved(&self.stage.gap, w_n);
        let (w_t_last, w_o_last) = (moved(&self.stage.w_t_last, w_t), moved(&self.stage.w_o_last, w_o));
        let data = Increment { gap: &gap, w_t_last: &w_t_last, w_o_last: &w_o_last, ..self.data() };
        evaluate(&data, &self.history.offset.to_absolute(state))
    }

    /// Returns the time-step error of the increments so far.
    pub(super) fn increment_error(&mut self) -> Option<IncrementError> {
        self.stage.method.increment_errors().map(|errors| errors.found())
    }

    /// Returns the data to which the next substep returns if it fails.
    fn rollback(&mut self) -> Rollback {
        let errors = self.stage.method.increment_errors().cloned();
        let (state, unknowns) = (self.stage.method.state(), self.stage.method.unknowns().clone());
        Rollback { unknowns, state, offset: self.history.offset.clone(), errors }
    }

    /// Rolls back to the start of a substep.
    fn go_back(&mut self, start: Rollback) {
        self.stage.method.unknowns().copy_from_slice(&start.unknowns);
        self.history.offset = start.offset;
        if let (Some(errors), Some(before)) = (self.stage.method.increment_errors(), start.errors) {
            *errors = before;
        }
    }

    /// Advances to `time`, in substeps if needed.
    pub(super) fn increment(
        &mut self,
        time: f64,
        linear: &mut RefinedSolver,
        progress: &mut IncrementObserver<'_>,
    ) -> Computed<IncrementEnd> {
        let so_far = self.history.in_progress.take();
        let mut so_far = so_far.unwrap_or_else(|| IncrementInProgress::new(self.history.reached.unwrap_or(0.0), time));
        let length = time - so_far.start;
        let smallest = length * 0.5_f64.powi(self.settings.halvings as i32);
        let margin = smallest.max(NEAR_SLIP * length);
        let mut touches_left = if self.settings.halvings > 0 { TOUCHES } else { 0 };
        let mut divided = false;
        loop {
            let end = so_far.pending.last().copied().unwrap_or(time);
            let from = self.history.reached.unwrap_or(0.0);
            let rollback = self.rollback();
            let (mut substep, input) = self.substep(end, linear, &mut |iteration| progress.iteration(iteration))?;
            let mut is_solved = substep.status == Status::Converged;
            let mut touch = None;
            if is_solved {
                self.history.friction = self.friction_with(&substep);
            }
            // A substep that ends at a touch has no touch before.
            if touches_left > 0 && !divided && is_solved && !progress.has_stopped {
                let observe: Observe<'_> = &mut |iteration| progress.iteration(iteration);
                if let Some((share, found)) =
                    self.first_touch([from, end], &substep, (&input, &rollback), linear, observe)?
                {
                    substep.solved = found.then(substep.solved);
                    touch = share.map(|share| from + share * (end - from));
                    touch = touch.filter(|touch| touch - from > NEAREST * length && *touch < end);
                }
            }
            // Nothing more is solved: there may be a touch, or another substep.
            if is_solved && progress.has_stopped {
                (substep.status, is_solved, touch) = (Status::Interrupted, false, None);
            }
            so_far.sum.solved = so_far.sum.solved.then(substep.solved.clone());
            if let Some(touch) = touch {
                self.go_back(rollback);
                so_far.pending.push(touch);
                (touches_left, divided) = (touches_left - 1, true);
            } else if is_solved {
                divided = false;
                so_far.sum.friction_work += self.body.problem.friction_work(&self.data(), &substep.state);
                self.accept(end, &substep);
                so_far.sum.kkt = so_far.sum.kkt.max(&substep.kkt);
                so_far.sum.ends.push(end);
                so_far.pending.pop();
                let result = so_far.up_to(substep);
                if so_far.pending.is_empty() {
                    return Ok(IncrementEnd::Ended(Box::new(result)));
                }
                self.show(&result.state, |increment, state| {
                    progress.report_substep(end, &self.data(), &result, increment, state);
                });
            } else if let Some(MissingNodes { nodes, solved }) = self.missing_nodes(&substep)? {
                self.history.estimate = solved.then_some(substep.state);
                self.history.errors = rollback.errors.zip(self.body.nodes().map(<[usize]>::to_vec));
                self.history.in_progress = Some(so_far);
                return Ok(IncrementEnd::NeedsNodes(nodes));
            } else if divided && substep.status != Status::Interrupted {
                // The whole substep has a solution, but a part of it has none.
                self.go_back(rollback);
                so_far.pending = vec![time];
                (touches_left, divided) = (0, false);
            } else {
                let advance = match &substep.solved.stop {
                    Termination::Slips(motion) => {
                        let share = self.share_without_slip(from, motion, [&rollback.state.p_n, &substep.state.p_n]);
                        towards_slip(share * (end - from), end - from, margin)
                    }
                    _ => 0.5 * (end - from),
                };
                // There is no time between neighbouring numbers.
                let no_time = from + advance <= from || from + advance >= end;
                if advance < smallest || no_time || !self.smaller_may_do(&substep)? {
                    let slips = substep.status == Status::Slips;
                    let slip = slips.then_some(Slip { by: end, p_n: rollback.state.p_n });
                    let result = Step { slip, ..so_far.up_to(substep) };
                    return Ok(IncrementEnd::Ended(Box::new(result)));
                }
                self.go_back(rollback);
                so_far.pending.push(from + advance);
            }
        }
    }

    /// Solves and judges the substep that ends at `time`, and returns its input.
    fn substep(
        &mut self,
        time: f64,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Computed<(Step, SubstepInput)> {
        let input = self.pose(time);
        let outcome = self.solve(time, &input, linear, observe)?;
        Ok((self.conclude(time, &input.scales, outcome, linear)?, input))
    }

    /// Sets the data of the substep that ends at `time`.
    fn pose(&mut self, time: f64) -> SubstepInput {
        let Body { problem, loading, .. } = self.body;
        loading.force(time, &mut self.stage.force);
        loading.gap_at(time, &mut self.stage.gap);
        match loading.friction() {
            Some(friction) => self.stage.mu = friction.at(time),
            // The last increment of a stepper may have had another friction, before it failed or was taken back.
            None => self.stage.mu.copy_from_slice(problem.mu()),
        }
        let from = self.history.reached.unwrap_or(0.0);
        let begins = self.take_estimate(time).or(self.history.reached);
        let before = self.history.offset.clone();
        let sizes = loading.force_sizes(time, problem.displacements());
        let landed = self.find_rest_position(time, &sizes);
        self.stage.gap.iter_mut().zip(&self.history.offset.w_n).for_each(|(gap, w)| *gap -= w);
        let tangential = [(&mut self.stage.w_t_last, &self.history.w_t), (&mut self.stage.w_o_last, &self.history.w_o)];
        for (k, (last, w)) in tangential.into_iter().enumerate() {
            // Slip is motion relative to the obstacle, and excludes the motion of the rigid offset.
            let (drift, drift_now) = (loading.drift_at(from, k), loading.drift_at(time, k));
            let (offset, carried_now) = (&before.w_t[k], &self.history.offset.w_t[k]);
            for (i, last) in last.iter_mut().enumerate() {
                *last = w[i] + (drift_now[i] - drift[i]) - (carried_now[i] - offset[i]);
            }
        }
        let mut scales = self.history.scales.with_terms(problem, &sizes);
        if self.history.offset.is_nonzero() {
            // Gaps are differences from those that the rigid offset closes.
            scales = scales.with_gaps(problem, &self.data(), &self.history.offset.u);
        }
        SubstepInput { begins, sizes, landed, scales }
    }

    /// Solves the substep that ends at `time` with the method.
    pub(super) fn solve(
        &mut self,
        time: f64,
        input: &SubstepInput,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Computed<MethodResult> {
        let IncrementDriver { body, settings, .. } = *self;
        let problem = body.problem;
        let load = Load { force: &self.stage.force, sizes: &input.sizes };
        if let Some(motion) = driven_motion(problem, &self.stage.mu, &load) {
            let stop = if is_held_by_friction(problem, &self.stage.mu, &load) {
                Termination::Slips(motion)
            } else {
                Termination::NoEquilibrium(motion)
            };
            return Ok(MethodResult { stop, ..MethodResult::nothing() });
        }
        let Some(response) = self.stage.response(body, settings, (input.begins, time), linear)? else {
            return Ok(MethodResult {
                stop: Termination::Singular(LinearError::NotFinite),
                ..MethodResult::new(f64::NAN)
            });
        };
        let (problem, loading) = body.solved();
        loading.force(time, &mut self.stage.solved_force);
        let [gap, mu, w_t_last, w_o_last] =
            [&self.stage.gap, &self.stage.mu, &self.stage.w_t_last, &self.stage.w_o_last]
                .map(|values| body.on_nodes(values));
        let task = Task {
            problem,
            first: input.begins.is_none(),
            increment: &Increment {
                force: &self.stage.solved_force,
                gap: &gap,
                mu: &mu,
                w_t_last: &w_t_last,
                w_o_last: &w_o_last,
            },
            response: &response,
            landed: input.landed.as_deref(),
            scales: &input.scales,
            tolerance: settings.tolerance,
        };
        self.stage.method.solve(&task, linear, observe)
    }

    /// Judges the state that the method has reached at `time`, after refining it if needed. `scales` are those of the
    /// earlier increments and of the load of the substep.
    fn conclude(
        &mut self,
        time: f64,
        scales: &KktScales,
        outcome: MethodResult,
        linear: &mut RefinedSolver,
    ) -> Computed<Step> {
        let Stage { force, gap, mu, w_t_last, w_o_last, method, .. } = &mut *self.stage;
        let recovered = self.body.recovered(time, method.state(), force)?;
        let (method, problem, scaling) = (method.as_mut(), self.body.solved().0, self.settings.scaling);
        let mut contact = Linearized { method, linear, problem, scaling, change: Vec::new() };
        let (data, tolerance) = (Increment { force, gap, mu, w_t_last, w_o_last }, self.settings.tolerance);
        let recovered = match outcome.stop {
            Termination::Interrupted => recovered,
            _ => self.body.refined(recovered, (&data, scales, tolerance), &mut contact)?,
        };
        let RecoveredState { mut state, backward_error, .. } = recovered;
        release_open(self.body.problem, &data, &mut state);
        let solved = MethodResult { backward_error: outcome.backward_error.max(backward_error), ..outcome };
        self.history.worst_backward_error = self.history.worst_backward_error.max(backward_error);
        let judgement = Judgement::near(self.body.problem, &data, &state, scales, tolerance)?;
        let (kkt, scales) = (judgement.errors(), judgement.scales());
        let status = record::verdict(&solved, &kkt, tolerance);
        Ok(Step { solved, state, scales, kkt, status, ..Step::default() })
    }

    /// Returns the larger working set needed after a `substep`, or `None` if the present one suffices.
    ///
    /// The set at least doubles each time, which bounds the number of restarts. A failure not caused by missing nodes is
    /// reported only after all nodes have been included.
    fn missing_nodes(&self, substep: &Step) -> Computed<Option<MissingNodes>> {
        let (problem, data, tolerance) = (self.body.problem, self.data(), self.settings.tolerance);
        let Some(nodes) = self.body.nodes() else { return Ok(None) };
        if is_solution(&substep.kkt, tolerance) || substep.solved.stop == Termination::Interrupted {
            return Ok(None);
        }
        let all = problem.contacts();
        let mut in_set = vec![false; all];
        for &i in nodes {
            in_set[i] = true;
        }
        let distance = |i: usize| data.gap[i] - problem.c_n().dot(i, &substep.state.u);
        let mut others: Vec<(usize, f64)> = (0..all).filter(|&i| !in_set[i]).map(|i| (i, distance(i))).collect();
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        let judgement = Judgement::near(problem, &data, &substep.state, &substep.scales, tolerance)?;
        let penetrating = others.iter().filter(|(i, _)| judgement.penetration(*i) > tolerance).count();
        let solved = substep.solved.stop == Termination::Converged && penetrating > 0;
        let joining = if solved { nodes.len().max(2 * penetrating) } else { all };
        // Leaving out less than a quarter of the nodes saves little.
        let joining = if 4 * (nodes.len() + joining) >= 3 * all { all } else { joining };
        others.iter().take(joining).for_each(|(i, _)| in_set[*i] = true);
        Ok(Some(MissingNodes { nodes: (0..all).filter(|&i| in_set[i]).collect(), solved }))
    }

    /// Makes the method start from the estimate of the state at `time`, if there is one.
    fn take_estimate(&mut self, time: f64) -> Option<f64> {
        let estimate = self.history.estimate.take()?;
        self.stage.method.set_state(&self.body.restricted(&estimate));
        Some(time)
    }

    /// Advances to the end of a converged `substep` at `time`.
    fn accept(&mut self, time: f64, substep: &Step) {
        if self.body.nodes().is_some() {
            self.history.state = Some(substep.state.clone());
        }
        let [w_n, w_t, w_o] = self.body.problem.contact_motion(&substep.state.u);
        let (history, stage) = (&mut *self.history, &*self.stage);
        let slip = |w: &[f64], last: &[f64]| w.iter().zip(last).map(|(w, last)| w - last).collect();
        history.slip = [slip(&w_t, &stage.w_t_last), slip(&w_o, &stage.w_o_last)];
        (history.reached, history.scales) = (Some(time), substep.scales.clone());
        (history.w_n, history.w_t, history.w_o) = (w_n, w_t, w_o);
    }

    /// Returns the share of the substep tried last, from the time `from`, after which the loads overcome friction on
    /// the `motion`: by linear interpolation of the excess of their work. `p_n` are the normal forces at both ends.
    fn share_without_slip(&self, from: f64, motion: &[f64], p_n: [&[f64]; 2]) -> f64 {
        let Body { problem, loading, .. } = self.body;
        let mut force = vec![0.0; problem.displacements()];
        loading.force(from, &mut force);
        let mu = self.friction_at(from);
        let reserve = -excess(problem, &mu, &force, p_n[0], motion);
        let excess = excess(problem, &self.stage.mu, &self.stage.force, p_n[1], motion);
        if reserve > 0.0 && excess > 0.0 { reserve / (reserve + excess) } else { 0.5 }
    }

    /// Returns the coefficients of friction at a time.
    pub(super) fn friction_at(&self, time: f64) -> Vec<f64> {
        self.body.loading.friction().map_or(self.body.problem.mu().to_vec(), |friction| friction.at(time))
    }

    /// Returns `true` if a smaller substep could converge.
    fn smaller_may_do(&self, substep: &Step) -> Computed<bool> {
        match substep.status {
            Status::Converged
            | Status::Interrupted
            | Status::NoContinuation
            | Status::OutOfMemory
            | Status::Unsupported => Ok(false),
            // A body that tips at the end may slip before.
            Status::Slips | Status::NoEquilibrium => Ok(true),
            // If rounding sets the limit, it does so at any load.
            _ => {
                let Step { state, scales, kkt, .. } = substep;
                let data = self.data();
                let rounding =
                    Judgement::near(self.body.problem, &data, state, scales, self.settings.tolerance)?.rounding();
                Ok(kkt.worst().1 > 10.0 * rounding || kkt.worst().1.is_nan())
            }
        }
    }

    /// Moves a body that only contact holds to its rest position under the load of the substep that ends at `time`.
    /// Returns the nodes that touch there if the position is new, and `None` if supports hold the body or no rest
    /// position is found.
    fn find_rest_position(&mut self, time: f64, sizes: &[f64]) -> Option<Vec<usize>> {
        if !self.stage.may_move_rigidly {
            return None;
        }
        // Within the deformation due to the load, Newton's method finds the closing nodes better than a rigid body
        // does.
        let clamped = self.stage.clamped.as_ref()?;
        let force = clamped.response(self.body.loading, None, time).contact_force * self.settings.scaling.force;
        let near = |(gap, k): (&f64, &f64)| (force / k).max(NEARBY * gap.abs());
        let tolerance: Vec<f64> = self.stage.gap.iter().zip(&self.settings.contact_stiffness).map(near).collect();
        let moved = self.history.offset.w_n.iter().zip(&self.history.w_n).map(|(offset, w)| offset + w);
        let distance: Vec<f64> = self.stage.gap.iter().zip(moved).map(|(gap, w)| gap - w).collect();
        let load = Load { force: &self.stage.force, sizes };
        let Landing { weights, nodes } = landing(self.body.problem, &self.stage.mu, &load, &distance, &tolerance)?;
        self.history.offset = self.history.offset.by(self.body.problem, &weights);
        let stays = weights.iter().all(|weight| *weight == 0.0);
        (self.history.reached.is_none() || !stays).then_some(nodes)
    }
}

/// Returns the next substep towards the time `slips` after the present one at which a joint slips, if it is known to
/// slip after the longer time `by`: first a little beyond it, then a little before it, and 0 if both are known.
fn towards_slip(slips: f64, by: f64, margin: f64) -> f64 {
    if by - slips > 1.5 * margin {
        slips + margin
    } else if slips > 1.5 * margin {
        slips - margin
    } else {
        0.0
    }
}
