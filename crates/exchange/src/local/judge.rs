//! What a search has found so far, by the independent measure.

use super::LocalProblem;
use super::errors::measure;
use super::scaled::ScaledContacts;

/// The measure on the forces `r'` of a scaled problem, and the best forces that were seen.
pub(super) struct Judge<'a> {
    problem: &'a LocalProblem,
    scaled: &'a ScaledContacts,
    tolerance: f64,
    best: Vec<f64>,
    error: f64,
}

impl<'a> Judge<'a> {
    /// Nothing has been seen but no forces at all.
    pub(super) fn new(problem: &'a LocalProblem, scaled: &'a ScaledContacts, tolerance: f64) -> Self {
        let best = vec![0.0; problem.q().len()];
        let error = measure(problem, &best).natural_map;
        Judge { problem, scaled, tolerance, best, error }
    }

    /// The natural map of `r'`, which is kept if it is the least so far.
    pub(super) fn offer(&mut self, r: &[f64]) -> f64 {
        let whole = self.scaled.write(r);
        let error = measure(self.problem, &whole).natural_map;
        if error < self.error {
            (self.best, self.error) = (whole, error);
        }
        error
    }

    /// The problem in numbers of order one.
    pub(super) fn scaled(&self) -> &'a ScaledContacts {
        self.scaled
    }

    /// Whether the best forces are a solution.
    pub(super) fn solved(&self) -> bool {
        self.error <= self.tolerance
    }

    /// The natural map of the best forces.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// The best forces, `r'`.
    pub(super) fn best(&self) -> Vec<f64> {
        self.scaled.read(&self.best)
    }

    /// The best forces, in the units of the problem.
    pub(super) fn into_forces(self) -> Vec<f64> {
        self.best
    }
}
