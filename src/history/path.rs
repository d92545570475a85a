//! From one time to the next: an increment, halved where it fails.
//!
//! A part is an increment of its own: friction sees the slip of each. Nothing of a part that fails
//! stays, and after a part that converges the rest of the increment is tried whole, so that the size
//! grows back.

use super::held::HeldBody;
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use super::told::Told;
use super::walked::{Attempt, Walked};
use super::whole::Whole;
use super::{Status, record};
use crate::condense::Condensed;
use crate::contact::{KktErrors, KktScales, judge, rounding_level};
use crate::linear::{Direct, LinearError};
use crate::loading::Loading;
use crate::nonlinear::{Outcome, Stop};
use crate::problem::{ContactProblem, Increment};
use crate::solvability::{driven_motion, motion_driven_in_the_equations};

/// The way through a history as far as it has converged, and the data of the part tried last.
pub(super) struct Path<'a> {
    problem: &'a ContactProblem,
    loading: &'a Loading,
    settings: &'a HistorySettings,
    /// If the method solves for the contact displacements alone.
    condensed: Option<&'a Condensed>,
    method: Box<dyn IncrementSolver + 'a>,
    held: HeldBody,
    /// The time reached; `None` stands for the unloaded body.
    pub reached: Option<f64>,
    /// The largest backward error of the whole system where the body is condensed.
    pub worst_backward_error: f64,
    scales: KktScales,
    force: Vec<f64>,
    condensed_force: Vec<f64>,
    gap: Vec<f64>,
    mu: Vec<f64>,
    w_t_last: Vec<f64>,
    w_o_last: Vec<f64>,
    /// `w̄_t` and `w̄_o` of the next part.
    w_t: Vec<f64>,
    w_o: Vec<f64>,
}

impl<'a> Path<'a> {
    pub(super) fn new(
        problem: &'a ContactProblem,
        loading: &'a Loading,
        settings: &'a HistorySettings,
        condensed: Option<&'a Condensed>,
        method: Box<dyn IncrementSolver + 'a>,
        held: HeldBody,
    ) -> Self {
        let n_c = problem.contacts();
        Path {
            problem,
            loading,
            settings,
            condensed,
            method,
            held,
            reached: None,
            worst_backward_error: 0.0,
            scales: KktScales::default(),
            force: vec![0.0; problem.displacements()],
            condensed_force: vec![0.0; condensed.map_or(0, |condensed| condensed.problem.displacements())],
            gap: vec![0.0; n_c],
            mu: problem.mu().to_vec(),
            w_t_last: vec![0.0; n_c],
            w_o_last: vec![0.0; n_c],
            w_t: vec![0.0; n_c],
            w_o: vec![0.0; n_c],
        }
    }

    /// What drove the part tried last.
    pub(super) fn data(&self) -> Increment<'_> {
        let Path { force, gap, mu, w_t_last, w_o_last, .. } = self;
        Increment { force, gap, mu, w_t_last, w_o_last }
    }

    /// Goes on to `time`, in parts if need be.
    pub(super) fn increment(
        &mut self,
        time: f64,
        linear: &mut Direct,
        told: &mut Told<'_>,
    ) -> Result<Walked, LinearError> {
        let start = self.reached.unwrap_or(0.0);
        let smallest = (time - start) * 0.5_f64.powi(self.settings.halvings as i32);
        // The ends of the parts to come, the nearest last.
        let mut to_come = vec![time];
        let mut solved: Option<Outcome> = None;
        let (mut kkt, mut ends, mut friction_work) = (KktErrors::default(), Vec::new(), 0.0);
        loop {
            let end = to_come.last().copied().unwrap_or(time);
            let from = self.reached.unwrap_or(0.0);
            let unknowns = self.method.unknowns().clone();
            let attempt = self.attempt(end, linear, &mut |iteration| told.iteration(iteration))?;
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
                    return Ok(walked);
                }
                told.part(end, &self.data(), &walked);
                (solved, ends) = (Some(walked.solved), walked.ends);
            } else {
                let half = 0.5 * (end - from);
                // Between neighbouring numbers there is no time.
                let no_time = from + half <= from || from + half >= end;
                if half < smallest || no_time || !self.smaller_may_do(&attempt) {
                    let (kkt, status) = (attempt.kkt, attempt.status);
                    return Ok(Walked { solved: so_far, attempt, kkt, status, ends, friction_work });
                }
                self.method.unknowns().copy_from_slice(&unknowns);
                to_come.push(from + half);
                solved = Some(so_far);
            }
        }
    }

    /// Solves the part that ends at `time`.
    fn attempt(&mut self, time: f64, linear: &mut Direct, observe: Observe<'_>) -> Result<Attempt, LinearError> {
        let Path { problem, loading, condensed, settings, .. } = *self;
        loading.force(time, &mut self.force);
        loading.gap_at(time, &mut self.gap);
        if let Some(friction) = loading.friction() {
            self.mu = friction.at(time);
        }
        let from = self.reached.unwrap_or(0.0);
        let tangential = [(&mut self.w_t_last, &self.w_t), (&mut self.w_o_last, &self.w_o)];
        for (k, (last, w)) in tangential.into_iter().enumerate() {
            // Slip is motion past the obstacle: where that moves along, the body has not.
            let (before, now) = (loading.drift_at(from, k), loading.drift_at(time, k));
            for (i, last) in last.iter_mut().enumerate() {
                *last = w[i] + (now[i] - before[i]);
            }
        }
        let increment = Increment {
            force: &self.force,
            gap: &self.gap,
            mu: &self.mu,
            w_t_last: &self.w_t_last,
            w_o_last: &self.w_o_last,
        };
        let before = self.scales.with_load(self.problem, &increment);
        let mut force = &self.force;
        if let Some(condensed) = condensed {
            condensed.loading.force(time, &mut self.condensed_force);
            force = &self.condensed_force;
        }
        let task = Task {
            first: self.reached.is_none(),
            increment: &Increment { force, ..increment },
            response: &self.held.response(loading, self.reached, time),
            scales: &before,
            tolerance: settings.tolerance,
        };
        let mut outcome = match motion_driven_in_the_equations(problem, &self.mu, &self.force) {
            None => self.method.solve(&task, linear, observe)?,
            Some(motion) => {
                let stop = driven_motion(problem, &self.mu, &self.force);
                let stop = stop.map_or(Stop::EdgeFriction(motion), Stop::NoEquilibrium);
                Outcome { stop, ..Outcome::new(f64::NAN) }
            }
        };
        let state = match condensed {
            None => self.method.state(),
            Some(condensed) => {
                let whole = Whole { problem, condensed, increment: &increment, scales: &before, settings, time };
                let (state, backward_error) = whole.state(self.method.as_mut(), linear)?;
                outcome.backward_error = outcome.backward_error.max(backward_error);
                self.worst_backward_error = self.worst_backward_error.max(backward_error);
                state
            }
        };
        let scales = before.with_state(&state);
        let kkt = judge(problem, &increment, &state, &scales, settings.tolerance);
        let status = record::verdict(&outcome, &kkt, settings.tolerance);
        Ok(Attempt { state, scales, outcome, kkt, status })
    }

    fn accept(&mut self, time: f64, attempt: &Attempt) {
        self.reached = Some(time);
        self.scales = attempt.scales;
        self.w_t = self.problem.c_t().mul(&attempt.state.u);
        self.w_o = self.problem.c_o().mul(&attempt.state.u);
    }

    /// Whether a smaller load could make the difference.
    fn smaller_may_do(&self, attempt: &Attempt) -> bool {
        match attempt.status {
            Status::Converged
            | Status::Interrupted
            | Status::NoEquilibrium
            | Status::EdgeFriction
            | Status::OutOfMemory
            | Status::Unsupported => false,
            // Where rounding sets the limit, it does so at any load.
            _ => attempt.kkt.worst().1 > 10.0 * rounding_level(self.problem, &attempt.state, &attempt.scales),
        }
    }
}
