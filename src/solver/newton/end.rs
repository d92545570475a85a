//! When Algorithm BN ends.

/// A measure of how far `z + rest` is from the exact law, where `rest` is what rounding leaves off `z`.
pub type Measure<'a> = &'a mut dyn FnMut(&[f64], &[f64]) -> f64;

/// When Algorithm BN ends.
pub enum StopCriterion<'a> {
    /// `Theta ≤ ε` after a step, in the unit of the formulation's `Theta`: the paper's test.
    Merit(f64),
    /// The caller's error measure is at most the tolerance, be it before the first step.
    ///
    /// Whoever measures wants the last digits: a full step that repeats with the same matrix is followed by refinement,
    /// and where the step size rule finds no step along (21), the exact derivative (20) is tried. What neither helps
    /// has stalled.
    Measured {
        /// The error that is allowed.
        tolerance: f64,
        /// The error measure.
        error: Measure<'a>,
    },
}

impl StopCriterion<'_> {
    /// The error at `z + rest`, where it is measured.
    pub(super) fn measure(&mut self, z: &[f64], rest: &[f64]) -> Option<f64> {
        match self {
            StopCriterion::Merit(_) => None,
            StopCriterion::Measured { error, .. } => Some(error(z, rest)),
        }
    }

    /// Whether the start is a solution already; the paper's test runs after a step only.
    pub(super) fn met_at_start(&self, measured: Option<f64>) -> bool {
        self.met(f64::INFINITY, measured)
    }

    /// Whether the iterate with the merit `theta` and this error is a solution.
    pub(super) fn met(&self, theta: f64, measured: Option<f64>) -> bool {
        match self {
            StopCriterion::Merit(epsilon) => theta <= *epsilon,
            StopCriterion::Measured { tolerance, .. } => measured.is_some_and(|error| error <= *tolerance),
        }
    }

    /// Whether the last digits are wanted.
    pub(super) fn is_measured(&self) -> bool {
        matches!(self, StopCriterion::Measured { .. })
    }
}
