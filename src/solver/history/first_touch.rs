//! Substeps that end where nodes first touch.
//!
//! Backward Euler measures slip from the start of an increment. A node that is open there and closed at the end has moved
//! along its obstacle by `m` before it touched, and this motion is no slip. A node that slips on in the direction of `m`
//! has the right friction all the same. Another one sticks in a wrong place, or slips in a wrong direction, and does so as
//! long as it stays closed. A substep therefore ends where the first such node touches. Every substep obeys the same laws
//! as an increment.
//!
//! To find the touch, the substep is solved again with all nodes kept open that were open at its start. On the straight
//! path to that state, a node touches after the share `τ = d / (d + e)` of the substep, where `d` is its distance at the
//! start and `e` its depth in the obstacle at the end, and `m = τ (w_T - w̄_T)`. With the slip `s` of the node in the whole
//! substep, its friction would be wrong by about `k (|m| - s·m / |m|)` once it is pressed hard enough, where `k` is the
//! stiffness of the node. That matters if it exceeds a share of the largest friction of its part so far, however small the
//! friction of the node is in this substep: its direction decides where the node goes.
//!
//! The state on the tangent at the start, on which no node changes its case, tells beforehand if there is such an error at
//! all. The default method starts there anyway. If it shows none, nothing is solved again.

use super::body::Body;
use super::increment::{IncrementDriver, Rollback, SubstepInput};
use super::stage::Stage;
use super::state::Step;
use super::task::Observe;
use crate::algebra::linear::{Computed, RefinedSolver};
use crate::solver::laws::coulomb::{TangentialCase, length, tangential_case};
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::State;

/// The error of a node's friction that matters, relative to the largest friction of its part so far. In 105 random plane
/// scenes with 20 and 80 increments, 0.05 divides the mean error of friction by 5.8 and 5.0 for 1.5 and 1.3 times the
/// factorisations. With 0.1 a block that comes to rest at an angle kept errors of 18 %.
const MATTERS: f64 = 0.05;

/// The error on the tangent from which the touch is looked for. In the same scenes, a tenth of [`MATTERS`] leaves every
/// division as it is, and a fifth loses one whose nodes stick at first and slip before the touch.
const SHOWS: f64 = 0.05 * MATTERS;

/// A smaller distance times stiffness, or pressure, is rounding, relative to the largest friction so far: an iterative solver
/// leaves 1e-19 N at open nodes. So is a smaller friction, relative to the largest possible.
const ROUNDING: f64 = 1e-9;

/// A substep ends when this share of the time to the touch is over, so that rounding does not decide whether the node is
/// closed. A touch after this share of a substep counts as one at its end.
const BEFORE: f64 = 1.0 - 1e-6;

/// Nodes are kept open by gaps that exceed the gaps and motions of these nodes in the state with contact by this factor.
const FAR: f64 = 1e3;

impl IncrementDriver<'_> {
    /// Looks for the first touch in a converged substep that began at the times and the state given. Returns the share
    /// of the substep after which a node touches whose motion before matters, and the result of the method, or `None` if
    /// no such node is possible. Without such a share, the method is left at the end of the substep, unless it was interrupted.
    pub(super) fn first_touch(
        &mut self,
        [from, time]: [f64; 2],
        substep: &Step,
        (input, start): (&SubstepInput, &Rollback),
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Computed<Option<(Option<f64>, MethodResult)>> {
        let Body { problem, loading, .. } = self.body;
        let (p_n, gaps) = (&substep.state.p_n, loading.gaps_at(from));
        let mut force = vec![0.0; problem.displacements()];
        loading.force(from, &mut force);
        // Loads that are there at once have no path, and a body that moves rigidly may rest on these nodes alone.
        let is_at_once = match self.history.reached {
            Some(_) => force == self.stage.force && gaps == loading.gaps_at(time),
            None => force.iter().any(|f| *f != 0.0),
        };
        if is_at_once || self.stage.may_move_rigidly {
            return Ok(None);
        }
        let part = &problem.natural().contact_part;
        let friction: Vec<f64> = part.iter().map(|part| self.history.friction[*part]).collect();
        let stiffness = problem.contact_stiffness();
        let distance: Vec<f64> = gaps.iter().zip(&self.history.w_n).map(|(gap, w)| gap - w).collect();
        let is_open = |i: usize| stiffness[i] * distance[i] > ROUNDING * friction[i];
        let has_tangent = |i: usize| problem.tangential_maps().iter().any(|map| !map.row(i).is_empty());
        let rubs = |i: usize| self.stage.mu[i] > 0.0 && p_n[i] > ROUNDING * friction[i] && has_tangent(i);
        let nodes: Vec<usize> = self.body.nodes().map_or((0..problem.contacts()).collect(), <[usize]>::to_vec);
        if !nodes.iter().any(|i| is_open(*i) && rubs(*i)) {
            return Ok(None);
        }
        let [w_n, end_t, end_o] = problem.contact_motion(&substep.state.u);
        let Stage { gap, w_t_last, w_o_last, .. } = &*self.stage;
        let (gap, last) = (gap.clone(), [w_t_last.clone(), w_o_last.clone()]);
        // The share of the substep after which a node touches on the straight path to a state, and the error of its friction.
        let touch = |[w_n, w_t, w_o]: &[Vec<f64>; 3], (k, i): (usize, usize)| {
            let share = distance[i] / (distance[i] + w_n[k] - gap[i]);
            let before = if share > 0.0 { share.min(1.0) } else { 1.0 };
            let moved = [w_t[k] - last[0][i], w_o[k] - last[1][i]].map(|w| before * w);
            let slip = [end_t[i] - last[0][i], end_o[i] - last[1][i]];
            (share, stiffness[i] * before_slip(moved, slip) / friction[i])
        };
        let candidates: Vec<(usize, usize)> =
            nodes.iter().copied().enumerate().filter(|(_, i)| is_open(*i) && rubs(*i)).collect();
        let (own, _) = self.body.solved();
        let cases = self.cases(from, &start.state, &nodes, is_open);
        if let Some(ahead) = self.stage.method.ahead(&start.unknowns, &cases, linear)? {
            let w = own.contact_motion(&ahead.u);
            if !candidates.iter().any(|node| touch(&w, *node).1 > SHOWS) {
                return Ok(None);
            }
        }
        let reached = self.stage.method.snapshot(linear);
        let open = nodes.iter().filter(|i| is_open(**i));
        let far = FAR * open.clone().map(|i| gap[*i].abs() + w_n[*i].abs()).fold(0.0, f64::max);
        for i in open {
            self.stage.gap[*i] = far;
        }
        self.stage.method.unknowns().copy_from_slice(&start.unknowns);
        let solved = self.solve(time, input, linear, observe)?;
        self.stage.gap.clone_from(&gap);
        let w = own.contact_motion(&self.stage.method.state().u);
        let matters = |node: &(usize, usize)| {
            let (share, error) = touch(&w, *node);
            (error > MATTERS && share > 0.0 && share < BEFORE).then_some(BEFORE * share)
        };
        let is_found = solved.stop == Termination::Converged;
        let share = candidates.iter().filter_map(matters).min_by(f64::total_cmp).filter(|_| is_found);
        if share.is_none() && solved.stop != Termination::Interrupted {
            self.stage.method.restore(reached, linear)?;
        }
        Ok(Some((share, solved)))
    }

    /// Returns the cases of the `nodes` in their `state` at the time `from`. Nodes that touch without force stick at first.
    fn cases(
        &self,
        from: f64,
        state: &State,
        nodes: &[usize],
        is_open: impl Fn(usize) -> bool,
    ) -> Vec<(bool, TangentialCase)> {
        let (mu, [slip_t, slip_o], r_t) = (self.friction_at(from), &self.history.slip, &self.settings.conventions.r_t);
        let case = |(k, &i): (usize, &usize)| match state.p_n[k] {
            _ if is_open(i) => (false, TangentialCase::NoPressure),
            p_n if p_n > 0.0 => {
                let p = [state.p_t[k], state.p_o[k]];
                (true, tangential_case(p, p_n, [slip_t[i], slip_o[i]], mu[i], r_t[i]))
            }
            _ => (true, TangentialCase::Stick),
        };
        nodes.iter().enumerate().map(case).collect()
    }

    /// Returns the largest friction `Σ |p_T|` of each part so far, N, up to the end of `substep`.
    pub(super) fn friction_with(&self, substep: &Step) -> Vec<f64> {
        let mut friction = vec![0.0; self.history.friction.len()];
        for (i, part) in self.body.problem.natural().contact_part.iter().enumerate() {
            let rounding = ROUNDING * self.stage.mu[i] * substep.state.p_n[i];
            friction[*part] += length([substep.state.p_t[i], substep.state.p_o[i]]).max(rounding);
        }
        friction.iter().zip(&self.history.friction).map(|(now, before)| now.max(*before)).collect()
    }
}

/// Returns the part of a motion before a touch that the slip of the whole substep does not contain.
fn before_slip(moved: [f64; 2], slip: [f64; 2]) -> f64 {
    let size = length(moved);
    if size > 0.0 { (size - (slip[0] * moved[0] + slip[1] * moved[1]) / size).max(0.0) } else { 0.0 }
}
