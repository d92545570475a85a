//! How a history is solved.

use std::fmt;

use super::{Error, Solver};
use crate::formulation::{Conventions, NewtonSystem, Partition};
use crate::loading::Loading;
use crate::problem::{ContactProblem, ProblemError};
use crate::units::Scaling;

/// How a history is solved: what the problem and its loading tell of it, and the choice of a method.
#[derive(Debug, Clone, PartialEq)]
pub struct HistorySettings {
    /// The algorithm of the increments.
    pub method: Method,
    /// `r_i` of `H_N`, and the units in which `Theta` adds its rows.
    pub conventions: Conventions,
    /// [`ContactProblem::contact_stiffness`] of the body, n_c, N/m, for all that starts or ends by it.
    pub contact_stiffness: Vec<f64>,
    /// The units of the numbers inside.
    pub scaling: Scaling,
    /// An increment has converged when every component of its error measure is at most this, in (0, 1).
    pub tolerance: f64,
    /// The limit of iterations in an increment, 1 or more.
    pub max_iterations: usize,
    /// How many times an increment that fails may be halved. The parts are increments of their own.
    pub halvings: u32,
}

/// The algorithm for one increment, with the constants and conventions that go with it: without a number to guess, or
/// those behind the tables of Christensen, Klarbring, Pang and Strömberg (1998).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The B-differentiable Newton method without a number to guess.
    Bn {
        /// What `r`, which comes from the problem, is multiplied by: 1 but for studies of it.
        r_factor: f64,
        /// Whether the increments that it does not solve are left to the interior point method.
        rescue: bool,
    },
    /// The B-differentiable Newton method with the constants of the paper.
    PaperBn,
    /// The predictor–corrector interior point method, without a number to guess.
    Ip {
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
    /// The potential reduction interior point method with the constants and starting points of the paper.
    PaperIp {
        /// Where an increment starts.
        start: Start,
        /// Which rows stay positive.
        partition: Partition,
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
}

/// The contact forces from which BN starts its first increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FirstGuess {
    /// The same normal stress (Pa) in every contact node.
    Pressure(f64),
    /// Those that would hold the contact nodes where they are.
    Held,
}

/// An increment may become 64 parts: an order of magnitude and a half, after which a history that
/// cannot go on is told from one that was too coarse.
const HALVINGS: u32 = 6;

/// The error of every law that is allowed where nobody says otherwise; rounding leaves far less.
const TOLERANCE: f64 = 1e-10;

/// The paper's interior point method ends at an absolute `Theta`, which leaves errors of up to
/// 1e-7 on the paper's problems.
const PAPER_IP_TOLERANCE: f64 = 1e-6;

/// Where the paper's interior point method starts the increments after the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Start {
    /// Away from the border: `u` and `p_t` of the last solution, the positive unknowns uniform, a
    /// tenth of their largest values there.
    Safe,
    /// At the last solution; from the safe point if that fails.
    Prev {
        /// The search gives up below this step.
        shortest_step: f64,
        /// `σ_{k+1} / σ_k` far from the solution.
        far: f64,
        /// After so many iterations the increment begins again from the safe point.
        patience: usize,
    },
}

impl Start {
    /// The paper's *prev* for the block: `σ` falls slowly, and 30 iterations must do.
    pub const PREV: Start = Start::Prev { shortest_step: 0.01, far: 0.95, patience: 30 };

    /// The same without giving up.
    #[must_use]
    pub fn patient(self) -> Self {
        match self {
            Start::Prev { shortest_step, far, .. } => Start::Prev { shortest_step, far, patience: usize::MAX },
            Start::Safe => Start::Safe,
        }
    }
}

impl Method {
    /// BN without a number to guess.
    pub const BN: Method = Method::Bn { r_factor: 1.0, rescue: true };

    /// The interior point method without a number to guess.
    pub const IP: Method = Method::Ip { newton: NewtonSystem::Reduced };

    /// The paper's interior point method, with its products partition and reduced system.
    pub fn paper_ip(start: Start) -> Self {
        Method::PaperIp { start, partition: Partition::Products, newton: NewtonSystem::Reduced }
    }

    /// `bn` or `ip`, as scenes and reports call it.
    pub fn name(self) -> &'static str {
        if self.is_interior() { "ip" } else { "bn" }
    }

    /// `paper` or `default`, as scenes and reports call its constants.
    pub fn setting(self) -> &'static str {
        if self.is_of_paper() { "paper" } else { "default" }
    }

    /// Whether it is an interior point method.
    pub fn is_interior(self) -> bool {
        matches!(self, Method::Ip { .. } | Method::PaperIp { .. })
    }

    /// Whether it has the constants of the paper, which want moduli near 2e11 Pa and the weights of the contact nodes.
    pub fn is_of_paper(self) -> bool {
        matches!(self, Method::PaperBn | Method::PaperIp { .. })
    }

    /// The error of every law that is allowed where nobody says otherwise.
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

impl HistorySettings {
    /// What a history of `problem` under `loading` asks for: units near its stiffness and its displacements, `r` from the
    /// stiffness of its contact nodes, the default tolerance and limit of iterations of `method`.
    ///
    /// # Errors
    /// [`Error::NoWeight`] when `method` has the constants of the paper and the problem has no weights;
    /// [`Error::Problem`] when `loading` does not fit `problem`.
    pub fn new(problem: &ContactProblem, loading: &Loading, method: Method) -> Result<Self, Error> {
        loading.check(problem)?;
        let contact_stiffness = problem.contact_stiffness();
        let conventions = match method {
            Method::PaperBn | Method::PaperIp { .. } => {
                Conventions::paper(problem.weight().ok_or(Error::NoWeight { method })?)
            }
            Method::Bn { r_factor, .. } => {
                let mut conventions = Conventions::of_stiffness(problem, &contact_stiffness);
                conventions.scale_r(r_factor);
                conventions
            }
            Method::Ip { .. } => Conventions::of_stiffness(problem, &contact_stiffness),
        };
        let scaling = match method {
            // The numbers inside are the paper's: its starting points and constants are absolute.
            Method::PaperIp { .. } => Scaling { force: 1e6, length: 1e-5 },
            _ => problem.scaling(loading.largest_force(), loading.largest_interference()),
        };
        Ok(HistorySettings {
            method,
            conventions,
            contact_stiffness,
            scaling,
            tolerance: method.default_tolerance(),
            max_iterations: Solver::MAX_ITERATIONS,
            halvings: if method.is_of_paper() { 0 } else { HALVINGS },
        })
    }

    /// The same with another limit of iterations and another tolerance.
    #[must_use]
    pub fn until(self, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings { max_iterations, tolerance, ..self }
    }

    /// Whether they fit `problem`.
    pub(super) fn check(&self, problem: &ContactProblem) -> Result<(), Error> {
        let n_c = problem.contacts();
        let Conventions { r_n, r_t, row_unit, .. } = &self.conventions;
        let arrays =
            [("r_n", r_n), ("r_t", r_t), ("row_unit", row_unit), ("contact_stiffness", &self.contact_stiffness)];
        for (array, values) in arrays {
            crate::problem::error::expect_length(array, n_c, values.len(), "one for each contact node")?;
        }
        let value =
            |array: &str, value, must| Err(ProblemError::Value { array: array.to_string(), value, must }.into());
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return value("tolerance", self.tolerance, "above 0 and below 1");
        }
        if self.max_iterations == 0 {
            return value("max_iterations", 0.0, "1 or more");
        }
        Ok(())
    }
}
