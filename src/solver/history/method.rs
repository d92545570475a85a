//! The algorithm for one increment, by name and constants.

use super::events::{ExactPathSettings, follow_exact_path};
use super::record::Observer;
use super::settings::{HistorySettings, MAX_ITERATIONS};
use super::system::{LinearAlgebra, SystemSolver};
use super::{Error, HistoryOutcome, run_with};
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::solver::formulation::Partition;

/// The default tolerance of the error of every law. Rounding leaves far less.
const TOLERANCE: f64 = 1e-10;

/// The default tolerance of the paper's interior point method, whose stop at an absolute `Theta` leaves errors of up
/// to 1e-7 on the paper's problems.
const PAPER_IP_TOLERANCE: f64 = 1e-6;

/// The algorithm for one increment, with its constants and conventions: defaults without tuning, or those behind the
/// tables of Christensen, Klarbring, Pang and Strömberg (1998).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The B-differentiable Newton method without tuning.
    Bn {
        /// The factor on `r`, which comes from the problem; 1 except for studies of `r`.
        r_factor: f64,
        /// `true` if the interior point method takes over increments that BN does not solve.
        rescue: bool,
    },
    /// The B-differentiable Newton method with the constants of the paper.
    PaperBn,
    /// The predictor–corrector interior point method, without tuning.
    Ip,
    /// The potential reduction interior point method with the constants and starting points of the paper.
    PaperIp {
        /// The starting point of an increment.
        start: Start,
        /// The rows that stay positive.
        partition: Partition,
    },
}

/// The starting point of the paper's interior point method in the increments after the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// A point away from the border: `u` and `p_t` of the last solution, and the positive unknowns uniform, a tenth
    /// of their largest values there.
    Safe,
    /// The last solution, and the safe point if that fails.
    Prev {
        /// The step below which the search gives up.
        shortest_step: f64,
        /// `σ_{k+1} / σ_k` far from the solution.
        far: f64,
        /// The number of iterations after which the increment restarts from the safe point.
        patience: usize,
    },
}

impl Start {
    /// The paper's *prev* for the block: `σ` falls slowly, and the limit is 30 iterations.
    pub const PREV: Start = Start::Prev { shortest_step: 0.01, far: 0.95, patience: 30 };

    /// Removes the limits after which the method restarts from the safe point.
    #[must_use]
    pub fn patient(self) -> Self {
        match self {
            Start::Prev { shortest_step, far, .. } => Start::Prev { shortest_step, far, patience: usize::MAX },
            Start::Safe => Start::Safe,
        }
    }
}

impl Method {
    /// BN without tuning.
    pub const BN: Method = Method::Bn { r_factor: 1.0, rescue: true };

    /// Returns the paper's interior point method, with its products partition.
    pub fn paper_ip(start: Start) -> Self {
        Method::PaperIp { start, partition: Partition::Products }
    }

    /// Returns the name in scenes and reports: `bn` or `ip`.
    pub fn name(self) -> &'static str {
        if self.is_interior() { "ip" } else { "bn" }
    }

    /// Returns the name of the constants in scenes and reports: `paper` or `default`.
    pub fn setting(self) -> &'static str {
        if self.is_of_paper() { "paper" } else { "default" }
    }

    /// Returns `true` if it is an interior point method.
    pub fn is_interior(self) -> bool {
        matches!(self, Method::Ip | Method::PaperIp { .. })
    }

    /// Returns `true` if it has the constants of the paper, which need moduli near 2e11 Pa and the weights of the
    /// contact nodes.
    pub fn is_of_paper(self) -> bool {
        matches!(self, Method::PaperBn | Method::PaperIp { .. })
    }

    /// Returns the default tolerance of the error of every law.
    pub fn default_tolerance(self) -> f64 {
        if let Method::PaperIp { .. } = self { PAPER_IP_TOLERANCE } else { TOLERANCE }
    }
}

impl Default for Method {
    fn default() -> Self {
        Method::BN
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.name(), self.setting())
    }
}

/// The method of a whole history: increments, or the exact path in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HistoryMethod {
    /// Increments, each solved by this algorithm.
    Increments(Method),
    /// The exact path in time, see [`follow_exact_path`].
    ExactPath {
        /// As [`ExactPathSettings::jump`].
        jump: bool,
    },
}

impl HistoryMethod {
    /// The exact path in time, without jumps.
    pub const EVENTS: HistoryMethod = HistoryMethod::ExactPath { jump: false };

    /// Returns the algorithm of the increments. For an exact path it is BN, which solves the increment of a jump.
    pub fn increments(self) -> Method {
        match self {
            HistoryMethod::Increments(method) => method,
            HistoryMethod::ExactPath { .. } => Method::BN,
        }
    }

    /// Returns `true` for the exact path in time.
    pub fn is_exact_path(self) -> bool {
        matches!(self, HistoryMethod::ExactPath { .. })
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
    /// The linear solver; `None` lets [`crate::run::Choice`] choose.
    pub linear: Option<LinearAlgebra>,
    /// The limit of iterations in an increment.
    pub max_iterations: usize,
    /// The tolerance. An increment has converged if every component of the error measure is at most this.
    pub tolerance: f64,
}

impl SolverChoice {
    /// The default limit of iterations in an increment.
    pub const MAX_ITERATIONS: usize = MAX_ITERATIONS;

    /// Creates a choice of `method` with its default tolerance and limit, and this build's linear solver on the
    /// uncondensed system.
    pub fn new(method: impl Into<HistoryMethod>) -> Self {
        let method = method.into();
        SolverChoice {
            method,
            linear: Some(LinearAlgebra::default()),
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
            HistoryMethod::ExactPath { jump } => {
                let settings = ExactPathSettings { jump, increments: settings.clone() };
                follow_exact_path(problem, loading, times, &settings, system, observer)
            }
        }
    }
}

impl Default for SolverChoice {
    fn default() -> Self {
        SolverChoice::new(Method::BN)
    }
}
