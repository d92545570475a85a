//! The time-step error estimated by a companion run.

use serde::Serialize;

use crate::body::model::Model;
use crate::solver::history::Status;
use crate::solver::problem::State;

/// The time-step error of the tangential forces, estimated by a companion run with fewer or more increments.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct CompanionEstimate {
    /// The increments of the companion run.
    pub increments: usize,
    /// The verdict of the companion run. Without convergence there is no estimate.
    pub status: Status,
    /// The largest difference between the tangential forces of the two runs at the ends of load segments, relative to
    /// the largest tangential forces there.
    pub difference: Option<f64>,
    /// The resulting error of the tangential forces, as a share.
    pub error: Option<f64>,
}

impl CompanionEstimate {
    /// Compares the states of two runs of `model` at the same times. The error of the first is `share` times their
    /// difference, as long as errors are proportional to the length of increments.
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

/// The number of increments that was chosen for a given error of the tangential forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChosenIncrements {
    /// The requested error, as a share.
    pub asked: f64,
    /// The increments of a first run, at least eight in each load segment.
    pub tried: usize,
    /// The error of that run, the larger of its own estimate and the estimate by its companion; none if neither is
    /// known.
    pub error: Option<f64>,
    /// The chosen increments.
    pub increments: usize,
}
