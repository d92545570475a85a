//! How a history is solved.

use crate::formulation::Conventions;
use crate::nonlinear::{BnSettings, IpSettings, PredictorCorrectorSettings};
use crate::problem::ContactProblem;
use crate::scene::{NewtonSystem, Partition};
use crate::units::Scaling;

/// How a history is solved.
#[derive(Debug, Clone, PartialEq)]
pub struct HistorySettings {
    /// The algorithm and its constants.
    pub method: Method,
    /// `r_i` of `H_N`, and the units in which `Theta` adds its rows.
    pub conventions: Conventions,
    /// [`ContactProblem::contact_stiffness`] of the body, n_c, N/m, for all that starts or ends by it.
    pub contact_stiffness: Vec<f64>,
    /// The units of the numbers inside.
    pub scaling: Scaling,
    /// An increment has converged when every component of its error measure is at most this.
    pub tolerance: f64,
    /// How many times an increment that fails may be halved. The parts are increments of their own.
    pub halvings: u32,
}

/// The algorithm of the increments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// The B-differentiable Newton method.
    Bn {
        /// Its constants.
        settings: BnSettings,
        /// The contact forces from which the first increment starts. A guess: it has no part in the
        /// solution.
        start: FirstGuess,
        /// If given, the increments that BN does not solve within the settings' iterations are
        /// solved by the predictor–corrector interior point method.
        rescue: Option<PredictorCorrectorSettings>,
    },
    /// The potential reduction interior point method, with the paper's starting points.
    Ip {
        /// Its constants.
        settings: IpSettings,
        /// Where an increment starts.
        start: Start,
        /// Which rows stay positive.
        partition: Partition,
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
    /// The predictor–corrector interior point method.
    PredictorCorrector {
        /// Its constants.
        settings: PredictorCorrectorSettings,
        /// The linear system of a direction.
        newton: NewtonSystem,
    },
}

impl Method {
    /// Whether it solves problems in which a node has two tangents.
    pub(super) fn knows_two_tangents(&self) -> bool {
        match self {
            Method::Bn { .. } => true,
            Method::Ip { .. } => false,
            Method::PredictorCorrector { newton, .. } => *newton == NewtonSystem::Reduced,
        }
    }
}

/// The contact forces from which BN starts its first increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FirstGuess {
    /// The same normal stress (Pa) in every contact node.
    Pressure(f64),
    /// Those that would hold the contact nodes where they are.
    Held,
}

/// After so many iterations BN leaves an increment to the interior point method: more than any
/// increment of the tests takes that it solves at all.
const BN_PATIENCE: usize = 40;

/// An increment may become 64 parts: an order of magnitude and a half, after which a history that
/// cannot go on is told from one that was too coarse.
const HALVINGS: u32 = 6;

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

impl HistorySettings {
    /// BN as in the paper: `p_n = 1 MPa · l` to start from, 10 MPa from 100 contact nodes on.
    pub fn paper_bn(problem: &ContactProblem, scaling: Scaling, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings {
            method: Method::Bn {
                settings: BnSettings::paper(max_iterations),
                start: FirstGuess::Pressure(if problem.contacts() < 100 { 1e6 } else { 1e7 }),
                rescue: None,
            },
            conventions: Conventions::paper(problem),
            contact_stiffness: problem.contact_stiffness(),
            scaling,
            tolerance,
            halvings: 0,
        }
    }

    /// BN without a number to guess.
    pub fn bn(problem: &ContactProblem, scaling: Scaling, max_iterations: usize, tolerance: f64) -> Self {
        let contact_stiffness = problem.contact_stiffness();
        HistorySettings {
            method: Method::Bn {
                settings: BnSettings::until(tolerance, max_iterations.min(BN_PATIENCE)),
                start: FirstGuess::Held,
                rescue: Some(PredictorCorrectorSettings { tolerance, max_iterations }),
            },
            conventions: Conventions::of_stiffness(problem, &contact_stiffness),
            contact_stiffness,
            scaling,
            tolerance,
            halvings: HALVINGS,
        }
    }

    /// IP without a number to guess: the predictor–corrector method.
    pub fn ip(problem: &ContactProblem, scaling: Scaling, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings {
            method: Method::PredictorCorrector {
                settings: PredictorCorrectorSettings { tolerance, max_iterations },
                newton: NewtonSystem::Reduced,
            },
            conventions: Conventions::paper(problem),
            contact_stiffness: problem.contact_stiffness(),
            scaling,
            tolerance,
            halvings: HALVINGS,
        }
    }

    /// IP as in the paper: forces in MN and displacements in 10⁻⁵ m, the partition (F̃, G̃).
    pub fn paper_ip(problem: &ContactProblem, start: Start, max_iterations: usize, tolerance: f64) -> Self {
        HistorySettings {
            method: Method::Ip {
                settings: IpSettings::paper(max_iterations),
                start,
                partition: Partition::Products,
                newton: NewtonSystem::Reduced,
            },
            conventions: Conventions::paper(problem),
            contact_stiffness: problem.contact_stiffness(),
            scaling: Scaling { force: 1e6, length: 1e-5 },
            tolerance,
            halvings: 0,
        }
    }
}
