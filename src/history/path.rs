//! From one time to the next: an increment, halved where it fails.
//!
//! A part is an increment of its own: friction sees the slip of each. Nothing of a part that fails
//! stays, and after a part that converges the rest of the increment is tried whole, so that the size
//! grows back. On the contact displacements alone several increments are solved before they are judged, see `bundle`.

mod bundle;
mod landed;

use std::borrow::Cow;

pub(super) use bundle::Judged;

use super::carried::Carried;
use super::held::HeldBody;
use super::increment_error::{IncrementError, IncrementErrors};
use super::memory::Memory;
use super::position::{Position, Underway};
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use super::told::Told;
use super::walked::{Attempt, Walked};
use super::whole::{Balanced, Linearized, Whole};
use super::working_set::{self, Lack};
use super::{Status, record};
use crate::condense::Condensed;
use crate::laws::{KktScales, judge, rounding_level};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::nonlinear::{Outcome, Stop};
use crate::problem::{ContactProblem, Increment, State};
use crate::solvability::{Load, driven_motion, is_carried_without_strain, motion_driven_in_the_equations};

/// The way through a history as far as it has converged, and the data of the part tried last.
pub(super) struct Path<'a> {
    problem: &'a ContactProblem,
    loading: &'a Loading,
    settings: &'a HistorySettings,
    /// If the method solves for the contact displacements alone.
    condensed: Option<&'a Condensed>,
    method: Box<dyn IncrementSolver + 'a>,
    held: HeldBody,
    /// How far the history has come.
    pub at: &'a mut Position,
    /// Whether the body may be carried without strain.
    may_be_carried: bool,
    force: Vec<f64>,
    condensed_force: Vec<f64>,
    gap: Vec<f64>,
    mu: Vec<f64>,
    w_t_last: Vec<f64>,
    w_o_last: Vec<f64>,
}

/// How far an increment came.
pub(super) enum Walk {
    /// To its end, or to where it failed.
    Ended(Box<Walked>),
    /// To where the equations lack contact nodes: all that they must hold to go on.
    Lacks(Vec<usize>),
}

/// From where a part starts.
struct Start {
    unknowns: Vec<f64>,
    carried: Carried,
    errors: Option<IncrementErrors>,
}

/// What is known of a part before it is solved, beside its data.
struct Posed {
    /// The time of the state from which the method begins, s.
    begins: Option<f64>,
    /// The sizes of the loads that `force` is the sum of, N.
    sizes: Vec<f64>,
    /// The nodes on which the body comes to rest.
    landed: Option<Vec<usize>>,
    /// The scales of the increments before and of the load.
    scales: KktScales,
}

impl<'a> Path<'a> {
    pub(super) fn new(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        settings: &'a HistorySettings,
        condensed: Option<&'a Condensed>,
        mut method: Box<dyn IncrementSolver + 'a>,
        held: HeldBody,
        at: &'a mut Position,
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
        Path {
            problem,
            loading,
            settings,
            condensed,
            method,
            held,
            at,
            may_be_carried: is_carried_without_strain(problem),
            force: vec![0.0; problem.displacements()],
            condensed_force: vec![0.0; condensed.map_or(0, |condensed| condensed.problem.displacements())],
            gap: vec![0.0; n_c],
            mu: problem.mu().to_vec(),
            w_t_last: vec![0.0; n_c],
            w_o_last: vec![0.0; n_c],
        }
    }

    /// What drove the part tried last, from where the body has been carried; so is the state of an [`Attempt`].
    pub(super) fn data(&self) -> Increment<'_> {
        let Path { force, gap, mu, w_t_last, w_o_last, .. } = self;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }

    /// Shows `see` the data of the part tried last, and its `state`, from where the body was at first.
    pub(super) fn show<T>(&self, state: &State, see: impl FnOnce(&Increment<'_>, &State) -> T) -> T {
        let Carried { w_n, w_t: [w_t, w_o], .. } = &self.at.carried;
        if !self.at.carried.is_somewhere() {
            return see(&self.data(), state);
        }
        let moved = |x: &[f64], by: &[f64]| x.iter().zip(by).map(|(x, by)| x + by).collect::<Vec<f64>>();
        let gap = moved(&self.gap, w_n);
        let (w_t_last, w_o_last) = (moved(&self.w_t_last, w_t), moved(&self.w_o_last, w_o));
        let data = Increment { gap: &gap, w_t_last: &w_t_last, w_o_last: &w_o_last, ..self.data() };
        see(&data, &self.at.carried.whole(state))
    }

    /// What the increments so far leave.
    pub(super) fn increment_error(&mut self) -> Option<IncrementError> {
        self.method.increment_errors().map(|errors| errors.found())
    }

    /// What the method knows between two increments.
    pub(super) fn memory(&self, linear: &Direct) -> Memory {
        self.method.memory(linear)
    }

    /// Gives the method back what it knew; whether it knows that it did.
    pub(super) fn recall(&mut self, memory: Memory, linear: &mut Direct) -> Result<bool, LinearError> {
        self.method.recall(memory, linear)
    }

    /// From where the next part starts.
    fn start(&mut self) -> Start {
        let errors = self.method.increment_errors().cloned();
        Start { unknowns: self.method.unknowns().clone(), carried: self.at.carried.clone(), errors }
    }

    /// Back to where a part started.
    fn go_back(&mut self, start: Start) {
        self.method.unknowns().copy_from_slice(&start.unknowns);
        self.at.carried = start.carried;
        if let (Some(errors), Some(before)) = (self.method.increment_errors(), start.errors) {
            *errors = before;
        }
    }

    /// Goes on to `time`, in parts if need be, after what has been `tried` at it as a whole.
    fn increment(
        &mut self,
        time: f64,
        tried: (Start, Attempt),
        linear: &mut Direct,
        told: &mut Told<'_>,
    ) -> Result<Walk, LinearError> {
        let underway = self.at.underway.take();
        let underway = underway.unwrap_or_else(|| Underway::new(self.at.reached.unwrap_or(0.0), time));
        let Underway { start, mut to_come, mut solved, mut kkt, mut ends, mut friction_work } = underway;
        let smallest = (time - start) * 0.5_f64.powi(self.settings.halvings as i32);
        let mut tried = Some(tried);
        loop {
            let end = to_come.last().copied().unwrap_or(time);
            let from = self.at.reached.unwrap_or(0.0);
            let (begun, attempt) = match tried.take() {
                Some(tried) => tried,
                None => (self.start(), self.attempt(end, linear, &mut |iteration| told.iteration(iteration))?),
            };
            let outcome = attempt.outcome.clone();
            let so_far = solved.map_or(outcome.clone(), |solved| solved.then(outcome));
            if attempt.status == Status::Converged {
                friction_work += self.problem.friction_work(&self.data(), &attempt.state);
                self.accept(end, &attempt);
                kkt = kkt.max(&attempt.kkt);
                ends.push(end);
                to_come.pop();
                let status = Status::Converged;
                let walked = Walked { solved: so_far, attempt, kkt, status, ends, friction_work };
                if to_come.is_empty() {
                    return Ok(Walk::Ended(Box::new(walked)));
                }
                self.show(&walked.attempt.state, |increment, state| {
                    told.part(end, &self.data(), &walked, increment, state);
                });
                (solved, ends) = (Some(walked.solved), walked.ends);
            } else if let Some(Lack { nodes, solved }) = self.lack(&attempt) {
                self.at.estimate = solved.then_some(attempt.state);
                self.at.errors = begun.errors.zip(self.condensed.and_then(Condensed::nodes).map(<[usize]>::to_vec));
                let solved = Some(so_far);
                self.at.underway = Some(Underway { start, to_come, solved, kkt, ends, friction_work });
                return Ok(Walk::Lacks(nodes));
            } else {
                let half = 0.5 * (end - from);
                // Between neighbouring numbers there is no time.
                let no_time = from + half <= from || from + half >= end;
                if half < smallest || no_time || !self.smaller_may_do(&attempt) {
                    let (kkt, status) = (attempt.kkt, attempt.status);
                    let walked = Walked { solved: so_far, attempt, kkt, status, ends, friction_work };
                    return Ok(Walk::Ended(Box::new(walked)));
                }
                self.go_back(begun);
                to_come.push(from + half);
                solved = Some(so_far);
            }
        }
    }

    /// Solves and judges the part that ends at `time`.
    fn attempt(&mut self, time: f64, linear: &mut Direct, observe: Observe<'_>) -> Result<Attempt, LinearError> {
        let posed = self.pose(time);
        let outcome = self.solve(time, &posed, linear, observe)?;
        let balanced = match self.whole() {
            None => self.balanced(self.method.state()),
            Some(whole) => {
                let states = whole.states(&[(time, self.method.state())], std::slice::from_ref(&self.force))?;
                states.into_iter().next().unwrap_or_else(|| self.balanced(State::zero(self.problem)))
            }
        };
        self.conclude(posed.scales, outcome, balanced, linear)
    }

    /// Sets the data of the part that ends at `time`.
    fn pose(&mut self, time: f64) -> Posed {
        let Path { problem, loading, settings, .. } = *self;
        loading.force(time, &mut self.force);
        loading.gap_at(time, &mut self.gap);
        if let Some(friction) = loading.friction() {
            self.mu = friction.at(time);
        }
        let from = self.at.reached.unwrap_or(0.0);
        let begins = self.take_estimate(time).or(self.at.reached);
        let before = self.at.carried.clone();
        let sizes = loading.force_sizes(time, problem.displacements());
        let landed = self.land(time, &sizes);
        self.gap.iter_mut().zip(&self.at.carried.w_n).for_each(|(gap, w)| *gap -= w);
        let tangential = [(&mut self.w_t_last, &self.at.w_t), (&mut self.w_o_last, &self.at.w_o)];
        for (k, (last, w)) in tangential.into_iter().enumerate() {
            // Slip is motion past the obstacle: where that moves along, the body has not.
            let (drift, drift_now) = (loading.drift_at(from, k), loading.drift_at(time, k));
            let (carried, carried_now) = (&before.w_t[k], &self.at.carried.w_t[k]);
            for (i, last) in last.iter_mut().enumerate() {
                *last = w[i] + (drift_now[i] - drift[i]) - (carried_now[i] - carried[i]);
            }
        }
        let scales = self.at.scales.with_load(problem, &self.data());
        // Where gaps and forces are rounded differences of larger ones there is nothing less to compare with.
        let terms = sizes.iter().fold(0.0_f64, |m, size| m.max(*size));
        let scales = scales.above_rounding(settings.tolerance, terms, self.at.carried.largest());
        Posed { begins, sizes, landed, scales }
    }

    /// Lets the method loose on the part that ends at `time`.
    fn solve(
        &mut self,
        time: f64,
        posed: &Posed,
        linear: &mut Direct,
        observe: Observe<'_>,
    ) -> Result<Outcome, LinearError> {
        let Path { problem, loading, condensed, settings, .. } = *self;
        let load = Load { force: &self.force, sizes: &posed.sizes };
        if let Some(motion) = motion_driven_in_the_equations(problem, &self.mu, &load) {
            let stop = driven_motion(problem, &self.mu, &load);
            let stop = stop.map_or(Stop::EdgeFriction(motion), Stop::NoEquilibrium);
            return Ok(Outcome { stop, ..Outcome::new(f64::NAN) });
        }
        let mut force = &self.force;
        if let Some(condensed) = condensed {
            condensed.loading.force(time, &mut self.condensed_force);
            force = &self.condensed_force;
        }
        let [gap, mu, w_t_last, w_o_last] =
            [&self.gap, &self.mu, &self.w_t_last, &self.w_o_last].map(|values| on_nodes(condensed, values));
        let task = Task {
            first: posed.begins.is_none(),
            increment: &Increment { force, gap: &gap, mu: &mu, w_t_last: &w_t_last, w_o_last: &w_o_last },
            response: &self.held.response(loading, posed.begins, time),
            landed: posed.landed.as_deref(),
            stretch: self.at.length.map(|length| (time - self.at.reached.unwrap_or(0.0)) / length),
            scales: &posed.scales,
            tolerance: settings.tolerance,
        };
        self.method.solve(&task, linear, observe)
    }

    /// The whole body, where the method has a condensed one.
    fn whole(&self) -> Option<Whole<'a>> {
        let Path { problem, settings, .. } = *self;
        self.condensed.map(|condensed| Whole { problem, condensed, settings })
    }

    /// A state of the whole body under the data of the part tried last.
    fn balanced(&self, state: State) -> Balanced {
        Balanced { imbalance: self.problem.imbalance(&self.force, &state), backward_error: 0.0, state }
    }

    /// Judges the state that the method has reached, refined first where it needs that; `scales` are those before it.
    fn conclude(
        &mut self,
        scales: KktScales,
        outcome: Outcome,
        balanced: Balanced,
        linear: &mut Direct,
    ) -> Result<Attempt, LinearError> {
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
    fn judged(&mut self, scales: KktScales, outcome: Outcome, balanced: Balanced) -> Attempt {
        let Balanced { state, imbalance, backward_error } = balanced;
        let outcome = Outcome { backward_error: outcome.backward_error.max(backward_error), ..outcome };
        self.at.worst_backward_error = self.at.worst_backward_error.max(backward_error);
        let (scales, tolerance) = (scales.with_state(&state), self.settings.tolerance);
        let kkt = judge(self.problem, &self.data(), &state, &imbalance, &scales, tolerance);
        let status = record::verdict(&outcome, &kkt, tolerance);
        Attempt { state, scales, outcome, kkt, status }
    }

    /// The contact nodes that the equations lack after an `attempt`.
    fn lack(&self, attempt: &Attempt) -> Option<Lack> {
        let held = self.condensed?.nodes()?;
        working_set::lack(self.problem, &self.data(), attempt, held, self.settings.tolerance)
    }

    /// Goes on from the estimate of the state at `time`, if there is one.
    fn take_estimate(&mut self, time: f64) -> Option<f64> {
        let (condensed, estimate) = (self.condensed?, self.at.estimate.take()?);
        self.method.go_on_from(&condensed.condensed_state(&estimate));
        Some(time)
    }

    fn accept(&mut self, time: f64, attempt: &Attempt) {
        if self.condensed.is_some_and(|condensed| condensed.nodes().is_some()) {
            self.at.state = Some(attempt.state.clone());
        }
        let w = self.problem.contact_motion(&attempt.state.u);
        self.move_on(time, w, attempt.scales);
    }

    /// To `time`, where the contact nodes have moved by `w_n`, `w_t` and `w_o`.
    fn move_on(&mut self, time: f64, [w_n, w_t, w_o]: [Vec<f64>; 3], scales: KktScales) {
        let at = &mut *self.at;
        at.length = Some(time - at.reached.unwrap_or(0.0));
        (at.reached, at.scales) = (Some(time), scales);
        (at.w_n, at.w_t, at.w_o) = (w_n, w_t, w_o);
    }

    /// Whether a smaller load could make the difference.
    fn smaller_may_do(&self, attempt: &Attempt) -> bool {
        match attempt.status {
            Status::Converged
            | Status::Interrupted
            | Status::NoEquilibrium
            | Status::NoContinuation
            | Status::EdgeFriction
            | Status::OutOfMemory
            | Status::Unsupported => false,
            // Where rounding sets the limit, it does so at any load.
            _ => attempt.kkt.worst().1 > 10.0 * rounding_level(self.problem, &attempt.state, &attempt.scales),
        }
    }
}

/// Of a value for each contact node those that the equations have.
fn on_nodes<'v>(condensed: Option<&Condensed>, values: &'v [f64]) -> Cow<'v, [f64]> {
    condensed.map_or(Cow::Borrowed(values), |condensed| condensed.on_nodes(values))
}
