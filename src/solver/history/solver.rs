//! What solves a history, as far as somebody chooses it.

use super::settings::{self, HistorySettings};
use super::{Error, LinearAlgebra, Method};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// What solves a history, as far as somebody chooses it; the rest, [`HistorySettings`], follows from the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverChoice {
    /// The algorithm with its named set of constants.
    pub method: Method,
    /// The linear algebra; `None` leaves it to [`crate::run::auto`].
    pub linear: Option<LinearAlgebra>,
    /// The most iterations an increment may take.
    pub max_iterations: usize,
    /// An increment has converged when every component of the error measure is at most this.
    pub tolerance: f64,
}

impl SolverChoice {
    /// The most iterations of an increment where nobody says otherwise.
    pub const MAX_ITERATIONS: usize = settings::MAX_ITERATIONS;

    /// `method` with its default tolerance and limit, and the linear algebra of this build on the uncondensed system.
    pub fn new(method: Method) -> Self {
        SolverChoice {
            method,
            linear: Some(LinearAlgebra::default()),
            max_iterations: Self::MAX_ITERATIONS,
            tolerance: method.default_tolerance(),
        }
    }

    /// The settings of a history of `problem` under `loading`.
    ///
    /// # Errors
    /// As [`HistorySettings::new`].
    pub fn settings(&self, problem: &ContactProblem, loading: &Loading) -> Result<HistorySettings, Error> {
        Ok(HistorySettings::new(problem, loading, self.method)?.until(self.max_iterations, self.tolerance))
    }
}

impl Default for SolverChoice {
    fn default() -> Self {
        SolverChoice::new(Method::BN)
    }
}
