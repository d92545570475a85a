//! From one time to the next: an increment, halved where it fails.
//!
//! A part is an increment of its own: friction sees the slip of each. Nothing of a part that fails
//! stays, and after a part that converges the rest of the increment is tried whole, so that the size
//! grows back. On the contact displacements alone several increments are solved before they are judged, see `batch`.

mod batch;
mod rest_position;

use std::borrow::Cow;

pub(super) use batch::JudgedIncrement;

use super::clamped::ClampedBody;
use super::increment_error::{IncrementError, IncrementErrors};
use super::increment_result::{IncrementResult, SubstepResult};
use super::progress::Progress;
use super::recovery::{InteriorRecovery, Linearized, RecoveredState};
use super::rigid_offset::RigidOffset;
use super::settings::HistorySettings;
use super::snapshot::Snapshot;
use super::state::{HistoryState, IncrementInProgress};
use super::task::{IncrementSolver, Observe, Task};
use super::working_set::{self, MissingNodes};
use super::{Status, record};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::condensation::Condensed;
use crate::solver::laws::{KktScales, judge, rounding_level};
use crate::solver::loading::Loading;
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::{ContactProblem, Increment, State};
use crate::solver::solvability::{Load, driven_motion, is_carried_without_strain, motion_driven_in_the_equations};

/// The way through a history as far as it has converged, and the data of the part tried last.
pub(super) struct IncrementDriver<'a> {
    problem: &'a ContactProblem,
    loading: &'a Loading,
    settings: &'a HistorySettings,
    /// If the method solves for the contact displacements alone.
    condensed: Option<&'a Condensed>,
    method: Box<dyn IncrementSolver + 'a>,
    held: ClampedBody,
    /// How far the history has come.
    pub at: &'a mut HistoryState,
    /// Whether the body may be carried without strain.
    may_move_rigidly: bool,
    force: Vec<f64>,
    condensed_force: Vec<f64>,
    gap: Vec<f64>,
    mu: Vec<f64>,
    w_t_last: Vec<f64>,
    w_o_last: Vec<f64>,
}

/// How far an increment came.
pub(super) enum IncrementProgress {
    /// To its end, or to where it failed.
    Ended(Box<IncrementResult>),
    /// To where the equations lack contact nodes: all that they must hold to go on.
    NeedsNodes(Vec<usize>),
}

/// From where a part starts.
struct Start {
    unknowns: Vec<f64>,
    offset: RigidOffset,
    errors: Option<IncrementErrors>,
}

/// What is known of a part before it is solved, beside its data.
struct SubstepInput {
    /// The time of the state from which the method begins, s.
    begins: Option<f64>,
    /// The sizes of the loads that `force` is the sum of, N.
    sizes: Vec<f64>,
    /// The nodes on which the body comes to rest.
    landed: Option<Vec<usize>>,
    /// The scales of the increments before and of the load.
    scales: KktScales,
}

impl<'a> IncrementDriver<'a> {
    pub(super) fn new(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        settings: &'a HistorySettings,
        condensed: Option<&'a Condensed>,
        mut method: Box<dyn IncrementSolver + 'a>,
        held: ClampedBody,
        at: &'a mut HistoryState,
    ) -> Self {
        if let (Some(state), None) = (&at.state, condensed) {
            method.go_on_from(state);
        }
        if let (Some(state), Some(condensed)) = (&at.state, condensed) {
            method.go_on_from(&condensed.condensed_state(state));
            let begun = (method.increment_errors(), at.errors.take(), at.reached);
            if let (Some(errors), Some((before, nodes)), Some(time)) = begun {
                errors.go_on_from(&before, &nodes, condensed, loading, time, [&at.w_n, &at.w_t, &at.w_o]);
            }
        }
        let n_c = problem.contacts();
        IncrementDriver {
            problem,
            loading,
            settings,
            condensed,
            method,
            held,
            at,
            may_move_rigidly: is_carried_without_strain(problem),
            force: vec![0.0; problem.displacements()],
            condensed_force: vec![0.0; condensed.map_or(0, |condensed| condensed.problem.displacements())],
            gap: vec![0.0; n_c],
            mu: problem.mu().to_vec(),
            w_t_last: vec![0.0; n_c],
            w_o_last: vec![0.0; n_c],
        }
    }

    /// What drove the part tried last, from where the body has been carried; so is the state of an [`SubstepResult`].
    pub(super) fn data(&self) -> Increment<'_> {
        let IncrementDriver { force, gap, mu, w_t_last, w_o_last, .. } = self;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }

    /// Shows `see` the data of the part tried last, and its `state`, from where the body was at first.
    pub(super) fn show<T>(&self, state: &State, see: impl FnOnce(&Increment<'_>, &State) -> T) -> T {
        let RigidOffset { w_n, w_t: [w_t, w_o], .. } = &self.at.offset;
        if !self.at.offset.is_nonzero() {
            return see(&self.data(), state);
        }
        let moved = |x: &[f64], by: &[f64]| x.iter().zip(by).map(|(x, by)| x + by).collect::<Vec<f64>>();
        let gap = moved(&self.gap, w_n);
        let (w_t_last, w_o_last) = (moved(&self.w_t_last, w_t), moved(&self.w_o_last, w_o));
        let data = Increment { gap: &gap, w_t_last: &w_t_last, w_o_last: &w_o_last, ..self.data() };
        see(&data, &self.at.offset.whole(state))
    }

    /// What the increments so far leave.
    pub(super) fn increment_error(&mut self) -> Option<IncrementError> {
        self.method.increment_errors().map(|errors| errors.found())
    }

    /// What the method knows between two increments.
    pub(super) fn memory(&self, linear: &RefinedSolver) -> Snapshot {
        self.method.memory(linear)
    }

    /// Gives the method back what it knew; whether it knows that it did.
    pub(super) fn restore(&mut self, memory: Snapshot, linear: &mut RefinedSolver) -> Result<bool, LinearError> {
        self.method.restore(memory, linear)
    }

    /// From where the next part starts.
    fn start(&mut self) -> Start {
        let errors = self.method.increment_errors().cloned();
        Start { unknowns: self.method.unknowns().clone(), offset: self.at.offset.clone(), errors }
    }

    /// Back to where a part started.
    fn go_back(&mut self, start: Start) {
        self.method.unknowns().copy_from_slice(&start.unknowns);
        self.at.offset = start.offset;
        if let (Some(errors), Some(before)) = (self.method.increment_errors(), start.errors) {
            *errors = before;
        }
    }

    /// Goes on to `time`, in parts if need be, after what has been `tried` at it as a whole.
    fn increment(
        &mut self,
        time: f64,
        tried: (Start, SubstepResult),
        linear: &mut RefinedSolver,
        progress: &mut Progress<'_>,
    ) -> Result<IncrementProgress, LinearError> {
        let in_progress = self.at.in_progress.take();
        let in_progress = in_progress.unwrap_or_else(|| IncrementInProgress::new(self.at.reached.unwrap_or(0.0), time));
        let IncrementInProgress { start, mut pending, mut solved, mut kkt, mut ends, mut friction_work } = in_progress;
        let smallest = (time - start) * 0.5_f64.powi(self.settings.halvings as i32);
        let mut tried = Some(tried);
        loop {
            let end = pending.last().copied().unwrap_or(time);
            let from = self.at.reached.unwrap_or(0.0);
            let (begun, substep) = match tried.take() {
                Some(tried) => tried,
                None => (self.start(), self.substep(end, linear, &mut |iteration| progress.iteration(iteration))?),
            };
            let outcome = substep.outcome.clone();
            let so_far = solved.map_or(outcome.clone(), |solved| solved.then(outcome));
            if substep.status == Status::Converged {
                friction_work += self.problem.friction_work(&self.data(), &substep.state);
                self.accept(end, &substep);
                kkt = kkt.max(&substep.kkt);
                ends.push(end);
                pending.pop();
                let status = Status::Converged;
                let walked = IncrementResult { solved: so_far, substep, kkt, status, ends, friction_work };
                if pending.is_empty() {
                    return Ok(IncrementProgress::Ended(Box::new(walked)));
                }
                self.show(&walked.substep.state, |increment, state| {
                    progress.part(end, &self.data(), &walked, increment, state);
                });
                (solved, ends) = (Some(walked.solved), walked.ends);
            } else if let Some(MissingNodes { nodes, solved }) = self.lack(&substep) {
                self.at.estimate = solved.then_some(substep.state);
                self.at.errors = begun.errors.zip(self.condensed.and_then(Condensed::nodes).map(<[usize]>::to_vec));
                let solved = Some(so_far);
                self.at.in_progress = Some(IncrementInProgress { start, pending, solved, kkt, ends, friction_work });
                return Ok(IncrementProgress::NeedsNodes(nodes));
            } else {
                let half = 0.5 * (end - from);
                // Between neighbouring numbers there is no time.
                let no_time = from + half <= from || from + half >= end;
                if half < smallest || no_time || !self.smaller_may_do(&substep) {
                    let (kkt, status) = (substep.kkt, substep.status);
                    let walked = IncrementResult { solved: so_far, substep, kkt, status, ends, friction_work };
                    return Ok(IncrementProgress::Ended(Box::new(walked)));
                }
                self.go_back(begun);
                pending.push(from + half);
                solved = Some(so_far);
            }
        }
    }

    /// Solves and judges the part that ends at `time`.
    fn substep(
        &mut self,
        time: f64,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<SubstepResult, LinearError> {
        let input = self.pose(time);
        let outcome = self.solve(time, &input, linear, observe)?;
        let balanced = match self.whole() {
            None => self.balanced(self.method.state()),
            Some(whole) => {
                let states = whole.states(&[(time, self.method.state())], std::slice::from_ref(&self.force))?;
                states.into_iter().next().unwrap_or_else(|| self.balanced(State::zero(self.problem)))
            }
        };
        self.conclude(input.scales, outcome, balanced, linear)
    }

    /// Sets the data of the part that ends at `time`.
    fn pose(&mut self, time: f64) -> SubstepInput {
        let IncrementDriver { problem, loading, settings, .. } = *self;
        loading.force(time, &mut self.force);
        loading.gap_at(time, &mut self.gap);
        if let Some(friction) = loading.friction() {
            self.mu = friction.at(time);
        }
        let from = self.at.reached.unwrap_or(0.0);
        let begins = self.take_estimate(time).or(self.at.reached);
        let before = self.at.offset.clone();
        let sizes = loading.force_sizes(time, problem.displacements());
        let landed = self.find_rest_position(time, &sizes);
        self.gap.iter_mut().zip(&self.at.offset.w_n).for_each(|(gap, w)| *gap -= w);
        let tangential = [(&mut self.w_t_last, &self.at.w_t), (&mut self.w_o_last, &self.at.w_o)];
        for (k, (last, w)) in tangential.into_iter().enumerate() {
            // Slip is motion past the obstacle: where that moves along, the body has not.
            let (drift, drift_now) = (loading.drift_at(from, k), loading.drift_at(time, k));
            let (offset, carried_now) = (&before.w_t[k], &self.at.offset.w_t[k]);
            for (i, last) in last.iter_mut().enumerate() {
                *last = w[i] + (drift_now[i] - drift[i]) - (carried_now[i] - offset[i]);
            }
        }
        let scales = self.at.scales.with_load(problem, &self.data());
        // Where gaps and forces are rounded differences of larger ones there is nothing less to compare with.
        let terms = sizes.iter().fold(0.0_f64, |m, size| m.max(*size));
        let scales = scales.above_rounding(settings.tolerance, terms, self.at.offset.largest());
        SubstepInput { begins, sizes, landed, scales }
    }

    /// Lets the method loose on the part that ends at `time`.
    fn solve(
        &mut self,
        time: f64,
        input: &SubstepInput,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let IncrementDriver { problem, loading, condensed, settings, .. } = *self;
        let load = Load { force: &self.force, sizes: &input.sizes };
        if let Some(motion) = motion_driven_in_the_equations(problem, &self.mu, &load) {
            let stop = driven_motion(problem, &self.mu, &load);
            let stop = stop.map_or(Termination::EdgeFriction(motion), Termination::NoEquilibrium);
            return Ok(MethodResult { stop, ..MethodResult::new(f64::NAN) });
        }
        let mut force = &self.force;
        if let Some(condensed) = condensed {
            condensed.loading.force(time, &mut self.condensed_force);
            force = &self.condensed_force;
        }
        let [gap, mu, w_t_last, w_o_last] =
            [&self.gap, &self.mu, &self.w_t_last, &self.w_o_last].map(|values| on_nodes(condensed, values));
        let task = Task {
            first: input.begins.is_none(),
            increment: &Increment { force, gap: &gap, mu: &mu, w_t_last: &w_t_last, w_o_last: &w_o_last },
            response: &self.held.response(loading, input.begins, time),
            landed: input.landed.as_deref(),
            stretch: self.at.length.map(|length| (time - self.at.reached.unwrap_or(0.0)) / length),
            scales: &input.scales,
            tolerance: settings.tolerance,
        };
        self.method.solve(&task, linear, observe)
    }

    /// The whole body, where the method has a condensed one.
    fn whole(&self) -> Option<InteriorRecovery<'a>> {
        let IncrementDriver { problem, settings, .. } = *self;
        self.condensed.map(|condensed| InteriorRecovery { problem, condensed, settings })
    }

    /// A state of the whole body under the data of the part tried last.
    fn balanced(&self, state: State) -> RecoveredState {
        RecoveredState { imbalance: self.problem.imbalance(&self.force, &state), backward_error: 0.0, state }
    }

    /// Judges the state that the method has reached, refined first where it needs that; `scales` are those before it.
    fn conclude(
        &mut self,
        scales: KktScales,
        outcome: MethodResult,
        balanced: RecoveredState,
        linear: &mut RefinedSolver,
    ) -> Result<SubstepResult, LinearError> {
        let balanced = match self.whole() {
            None => balanced,
            Some(whole) => {
                let (problem, scaling) = (&whole.condensed.problem, self.settings.scaling);
                let mut contact = Linearized::new(self.method.as_mut(), linear, problem, scaling);
                whole.refined(balanced, &self.force, &scales, &mut contact)?
            }
        };
        Ok(self.judged(scales, outcome, balanced))
    }

    /// Judges a state under the data of the part tried last.
    fn judged(&mut self, scales: KktScales, outcome: MethodResult, balanced: RecoveredState) -> SubstepResult {
        let RecoveredState { state, imbalance, backward_error } = balanced;
        let outcome = MethodResult { backward_error: outcome.backward_error.max(backward_error), ..outcome };
        self.at.worst_backward_error = self.at.worst_backward_error.max(backward_error);
        let (scales, tolerance) = (scales.with_state(&state), self.settings.tolerance);
        let kkt = judge(self.problem, &self.data(), &state, &imbalance, &scales, tolerance);
        let status = record::verdict(&outcome, &kkt, tolerance);
        SubstepResult { state, scales, outcome, kkt, status }
    }

    /// The contact nodes that the equations lack after an `substep`.
    fn lack(&self, substep: &SubstepResult) -> Option<MissingNodes> {
        let held = self.condensed?.nodes()?;
        working_set::lack(self.problem, &self.data(), substep, held, self.settings.tolerance)
    }

    /// Goes on from the estimate of the state at `time`, if there is one.
    fn take_estimate(&mut self, time: f64) -> Option<f64> {
        let (condensed, estimate) = (self.condensed?, self.at.estimate.take()?);
        self.method.go_on_from(&condensed.condensed_state(&estimate));
        Some(time)
    }

    fn accept(&mut self, time: f64, substep: &SubstepResult) {
        if self.condensed.is_some_and(|condensed| condensed.nodes().is_some()) {
            self.at.state = Some(substep.state.clone());
        }
        let w = self.problem.contact_motion(&substep.state.u);
        self.move_on(time, w, substep.scales);
    }

    /// To `time`, where the contact nodes have moved by `w_n`, `w_t` and `w_o`.
    fn move_on(&mut self, time: f64, [w_n, w_t, w_o]: [Vec<f64>; 3], scales: KktScales) {
        let at = &mut *self.at;
        at.length = Some(time - at.reached.unwrap_or(0.0));
        (at.reached, at.scales) = (Some(time), scales);
        (at.w_n, at.w_t, at.w_o) = (w_n, w_t, w_o);
    }

    /// Whether a smaller load could make the difference.
    fn smaller_may_do(&self, substep: &SubstepResult) -> bool {
        match substep.status {
            Status::Converged
            | Status::Interrupted
            | Status::NoEquilibrium
            | Status::NoContinuation
            | Status::EdgeFriction
            | Status::OutOfMemory
            | Status::Unsupported => false,
            // Where rounding sets the limit, it does so at any load.
            _ => substep.kkt.worst().1 > 10.0 * rounding_level(self.problem, &substep.state, &substep.scales),
        }
    }
}

/// Of a value for each contact node those that the equations have.
fn on_nodes<'v>(condensed: Option<&Condensed>, values: &'v [f64]) -> Cow<'v, [f64]> {
    condensed.map_or(Cow::Borrowed(values), |condensed| condensed.on_nodes(values))
}
