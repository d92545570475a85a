//! The best forces of a search, by the independent measure.

use super::LocalProblem;
use super::errors::measure;
use super::scaled::ScaledContacts;

/// The measure for the forces `r'` of a scaled problem, with the best forces so far.
pub(super) struct Judge<'a> {
    problem: &'a LocalProblem,
    scaled: &'a ScaledContacts,
    tolerance: f64,
    best: Vec<f64>,
    error: f64,
}

impl<'a> Judge<'a> {
    /// Begins with zero forces.
    pub(super) fn new(problem: &'a LocalProblem, scaled: &'a ScaledContacts, tolerance: f64) -> Self {
        let best = vec![0.0; problem.q().len()];
        let error = measure(problem, &best).natural_map;
        Judge { problem, scaled, tolerance, best, error }
    }

    /// Returns the natural map of `r'`, which is kept if it is the best so far.
    pub(super) fn offer(&mut self, r: &[f64]) -> f64 {
        let whole = self.scaled.write(r);
        let error = measure(self.problem, &whole).natural_map;
        if error < self.error {
            (self.best, self.error) = (whole, error);
        }
        error
    }

    /// Returns the scaled problem.
    pub(super) fn scaled(&self) -> &'a ScaledContacts {
        self.scaled
    }

    /// Returns `true` if the best forces are a solution.
    pub(super) fn solved(&self) -> bool {
        self.error <= self.tolerance
    }

    /// Returns the natural map of the best forces.
    pub(super) fn error(&self) -> f64 {
        self.error
    }

    /// Returns the best forces, `r'`.
    pub(super) fn best(&self) -> Vec<f64> {
        self.scaled.read(&self.best)
    }

    /// Returns the best forces, in the units of the problem.
    pub(super) fn into_forces(self) -> Vec<f64> {
        self.best
    }
}
