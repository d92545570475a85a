//! The algorithm for one increment, by name and constants.

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
