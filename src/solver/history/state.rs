//! The progress of a history.
//!
//! # The rigid offset of a body that only contact holds
//!
//! Such a body may move by a million times its deformation before it comes to rest, which would destroy the accuracy
//! of its forces: `K u` is rounded to `ε |K| |u|`. A method that starts far away also closes and opens contacts that
//! are unrelated to the solution. Rigid motions cause no strain, so the equations do not depend on the offset: the
//! unknowns are displacements relative to the offset, and the obstacles move the opposite way.

use super::increment_error::IncrementErrors;
use super::record::{ContactCounts, IncrementRecord, Seconds};
use super::{Slip, Status};
use crate::algebra::sparse::{Csr, sum};
use crate::solver::laws::{ContactStatus, KktErrors, KktScales};
use crate::solver::newton::MethodResult;
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// The progress of a history: all data that one stage passes to the next.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct HistoryState {
    /// The time reached; `None` means the unloaded body.
    pub reached: Option<f64>,
    /// The state at that time, relative to the rigid offset, if another stage may follow.
    pub state: Option<State>,
    /// The largest backward error of the whole system, if the body is condensed.
    pub worst_backward_error: f64,
    /// The largest friction `Σ |p_T|` of each part of the body so far, N.
    pub friction: Vec<f64>,
    pub scales: KktScales,
    /// The rigid offset, to which all displacements and gaps of a substep are relative.
    pub offset: RigidOffset,
    /// The normal displacements at the end of the last substep.
    pub w_n: Vec<f64>,
    /// `w̄_t` and `w̄_o` of the next substep.
    pub w_t: Vec<f64>,
    pub w_o: Vec<f64>,
    /// The slip in the last substep, along both tangents.
    pub slip: [Vec<f64>; 2],
    /// The increment that the last stage could not complete.
    #[serde(skip)]
    pub in_progress: Option<IncrementInProgress>,
    /// The time-step error up to the end of the last stage, and its working set.
    #[serde(skip)]
    pub errors: Option<(IncrementErrors, Vec<usize>)>,
    /// The state from which the iteration of the next substep starts, near its end, if not the state reached.
    #[serde(skip)]
    pub estimate: Option<State>,
}

/// An increment that has begun.
#[derive(Clone)]
pub(super) struct IncrementInProgress {
    /// The start of the increment, s.
    pub start: f64,
    /// The ends of the pending substeps, s, in descending order.
    pub pending: Vec<f64>,
    /// The sum of the substeps so far, with the state of none.
    pub sum: Step,
}

impl HistoryState {
    /// Creates the state of the unloaded body.
    pub(super) fn start(problem: &ContactProblem) -> Self {
        let zeros = || vec![0.0; problem.contacts()];
        HistoryState {
            reached: None,
            state: None,
            worst_backward_error: 0.0,
            friction: vec![0.0; problem.natural().parts],
            scales: KktScales::default(),
            offset: RigidOffset::zero(problem),
            w_n: zeros(),
            w_t: zeros(),
            w_o: zeros(),
            slip: [zeros(), zeros()],
            in_progress: None,
            errors: None,
            estimate: None,
        }
    }
}

impl HistoryState {
    /// Returns `true` if the state has the sizes of `problem`. `state` checks a [`State`].
    pub(super) fn fits(&self, problem: &ContactProblem, state: impl Fn(&State) -> bool) -> bool {
        let contacts = problem.contacts();
        let mut all = [&self.w_n, &self.w_t, &self.w_o].into_iter().chain(&self.slip);
        let all = all.all(|w| w.len() == contacts);
        all && self.state.as_ref().is_none_or(state) && self.offset.fits(problem)
    }
}

impl IncrementInProgress {
    /// Creates an increment from `start` to `end` (s).
    pub(super) fn new(start: f64, end: f64) -> Self {
        IncrementInProgress { start, pending: vec![end], sum: Step::default() }
    }

    /// Returns the increment up to the end of the last `substep`, with the errors of all substeps that count: all that
    /// converged, or the one that failed.
    pub(super) fn up_to(&self, substep: Step) -> Step {
        let Step { solved, ends, friction_work, .. } = self.sum.clone();
        let kkt = if substep.status == Status::Converged { self.sum.kkt } else { substep.kkt };
        Step { solved, kkt, ends, friction_work, ..substep }
    }
}

impl Step {
    /// Creates the record of this substep or increment, which ends at `time` (s) under the external `force`.
    pub(super) fn record(
        &self,
        problem: &ContactProblem,
        (index, time, force): (usize, f64, &[f64]),
        statuses: &[ContactStatus],
        seconds: Seconds,
    ) -> IncrementRecord {
        let MethodResult { attempts, rescued, iterations, backtracks, theta, backward_error, .. } = self.solved;
        IncrementRecord {
            index,
            time,
            status: self.status,
            parts: self.ends.len(),
            part_ends: if self.ends == [time] { Vec::new() } else { self.ends.clone() },
            attempts,
            rescued,
            iterations,
            backtracks,
            theta,
            kkt: self.kkt,
            backward_error,
            contact: ContactCounts::of(statuses),
            friction_work: self.friction_work,
            strain_energy: problem.energy_of_parts(force, &self.state, |_| true),
            seconds,
            ..IncrementRecord::default()
        }
    }
}

/// The result of a substep, or of an increment: the sum of its substeps.
#[derive(Clone)]
pub(super) struct Step {
    /// The result of the method, over all substeps of an increment, including failed ones.
    pub solved: MethodResult,
    /// The state at the end of the last substep, and the scales of its error measure.
    pub state: State,
    pub scales: KktScales,
    /// The largest errors.
    pub kkt: KktErrors,
    pub status: Status,
    /// The slip of a joint, if the last substep showed it.
    pub slip: Option<Slip>,
    /// The ends (s) of the substeps of an increment that converged.
    pub ends: Vec<f64>,
    /// The work that friction dissipated in these substeps, J.
    pub friction_work: f64,
}

impl Default for Step {
    /// Creates the sum of no substeps.
    fn default() -> Self {
        Step {
            solved: MethodResult::nothing(),
            state: State::default(),
            scales: KktScales::default(),
            kkt: KktErrors::default(),
            status: Status::Converged,
            slip: None,
            ends: Vec::new(),
            friction_work: 0.0,
        }
    }
}

/// A rigid motion of the body, as displacements and motions of the contact nodes.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct RigidOffset {
    /// The displacements, n_u, m; empty if the body has not moved.
    pub u: Vec<f64>,
    /// The normal displacements of the contact nodes, n_c, m.
    pub w_n: Vec<f64>,
    /// The tangential displacements of the contact nodes along both tangents, n_c, m.
    pub w_t: [Vec<f64>; 2],
}

impl RigidOffset {
    /// Creates the offset of a body that has not moved.
    pub(super) fn zero(problem: &ContactProblem) -> Self {
        let zeros = || vec![0.0; problem.contacts()];
        RigidOffset { u: Vec::new(), w_n: zeros(), w_t: [zeros(), zeros()] }
    }

    /// Adds the problem's rigid modes with these `weights`.
    pub(super) fn by(&self, problem: &ContactProblem, weights: &[f64]) -> Self {
        if weights.iter().all(|weight| *weight == 0.0) {
            return self.clone();
        }
        let mut u = problem.rigid_motion(weights);
        u.iter_mut().zip(&self.u).for_each(|(u, offset)| *u += offset);
        let moved = |map: &Csr| map.mul(&u);
        RigidOffset { w_n: moved(problem.c_n()), w_t: problem.tangential_maps().map(moved), u }
    }

    /// Returns `true` if the offset has the sizes of `problem`.
    pub(super) fn fits(&self, problem: &ContactProblem) -> bool {
        let [w_t, w_o] = &self.w_t;
        let contacts = [&self.w_n, w_t, w_o].iter().all(|w| w.len() == problem.contacts());
        contacts && [0, problem.displacements()].contains(&self.u.len())
    }

    /// Returns `true` if the body has moved.
    pub(super) fn is_nonzero(&self) -> bool {
        !self.u.is_empty()
    }

    /// Converts a `state` relative to the offset into one relative to the initial configuration.
    pub(super) fn to_absolute(&self, state: &State) -> State {
        let mut whole = state.clone();
        if self.is_nonzero() {
            let u_rest = state.u_rest.iter().chain(std::iter::repeat(&0.0));
            let sums = self.u.iter().zip(&state.u).zip(u_rest).map(|((offset, u), rest)| {
                let (u, left) = sum(*offset, *u);
                sum(u, left + rest)
            });
            (whole.u, whole.u_rest) = sums.unzip();
        }
        whole
    }
}
