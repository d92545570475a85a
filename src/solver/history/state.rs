//! How far a history has come.

use super::Status;
use super::increment_error::IncrementErrors;
use super::rigid_offset::RigidOffset;
use crate::solver::laws::{KktErrors, KktScales};
use crate::solver::newton::MethodResult;
use crate::solver::problem::{ContactProblem, State};
use serde::{Deserialize, Serialize};

/// How far a history has come: all that one stage of it leaves to the next.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct HistoryState {
    /// The time reached; `None` stands for the unloaded body.
    pub reached: Option<f64>,
    /// The length of the last part, s.
    pub length: Option<f64>,
    /// The state then, from where the body has been carried, if another stage may follow.
    pub state: Option<State>,
    /// The largest backward error of the whole system where the body is condensed.
    pub worst_backward_error: f64,
    pub scales: KktScales,
    /// Where the body has been carried, from where all displacements and gaps of a part count.
    pub offset: RigidOffset,
    /// The normal displacements at the end of the last part.
    pub w_n: Vec<f64>,
    /// `w̄_t` and `w̄_o` of the next part.
    pub w_t: Vec<f64>,
    pub w_o: Vec<f64>,
    /// The increment that the last stage could not end.
    #[serde(skip)]
    pub in_progress: Option<IncrementInProgress>,
    /// What the increments left until the last stage ended, and the contact nodes that it had.
    #[serde(skip)]
    pub errors: Option<(IncrementErrors, Vec<usize>)>,
    /// Where the next part begins its iterations, if not at the state reached: near its end.
    #[serde(skip)]
    pub estimate: Option<State>,
}

/// An increment that has begun.
#[derive(Clone)]
pub(super) struct IncrementInProgress {
    /// Where it began, s.
    pub start: f64,
    /// The ends of the parts to come, s, the nearest last.
    pub pending: Vec<f64>,
    /// What the method has done in it.
    pub solved: Option<MethodResult>,
    /// The largest errors of the parts that converged.
    pub kkt: KktErrors,
    /// The ends (s) of these.
    pub ends: Vec<f64>,
    /// What friction dissipated in them, J.
    pub friction_work: f64,
}

impl HistoryState {
    /// The unloaded body.
    pub(super) fn start(problem: &ContactProblem) -> Self {
        let zeros = || vec![0.0; problem.contacts()];
        HistoryState {
            reached: None,
            length: None,
            state: None,
            worst_backward_error: 0.0,
            scales: KktScales::default(),
            offset: RigidOffset::nowhere(problem),
            w_n: zeros(),
            w_t: zeros(),
            w_o: zeros(),
            in_progress: None,
            errors: None,
            estimate: None,
        }
    }
}

impl HistoryState {
    /// Whether it is one of `problem`, by what a `state` must be.
    pub(super) fn fits(&self, problem: &ContactProblem, state: impl Fn(&State) -> bool) -> bool {
        let contacts = problem.contacts();
        let all = [&self.w_n, &self.w_t, &self.w_o].iter().all(|w| w.len() == contacts);
        all && self.state.as_ref().is_none_or(state) && self.offset.fits(problem)
    }
}

impl IncrementInProgress {
    /// An increment from `start` to `end` (s).
    pub(super) fn new(start: f64, end: f64) -> Self {
        IncrementInProgress {
            start,
            pending: vec![end],
            solved: None,
            kkt: KktErrors::default(),
            ends: Vec::new(),
            friction_work: 0.0,
        }
    }
}

/// What became of one part.
pub(super) struct SubstepResult {
    pub state: State,
    pub scales: KktScales,
    pub outcome: MethodResult,
    pub kkt: KktErrors,
    pub status: Status,
}

/// What became of an increment.
pub(super) struct IncrementResult {
    /// What the method did in all its parts, the failed ones included.
    pub solved: MethodResult,
    /// The last part.
    pub substep: SubstepResult,
    /// The largest errors of the parts that count: all that converged, or the one that failed.
    pub kkt: KktErrors,
    pub status: Status,
    /// The ends (s) of the parts that converged.
    pub ends: Vec<f64>,
    /// What friction dissipated in these, J.
    pub friction_work: f64,
}
