//! What became of an increment, and of its parts.

use super::Status;
use crate::laws::{KktErrors, KktScales};
use crate::nonlinear::Outcome;
use crate::problem::State;

/// What became of one part.
pub(super) struct Attempt {
    pub state: State,
    pub scales: KktScales,
    pub outcome: Outcome,
    pub kkt: KktErrors,
    pub status: Status,
}

/// What became of an increment.
pub(super) struct Walked {
    /// What the method did in all its parts, the failed ones included.
    pub solved: Outcome,
    /// The last part.
    pub attempt: Attempt,
    /// The largest errors of the parts that count: all that converged, or the one that failed.
    pub kkt: KktErrors,
    pub status: Status,
    /// The ends (s) of the parts that converged.
    pub ends: Vec<f64>,
    /// What friction dissipated in these, J.
    pub friction_work: f64,
}
