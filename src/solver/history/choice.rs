//! The choices of a user about the solver.

use super::events::follow_exact_path;
use super::method::Method;
use super::record::Observer;
use super::settings::{HistorySettings, MAX_ITERATIONS};
use super::system::{LinearAlgebra, SystemSolver};
use super::{Error, HistoryOutcome, run_with};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;

/// The method of a whole history: increments, or the exact path in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HistoryMethod {
    /// Increments, each solved by this algorithm.
    Increments(Method),
    /// The exact path in time, see [`follow_exact_path`].
    ExactPath,
}

impl HistoryMethod {
    /// Returns the algorithm of the increments. For an exact path it is BN, of which it has the settings.
    pub fn increments(self) -> Method {
        match self {
            HistoryMethod::Increments(method) => method,
            HistoryMethod::ExactPath => Method::BN,
        }
    }

    /// Returns `true` for the exact path in time.
    pub fn is_exact_path(self) -> bool {
        matches!(self, HistoryMethod::ExactPath)
    }

    /// Returns the name in scenes and reports: `bn`, `ip` or `events`.
    pub fn name(self) -> &'static str {
        if self.is_exact_path() { "events" } else { self.increments().name() }
    }

    /// Returns the name of the constants in scenes and reports: `paper` or `default`.
    pub fn setting(self) -> &'static str {
        self.increments().setting()
    }
}

impl From<Method> for HistoryMethod {
    fn from(method: Method) -> Self {
        HistoryMethod::Increments(method)
    }
}

/// The choices of a user about the solver. The [`HistorySettings`] follow from them and from the problem.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverChoice {
    /// The method of the history, with its named set of constants.
    pub method: HistoryMethod,
    /// The linear solver; `None` leaves it to [`crate::run::Choice`].
    pub linear: Option<LinearAlgebra>,
    /// The limit of iterations in an increment.
    pub max_iterations: usize,
    /// The tolerance. An increment has converged if every component of the error measure is at most this.
    pub tolerance: f64,
}

impl SolverChoice {
    /// The default limit of iterations in an increment.
    pub const MAX_ITERATIONS: usize = MAX_ITERATIONS;

    /// Creates a choice of `method` with its default tolerance and limit, which leaves the linear solver open.
    pub fn new(method: impl Into<HistoryMethod>) -> Self {
        let method = method.into();
        SolverChoice {
            method,
            linear: None,
            max_iterations: Self::MAX_ITERATIONS,
            tolerance: method.increments().default_tolerance(),
        }
    }

    /// Returns the settings of the increments of a history of `problem` under `loading`.
    ///
    /// # Errors
    /// As [`HistorySettings::new`].
    pub fn settings(&self, problem: &ContactProblem, loading: &Loading) -> Result<HistorySettings, Error> {
        let settings = HistorySettings::new(problem, loading, self.method.increments())?;
        Ok(settings.until(self.max_iterations, self.tolerance))
    }

    /// Solves a history with the chosen method, where [`SolverChoice::settings`] made the `settings`.
    ///
    /// # Errors
    /// As [`super::run`].
    pub fn solve(
        &self,
        problem: &ContactProblem,
        loading: &Loading,
        times: &[f64],
        settings: &HistorySettings,
        system: SystemSolver,
        observer: &mut dyn Observer,
    ) -> Result<HistoryOutcome, Error> {
        match self.method {
            HistoryMethod::Increments(_) => run_with(problem, loading, times, settings, settings, system, observer),
            HistoryMethod::ExactPath => follow_exact_path(problem, loading, times, settings, system, observer),
        }
    }
}

impl Default for SolverChoice {
    fn default() -> Self {
        SolverChoice::new(Method::BN)
    }
}
