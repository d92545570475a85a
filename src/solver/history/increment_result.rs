//! What became of an increment, and of its parts.

use super::Status;
use crate::solver::laws::{KktErrors, KktScales};
use crate::solver::newton::MethodResult;
use crate::solver::problem::State;

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
