//! The best forces of a search, by the independent measure.

use super::LocalProblem;
use super::errors::measure;
use super::scaled::ScaledContacts;

/// The measure for the forces `r'` of a scaled problem, with the best forces so far.
pub(super) struct Judge<'a> {
    problem: &'a LocalProblem,
    pub scaled: &'a ScaledContacts,
    tolerance: f64,
    /// The best forces, in the units of the problem.
    pub forces: Vec<f64>,
    /// The natural map of the best forces.
    pub error: f64,
}

impl<'a> Judge<'a> {
    /// Begins with zero forces.
    pub(super) fn new(problem: &'a LocalProblem, scaled: &'a ScaledContacts, tolerance: f64) -> Self {
        let forces = vec![0.0; problem.q().len()];
        let error = measure(problem, &forces, None).0.natural_map;
        Judge { problem, scaled, tolerance, forces, error }
    }

    /// Returns the natural map of `r'`, which is kept if it is the best so far.
    pub(super) fn offer(&mut self, r: &[f64]) -> f64 {
        let whole = self.scaled.write(r);
        let error = measure(self.problem, &whole, None).0.natural_map;
        if error < self.error {
            (self.forces, self.error) = (whole, error);
        }
        error
    }

    /// Returns `true` if the best forces are a solution.
    pub(super) fn is_solved(&self) -> bool {
        self.error <= self.tolerance
    }
}
