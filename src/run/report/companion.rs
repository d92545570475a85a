//! What a second run with other increments tells of those of the first.

use serde::Serialize;

use crate::body::model::Model;
use crate::solver::history::Status;
use crate::solver::problem::State;

/// What the increments of a run leave in its tangential forces, by a run with fewer or with more of them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CompanionEstimate {
    /// The increments of the other run.
    pub increments: usize,
    /// Its verdict. Where it did not converge there is no estimate.
    pub status: Status,
    /// How far the tangential forces of the two runs differ at most, at the ends of the stretches in which everything goes on in
    /// one direction, relative to their largest there.
    pub difference: Option<f64>,
    /// The error of the tangential forces that follows, as a share.
    pub error: Option<f64>,
}

impl CompanionEstimate {
    /// Compares the states of two runs of `model` at the same times; `share` of their difference is the error of the first, while
    /// errors are proportional to the length of increments.
    pub fn new(model: &Model, increments: usize, status: Status, states: [&[State]; 2], share: f64) -> Self {
        let problem = &model.problem;
        let [these, others] = states;
        let largest =
            these.iter().map(|state| problem.force_norm(|i| [state.p_t[i], state.p_o[i]])).fold(0.0, f64::max);
        let apart =
            these.iter().zip(others).map(|(a, b)| problem.force_norm(|i| [a.p_t[i] - b.p_t[i], a.p_o[i] - b.p_o[i]]));
        let apart = apart.fold(0.0, f64::max);
        let relative = if apart == 0.0 { 0.0 } else { apart / largest };
        let is_known = status == Status::Converged && these.len() == others.len() && relative.is_finite();
        let difference = is_known.then_some(relative);
        CompanionEstimate { increments, status, difference, error: difference.map(|difference| share * difference) }
    }
}

/// How many increments a run took to leave a given error in its tangential forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChosenIncrements {
    /// The error that was asked for, as a share.
    pub asked: f64,
    /// The increments of a first run, eight or more in each stretch in which everything goes on in one direction.
    pub tried: usize,
    /// The error of that run, the larger of its own estimate and of that by its companion; none where neither can be told.
    pub error: Option<f64>,
    /// The increments that follow.
    pub increments: usize,
}
