//! The algorithm for one increment, by name and constants.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::solver::formulation::{NewtonSystem, Partition};

/// The error of every law that is allowed where nobody says otherwise; rounding leaves far less.
const TOLERANCE: f64 = 1e-10;

/// The paper's interior point method ends at an absolute `Theta`, which leaves errors of up to
/// 1e-7 on the paper's problems.
const PAPER_IP_TOLERANCE: f64 = 1e-6;

/// The algorithm for one increment, with the constants and conventions that go with it: without a number to guess, or
/// those behind the tables of Christensen, Klarbring, Pang and Strömberg (1998).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    /// No increments but the exact path in time, from event to event; where nodes slide along lines, as in the plane.
    Events {
        /// Whether a path that is lost goes on with a jump, to one of the states that the laws of an increment allow.
        jump: bool,
    },
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

/// Where the paper's interior point method starts the increments after the first.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    /// The exact path in time, without jumps.
    pub const EVENTS: Method = Method::Events { jump: false };

    /// BN without a number to guess.
    pub const BN: Method = Method::Bn { r_factor: 1.0, rescue: true };

    /// The interior point method without a number to guess.
    pub const IP: Method = Method::Ip { newton: NewtonSystem::Reduced };

    /// The paper's interior point method, with its products partition and reduced system.
    pub fn paper_ip(start: Start) -> Self {
        Method::PaperIp { start, partition: Partition::Products, newton: NewtonSystem::Reduced }
    }

    /// `bn`, `ip` or `events`, as scenes and reports call it.
    pub fn name(self) -> &'static str {
        match self {
            Method::Events { .. } => "events",
            _ if self.is_interior() => "ip",
            _ => "bn",
        }
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
