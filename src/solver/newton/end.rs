//! The stopping tests of Algorithm BN.

use crate::algebra::linear::LinearError;

/// A measure of the distance of `z + rest` from the exact law, where `rest` is the low-order part of `z`.
pub type Measure<'a> = &'a mut dyn FnMut(&[f64], &[f64]) -> Result<f64, LinearError>;

/// The stopping test of Algorithm BN.
pub enum StopCriterion<'a> {
    /// `Theta ≤ ε` after a step, in the unit of the formulation's `Theta`: the paper's test.
    Merit(f64),
    /// The caller's error measure is at most the tolerance, possibly before the first step.
    ///
    /// This test demands the last digits: a full step that repeats with the same matrix is followed by refinement. If
    /// the step size rule finds no step along (21), the exact derivative (20) is tried. If neither helps, the
    /// iteration has stalled.
    Measured {
        /// The tolerance of the error measure.
        tolerance: f64,
        /// The error measure.
        error: Measure<'a>,
    },
}

impl StopCriterion<'_> {
    /// Returns the error at `z + rest`, if it is measured.
    pub(super) fn measure(&mut self, z: &[f64], rest: &[f64]) -> Result<Option<f64>, LinearError> {
        match self {
            StopCriterion::Merit(_) => Ok(None),
            StopCriterion::Measured { error, .. } => error(z, rest).map(Some),
        }
    }

    /// Returns `true` if the start is a solution already. The paper's test applies only after a step.
    pub(super) fn met_at_start(&self, measured: Option<f64>) -> bool {
        self.met(f64::INFINITY, measured)
    }

    /// Returns `true` if the iterate with the merit `theta` and this error is a solution.
    pub(super) fn met(&self, theta: f64, measured: Option<f64>) -> bool {
        match self {
            StopCriterion::Merit(epsilon) => theta <= *epsilon,
            StopCriterion::Measured { tolerance, .. } => measured.is_some_and(|error| error <= *tolerance),
        }
    }

    /// Returns `true` if the last digits are needed.
    pub(super) fn is_measured(&self) -> bool {
        matches!(self, StopCriterion::Measured { .. })
    }
}
