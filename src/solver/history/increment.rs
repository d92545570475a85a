//! One increment, halved if it fails, and divided where nodes first touch (`first_touch.rs`).
//!
//! A substep is an increment of its own; friction depends on the slip in each. A substep that is divided leaves only its
//! counts and its largest backward error. After a substep converges, the next one ends where the halved interval ended:
//! T/4, T/4, T/2.
//!
//! A joint that slips as a whole at the end of a substep (`slip.rs`) gives way where the work of the loads reaches that of
//! friction, by linear interpolation. One substep ends a little after that time and one a little before it.

use super::increment_error::{IncrementError, IncrementErrors};
use super::interior::{InteriorRecovery, Linearized, RecoveredState};
use super::observer::IncrementObserver;
use super::rigid_offset::RigidOffset;
use super::settings::HistorySettings;
use super::stage::Stage;
use super::state::{HistoryState, IncrementInProgress, IncrementResult, SubstepResult};
use super::task::{Observe, Task};
use super::working_set::{self, MissingNodes};
use super::{Slip, Status, record};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::condensation::Condensed;
use crate::solver::laws::{Judgement, KktScales};
use crate::solver::loading::Loading;
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::{ContactProblem, Increment, State};
use crate::solver::solvability::{Landing, Load, NEARBY, driven_motion, excess, is_held_by_friction, landing};
use std::borrow::Cow;

/// The margin on either side of the time at which a joint slips, relative to the increment. Nearer to it the nodes of a
/// body that slides in a plane move far, until friction has turned.
const NEAR_SLIP: f64 = 1.0 / 16.0;

/// The largest number of touches at which an increment is divided. One leaves two nodes that touch one after the other; six halve
/// no error further, and take five times as many iterations where a slender body lands on many nodes.
const TOUCHES: usize = 2;

/// The shortest substep that ends at a touch, relative to its increment.
const NEAREST: f64 = 1e-6;

/// The increments of a stage, from the state that the history has reached.
pub(super) struct IncrementDriver<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub settings: &'a HistorySettings,
    /// The condensed body, if the method solves for the contact displacements alone.
    pub condensed: Option<&'a Condensed>,
    pub stage: &'a mut Stage,
    /// The state that the history has reached.
    pub at: &'a mut HistoryState,
}

/// The progress of an increment.
pub(super) enum IncrementEnd {
    /// The increment reached its end, or the place where it failed.
    Ended(Box<IncrementResult>),
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

impl<'a> IncrementDriver<'a> {
    /// Returns the data of the substep tried last, relative to the rigid offset, as is the state of a
    /// [`SubstepResult`].
    pub(super) fn data(&self) -> Increment<'_> {
        let Stage { force, gap, mu, w_t_last, w_o_last, .. } = &*self.stage;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }

    /// Calls `see` with the last substep's data and state, both relative to the initial configuration.
    pub(super) fn show<T>(&self, state: &State, see: impl FnOnce(&Increment<'_>, &State) -> T) -> T {
        let RigidOffset { w_n, w_t: [w_t, w_o], .. } = &self.at.offset;
        if !self.at.offset.is_nonzero() {
            return see(&self.data(), state);
        }
        let moved = |x: &[f64], by: &[f64]| x.iter().zip(by).map(|(x, by)| x + by).collect::<Vec<f64>>();
        let gap = moved(&self.stage.gap, w_n);
        let (w_t_last, w_o_last) = (moved(&self.stage.w_t_last, w_t), moved(&self.stage.w_o_last, w_o));
        let data = Increment { gap: &gap, w_t_last: &w_t_last, w_o_last: &w_o_last, ..self.data() };
        see(&data, &self.at.offset.whole(state))
    }

    /// Returns the time-step error of the increments so far.
    pub(super) fn increment_error(&mut self) -> Option<IncrementError> {
        self.stage.method.increment_errors().map(|errors| errors.found())
    }

    /// Returns the data to which the next substep returns if it fails.
    fn rollback(&mut self) -> Rollback {
        let errors = self.stage.method.increment_errors().cloned();
        let (state, unknowns) = (self.stage.method.state(), self.stage.method.unknowns().clone());
        Rollback { unknowns, state, offset: self.at.offset.clone(), errors }
    }

    /// Rolls back to the start of a substep.
    fn go_back(&mut self, start: Rollback) {
        self.stage.method.unknowns().copy_from_slice(&start.unknowns);
        self.at.offset = start.offset;
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
    ) -> Result<IncrementEnd, LinearError> {
        let in_progress = self.at.in_progress.take();
        let in_progress = in_progress.unwrap_or_else(|| IncrementInProgress::new(self.at.reached.unwrap_or(0.0), time));
        let IncrementInProgress { start, mut pending, mut solved, mut kkt, mut ends, mut friction_work } = in_progress;
        let smallest = (time - start) * 0.5_f64.powi(self.settings.halvings as i32);
        let margin = smallest.max(NEAR_SLIP * (time - start));
        let mut touches_left = if self.settings.halvings > 0 { TOUCHES } else { 0 };
        let mut divided = false;
        loop {
            let end = pending.last().copied().unwrap_or(time);
            let from = self.at.reached.unwrap_or(0.0);
            let rollback = self.rollback();
            let (substep, input) = self.substep(end, linear, &mut |iteration| progress.iteration(iteration))?;
            let mut outcome = substep.outcome.clone();
            let mut touch = None;
            if substep.status == Status::Converged {
                self.at.friction = self.friction_with(&substep);
            }
            // An increment that ends at its first touch has none before.
            if touches_left > 0 && !divided && substep.status == Status::Converged {
                let observe: Observe<'_> = &mut |iteration| progress.iteration(iteration);
                if let Some((share, found)) =
                    self.first_touch([from, end], &substep, (&input, &rollback), linear, observe)?
                {
                    outcome = found.then(outcome);
                    touch = share.map(|share| from + share * (end - from));
                    touch = touch.filter(|touch| touch - from > NEAREST * (time - start) && *touch < end);
                }
            }
            let so_far = solved.map_or(outcome.clone(), |solved| solved.then(outcome));
            if let Some(touch) = touch {
                self.go_back(rollback);
                pending.push(touch);
                (solved, touches_left, divided) = (Some(so_far), touches_left - 1, true);
            } else if substep.status == Status::Converged {
                divided = false;
                friction_work += self.problem.friction_work(&self.data(), &substep.state);
                self.accept(end, &substep);
                kkt = kkt.max(&substep.kkt);
                ends.push(end);
                pending.pop();
                let status = Status::Converged;
                let SubstepResult { state, scales, .. } = substep;
                let slip = None;
                let walked = IncrementResult { solved: so_far, state, scales, kkt, status, slip, ends, friction_work };
                if pending.is_empty() {
                    return Ok(IncrementEnd::Ended(Box::new(walked)));
                }
                self.show(&walked.state, |increment, state| {
                    progress.part(end, &self.data(), &walked, increment, state);
                });
                (solved, ends) = (Some(walked.solved), walked.ends);
            } else if let Some(MissingNodes { nodes, solved }) = self.lack(&substep)? {
                self.at.estimate = solved.then_some(substep.state);
                self.at.errors = rollback.errors.zip(self.condensed.and_then(Condensed::nodes).map(<[usize]>::to_vec));
                let solved = Some(so_far);
                self.at.in_progress = Some(IncrementInProgress { start, pending, solved, kkt, ends, friction_work });
                return Ok(IncrementEnd::NeedsNodes(nodes));
            } else if divided {
                // The whole substep has a solution, but a part of it has none.
                self.go_back(rollback);
                (pending, solved, touches_left, divided) = (vec![time], Some(so_far), 0, false);
            } else {
                let part = match &substep.outcome.stop {
                    Termination::Slips(motion) => {
                        let share = self.share_without_slip(from, motion, [&rollback.state.p_n, &substep.state.p_n]);
                        towards_slip(share * (end - from), end - from, margin)
                    }
                    _ => 0.5 * (end - from),
                };
                // There is no time between neighbouring numbers.
                let no_time = from + part <= from || from + part >= end;
                if part < smallest || no_time || !self.smaller_may_do(&substep)? {
                    let (kkt, status) = (substep.kkt, substep.status);
                    let SubstepResult { state, scales, .. } = substep;
                    let slip = (status == Status::Slips).then_some(Slip { by: end, p_n: rollback.state.p_n });
                    let walked =
                        IncrementResult { solved: so_far, state, scales, kkt, status, slip, ends, friction_work };
                    return Ok(IncrementEnd::Ended(Box::new(walked)));
                }
                self.go_back(rollback);
                pending.push(from + part);
                solved = Some(so_far);
            }
        }
    }

    /// Solves and judges the substep that ends at `time`, and returns its input.
    fn substep(
        &mut self,
        time: f64,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<(SubstepResult, SubstepInput), LinearError> {
        let input = self.pose(time);
        let outcome = self.solve(time, &input, linear, observe)?;
        let balanced = match self.whole() {
            None => self.balanced(self.stage.method.state())?,
            Some(whole) => whole.state(time, &self.stage.method.state(), &self.stage.force)?,
        };
        Ok((self.conclude(&input.scales, outcome, balanced, linear)?, input))
    }

    /// Sets the data of the substep that ends at `time`.
    fn pose(&mut self, time: f64) -> SubstepInput {
        let IncrementDriver { problem, loading, .. } = *self;
        loading.force(time, &mut self.stage.force);
        loading.gap_at(time, &mut self.stage.gap);
        match loading.friction() {
            Some(friction) => self.stage.mu = friction.at(time),
            // The last increment of a stepper may have had another friction, before it failed or was taken back.
            None => self.stage.mu.copy_from_slice(problem.mu()),
        }
        let from = self.at.reached.unwrap_or(0.0);
        let begins = self.take_estimate(time).or(self.at.reached);
        let before = self.at.offset.clone();
        let sizes = loading.force_sizes(time, problem.displacements());
        let landed = self.find_rest_position(time, &sizes);
        self.stage.gap.iter_mut().zip(&self.at.offset.w_n).for_each(|(gap, w)| *gap -= w);
        let tangential = [(&mut self.stage.w_t_last, &self.at.w_t), (&mut self.stage.w_o_last, &self.at.w_o)];
        for (k, (last, w)) in tangential.into_iter().enumerate() {
            // Slip is motion relative to the obstacle, and excludes the motion of the rigid offset.
            let (drift, drift_now) = (loading.drift_at(from, k), loading.drift_at(time, k));
            let (offset, carried_now) = (&before.w_t[k], &self.at.offset.w_t[k]);
            for (i, last) in last.iter_mut().enumerate() {
                *last = w[i] + (drift_now[i] - drift[i]) - (carried_now[i] - offset[i]);
            }
        }
        let mut scales = self.at.scales.with_terms(problem, &sizes);
        if self.at.offset.is_nonzero() {
            // Gaps are differences from those that the rigid offset closes.
            scales = scales.with_gaps(problem, &self.data(), &self.at.offset.u);
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
    ) -> Result<MethodResult, LinearError> {
        let IncrementDriver { problem, loading, condensed, settings, .. } = *self;
        let load = Load { force: &self.stage.force, sizes: &input.sizes };
        if let Some(motion) = driven_motion(problem, &self.stage.mu, &load) {
            let stop = if is_held_by_friction(problem, &self.stage.mu, &load) {
                Termination::Slips(motion)
            } else {
                Termination::NoEquilibrium(motion)
            };
            return Ok(MethodResult { stop, attempts: 0, ..MethodResult::new(f64::NAN) });
        }
        let Some(response) =
            self.stage.response((problem, loading), condensed, settings, (input.begins, time), linear)?
        else {
            return Ok(MethodResult {
                stop: Termination::Singular(LinearError::NotFinite),
                ..MethodResult::new(f64::NAN)
            });
        };
        let mut force = &self.stage.force;
        if let Some(condensed) = condensed {
            condensed.loading.force(time, &mut self.stage.condensed_force);
            force = &self.stage.condensed_force;
        }
        let [gap, mu, w_t_last, w_o_last] =
            [&self.stage.gap, &self.stage.mu, &self.stage.w_t_last, &self.stage.w_o_last]
                .map(|values| on_nodes(condensed, values));
        let task = Task {
            problem: condensed.map_or(problem, |condensed| &condensed.problem),
            first: input.begins.is_none(),
            increment: &Increment { force, gap: &gap, mu: &mu, w_t_last: &w_t_last, w_o_last: &w_o_last },
            response: &response,
            landed: input.landed.as_deref(),
            scales: &input.scales,
            tolerance: settings.tolerance,
        };
        self.stage.method.solve(&task, linear, observe)
    }

    /// Returns the recovery of the whole body, if the method has a condensed one.
    fn whole(&self) -> Option<InteriorRecovery<'a>> {
        let IncrementDriver { problem, settings, .. } = *self;
        self.condensed.map(|condensed| InteriorRecovery { problem, condensed, settings })
    }

    /// Adds imbalance and backward error to a state of the whole body under the data of the substep tried last.
    fn balanced(&self, state: State) -> Result<RecoveredState, LinearError> {
        let imbalance = self.problem.imbalance(&self.stage.force, &state)?;
        Ok(RecoveredState { imbalance, backward_error: 0.0, state })
    }

    /// Judges the state that the method has reached, after refining it if needed. `scales` are those before the
    /// substep.
    fn conclude(
        &mut self,
        scales: &KktScales,
        outcome: MethodResult,
        balanced: RecoveredState,
        linear: &mut RefinedSolver,
    ) -> Result<SubstepResult, LinearError> {
        let balanced = match self.whole() {
            None => balanced,
            Some(whole) => {
                let (problem, scaling) = (&whole.condensed.problem, self.settings.scaling);
                let Stage { force, gap, mu, w_t_last, w_o_last, method, .. } = &mut *self.stage;
                let mut contact = Linearized::new(method.as_mut(), linear, problem, scaling);
                whole.refined(balanced, &Increment { force, gap, mu, w_t_last, w_o_last }, scales, &mut contact)?
            }
        };
        self.judged(scales, outcome, balanced)
    }

    /// Judges a state under the data of the substep tried last.
    fn judged(
        &mut self,
        scales: &KktScales,
        outcome: MethodResult,
        balanced: RecoveredState,
    ) -> Result<SubstepResult, LinearError> {
        let RecoveredState { state, backward_error, .. } = balanced;
        let outcome = MethodResult { backward_error: outcome.backward_error.max(backward_error), ..outcome };
        self.at.worst_backward_error = self.at.worst_backward_error.max(backward_error);
        let tolerance = self.settings.tolerance;
        let data = self.data();
        let judgement = Judgement::near(self.problem, &data, &state, scales, tolerance)?;
        let (kkt, scales) = (judgement.errors(), judgement.scales());
        let status = record::verdict(&outcome, &kkt, tolerance);
        Ok(SubstepResult { state, scales, outcome, kkt, status })
    }

    /// Returns the contact nodes that the equations lack after a `substep`.
    fn lack(&self, substep: &SubstepResult) -> Result<Option<MissingNodes>, LinearError> {
        let held = self.condensed.and_then(Condensed::nodes);
        let lack = |held| working_set::lack(self.problem, &self.data(), substep, held, self.settings.tolerance);
        held.map_or(Ok(None), lack)
    }

    /// Makes the method start from the estimate of the state at `time`, if there is one.
    fn take_estimate(&mut self, time: f64) -> Option<f64> {
        let (condensed, estimate) = (self.condensed?, self.at.estimate.take()?);
        self.stage.method.set_state(&condensed.condensed_state(&estimate));
        Some(time)
    }

    fn accept(&mut self, time: f64, substep: &SubstepResult) {
        if self.condensed.is_some_and(|condensed| condensed.nodes().is_some()) {
            self.at.state = Some(substep.state.clone());
        }
        let w = self.problem.contact_motion(&substep.state.u);
        self.move_on(time, w, substep.scales.clone());
    }

    /// Advances to `time`, with the contact displacements `w_n`, `w_t` and `w_o`.
    fn move_on(&mut self, time: f64, [w_n, w_t, w_o]: [Vec<f64>; 3], scales: KktScales) {
        let (at, stage) = (&mut *self.at, &*self.stage);
        let slip = |w: &[f64], last: &[f64]| w.iter().zip(last).map(|(w, last)| w - last).collect();
        at.slip = [slip(&w_t, &stage.w_t_last), slip(&w_o, &stage.w_o_last)];
        (at.reached, at.scales) = (Some(time), scales);
        (at.w_n, at.w_t, at.w_o) = (w_n, w_t, w_o);
    }

    /// Returns the share of the substep tried last, from the time `from`, after which the loads overcome friction on
    /// the `motion`: by linear interpolation of the excess of their work. `p_n` are the normal forces at both ends.
    fn share_without_slip(&self, from: f64, motion: &[f64], p_n: [&[f64]; 2]) -> f64 {
        let (problem, loading) = (self.problem, self.loading);
        let mut force = vec![0.0; problem.displacements()];
        loading.force(from, &mut force);
        let mu = self.friction_at(from);
        let left = -excess(problem, &mu, &force, p_n[0], motion);
        let beyond = excess(problem, &self.stage.mu, &self.stage.force, p_n[1], motion);
        if left > 0.0 && beyond > 0.0 { left / (left + beyond) } else { 0.5 }
    }

    /// Returns the coefficients of friction at a time.
    pub(super) fn friction_at(&self, time: f64) -> Vec<f64> {
        self.loading.friction().map_or(self.problem.mu().to_vec(), |friction| friction.at(time))
    }

    /// Returns `true` if a smaller substep could converge.
    fn smaller_may_do(&self, substep: &SubstepResult) -> Result<bool, LinearError> {
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
                let SubstepResult { state, scales, kkt, .. } = substep;
                let data = self.data();
                let rounding = Judgement::near(self.problem, &data, state, scales, self.settings.tolerance)?.rounding();
                Ok(kkt.worst().1 > 10.0 * rounding || kkt.worst().1.is_nan())
            }
        }
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

/// Restricts per-contact-node values to the working set.
fn on_nodes<'v>(condensed: Option<&Condensed>, values: &'v [f64]) -> Cow<'v, [f64]> {
    condensed.map_or(Cow::Borrowed(values), |condensed| condensed.on_nodes(values))
}

impl IncrementDriver<'_> {
    /// Moves a body that only contact holds to its rest position under the load of the substep that ends at `time`.
    /// Returns the nodes that touch there if the position is new, and `None` if supports hold the body or no rest
    /// position is found.
    pub(super) fn find_rest_position(&mut self, time: f64, sizes: &[f64]) -> Option<Vec<usize>> {
        if !self.stage.may_move_rigidly {
            return None;
        }
        // Within the deformation due to the load, Newton's method finds the closing nodes better than a rigid body
        // does.
        let clamped = self.stage.clamped.as_ref()?;
        let force = clamped.response(self.loading, None, time).contact_force * self.settings.scaling.force;
        let reach = |(gap, k): (&f64, &f64)| (force / k).max(NEARBY * gap.abs());
        let reach: Vec<f64> = self.stage.gap.iter().zip(&self.settings.contact_stiffness).map(reach).collect();
        let moved = self.at.offset.w_n.iter().zip(&self.at.w_n).map(|(offset, w)| offset + w);
        let distance: Vec<f64> = self.stage.gap.iter().zip(moved).map(|(gap, w)| gap - w).collect();
        let load = Load { force: &self.stage.force, sizes };
        let Landing { weights, nodes } = landing(self.problem, &self.stage.mu, &load, &distance, &reach)?;
        self.at.offset = self.at.offset.by(self.problem, &weights);
        let stays = weights.iter().all(|weight| *weight == 0.0);
        (self.at.reached.is_none() || !stays).then_some(nodes)
    }
}
