//! How a scene is to be solved.

use std::fmt;

use serde::{Deserialize, Serialize};

/// How to solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// The algorithm with its named set of constants.
    pub method: Method,
    /// The linear algebra; `None` leaves it to [`crate::auto`].
    pub linear: Option<LinearBackend>,
    /// The most iterations an increment may take.
    pub max_iterations: usize,
    /// An increment has converged when every component of the error measure is at most this.
    pub tolerance: f64,
}

/// The algorithm for one increment, with a named set of constants and conventions. The setting
/// `paper` has those behind the tables of Christensen, Klarbring, Pang and Strömberg (1998).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// `bn`, setting `default`: the B-differentiable Newton method without a number to guess.
    Bn {
        /// What `r`, which comes from the problem, is multiplied by: 1 but for studies of it.
        r_factor: f64,
    },
    /// `bn`, setting `paper`: the B-differentiable Newton method.
    PaperBn,
    /// `ip`, setting `paper`: the potential reduction interior point method.
    PaperIp {
        /// Where an increment starts.
        start: Start,
        /// Which equations stay positive.
        partition: Partition,
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
    /// `ip`, setting `default`: the predictor–corrector interior point method.
    Ip {
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
}

/// The name of an algorithm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum MethodName {
    /// The B-differentiable Newton method.
    #[default]
    Bn,
    /// The interior point method.
    Ip,
}

/// The name of a set of constants and conventions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Setting {
    /// Those behind the tables of the paper.
    Paper,
    /// Those that come from the problem itself.
    Default,
}

/// Where the paper's interior point method starts an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Start {
    /// Away from the border.
    #[default]
    Safe,
    /// At the last solution; away from the border after 30 iterations.
    Prev,
}

/// Which equations of the constrained equation formulation stay positive, besides the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Partition {
    /// The products, `(F̃, G̃)` (29)–(31).
    #[default]
    Products,
    /// The products and the friction cone, `(F, G)` (26)–(28).
    Cone,
}

/// The linear system behind a direction of the interior point method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NewtonSystem {
    /// Slacks and multipliers eliminated row by row: the unknowns `(u, p_t, p_n)`.
    #[default]
    Reduced,
    /// All unknowns, `(u, p_t, p_n, v_n, s, λ)`.
    Extended,
}

impl Method {
    /// The algorithm with its named constants, and the default of all else.
    pub fn of(name: MethodName, setting: Setting) -> Self {
        match (name, setting) {
            (MethodName::Bn, Setting::Default) => Method::Bn { r_factor: 1.0 },
            (MethodName::Bn, Setting::Paper) => Method::PaperBn,
            (MethodName::Ip, Setting::Default) => Method::Ip { newton: NewtonSystem::default() },
            (MethodName::Ip, Setting::Paper) => Method::PaperIp {
                start: Start::default(),
                partition: Partition::default(),
                newton: NewtonSystem::default(),
            },
        }
    }

    /// The name of the algorithm.
    pub fn name(self) -> MethodName {
        match self {
            Method::Bn { .. } | Method::PaperBn => MethodName::Bn,
            Method::PaperIp { .. } | Method::Ip { .. } => MethodName::Ip,
        }
    }

    /// The name of its constants.
    pub fn setting(self) -> Setting {
        match self {
            Method::PaperBn | Method::PaperIp { .. } => Setting::Paper,
            Method::Bn { .. } | Method::Ip { .. } => Setting::Default,
        }
    }
}

/// The linear algebra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum LinearBackend {
    /// UMFPACK on the uncondensed system.
    Umfpack,
    /// faer's sparse LU on the uncondensed system: no library but Rust's, slower on large meshes.
    Faer,
    /// Static condensation: what no contact touches is eliminated once a run.
    Condensed,
}

/// What a scene may say about the linear algebra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum LinearName {
    Umfpack,
    Faer,
    Condensed,
    Auto,
}

impl LinearName {
    /// The one it stands for, unless that is to be found out.
    pub(super) fn backend(self) -> Option<LinearBackend> {
        match self {
            LinearName::Umfpack => Some(LinearBackend::Umfpack),
            LinearName::Faer => Some(LinearBackend::Faer),
            LinearName::Condensed => Some(LinearBackend::Condensed),
            LinearName::Auto => None,
        }
    }
}

impl Default for LinearBackend {
    /// UMFPACK where it is built in, otherwise faer.
    fn default() -> Self {
        if cfg!(feature = "umfpack") { LinearBackend::Umfpack } else { LinearBackend::Faer }
    }
}

impl LinearBackend {
    /// Whether this build has it, which the cargo features decide.
    pub fn is_built_in(self) -> bool {
        match self {
            LinearBackend::Umfpack => cfg!(feature = "umfpack"),
            LinearBackend::Faer => cfg!(feature = "faer"),
            LinearBackend::Condensed => cfg!(any(feature = "umfpack", feature = "faer")),
        }
    }
}

impl fmt::Display for MethodName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            MethodName::Bn => "bn",
            MethodName::Ip => "ip",
        })
    }
}

impl fmt::Display for LinearBackend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            LinearBackend::Umfpack => "umfpack",
            LinearBackend::Faer => "faer",
            LinearBackend::Condensed => "condensed",
        })
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Setting::Paper => "paper",
            Setting::Default => "default",
        })
    }
}
