//! Solvers for the equations of one increment, each reading like the algorithm it is.

mod armijo;
mod bn;
mod clock;
mod cycle;
mod end;
mod ip;
mod predictor_corrector;

pub use armijo::Armijo;
pub use bn::Bn;
pub use end::{Measure, StopCriterion};
pub use ip::{Centring, Ip, IpSettings};
pub use predictor_corrector::{PredictorCorrector, PredictorCorrectorSettings};

use crate::algebra::linear::LinearError;
use crate::algebra::sparse::SystemMatrix;
use crate::base::units::Scaling;
use crate::solver::formulation::Layout;
use std::ops::ControlFlow;

/// How the iteration of one increment ended, by the solver's own stop test.
#[derive(Debug, Clone, PartialEq)]
pub enum Termination {
    /// The stop test was met.
    Converged,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The limit of iterations was reached, and half of them went through the same sets of contact
    /// cases again.
    Cycling,
    /// The merit or the iterate is not finite.
    Diverged,
    /// No step along the direction improves the iterate.
    Stalled,
    /// The contact statuses leave the free motion with these weights free, and there is no solution along it.
    Unconstrained(Vec<f64>),
    /// No equilibrium exists: the loads drive the free motion with these weights.
    NoEquilibrium(Vec<f64>),
    /// The loads drive the free motion with these weights; only friction that the equations leave out, across the edge
    /// between two obstacles, resists it.
    EdgeFriction(Vec<f64>),
    /// The linearisation is singular for another reason.
    Singular(LinearError),
    /// The observer asked to stop.
    Interrupted,
}

impl Termination {
    /// The end that a linear solve makes: a singular matrix is a verdict, anything else an error.
    fn at(error: LinearError) -> Result<Self, LinearError> {
        match error {
            LinearError::Singular { .. } | LinearError::NotFinite => Ok(Termination::Singular(error)),
            error => Err(error),
        }
    }
}

/// What the solver did in one increment.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResult {
    /// How it ended.
    pub stop: Termination,
    /// Linear systems solved, the paper's nle.
    pub iterations: usize,
    /// Steps shortened, over all iterations.
    pub backtracks: usize,
    /// The last merit `Theta`.
    pub theta: f64,
    /// The largest backward error of the linear solves.
    pub backward_error: f64,
    /// Seconds spent in evaluating residual, merit and Jacobian.
    pub assembly_seconds: f64,
    /// Whether the method left it to another one, which solved it.
    pub rescued: bool,
}

impl MethodResult {
    /// Nothing done yet, from a start with the merit `theta`.
    pub fn new(theta: f64) -> Self {
        MethodResult {
            stop: Termination::MaxIterations,
            iterations: 0,
            backtracks: 0,
            theta,
            backward_error: 0.0,
            assembly_seconds: 0.0,
            rescued: false,
        }
    }

    /// Adds an iteration.
    fn add(&mut self, theta: f64, backtracks: usize, backward_error: f64) {
        self.iterations += 1;
        self.backtracks += backtracks;
        self.theta = theta;
        self.backward_error = self.backward_error.max(backward_error);
    }

    /// Whether the iteration ends here, and why: the stop test is `met`, the numbers are not finite, or
    /// the observer wants no more.
    fn ends(&mut self, met: bool, flow: ControlFlow<()>) -> bool {
        self.stop = if met {
            Termination::Converged
        } else if !self.theta.is_finite() {
            Termination::Diverged
        } else if flow.is_break() {
            Termination::Interrupted
        } else {
            return false;
        };
        true
    }

    /// This and then `next`, as one.
    #[must_use]
    pub fn then(self, next: MethodResult) -> MethodResult {
        MethodResult {
            stop: next.stop,
            iterations: self.iterations + next.iterations,
            backtracks: self.backtracks + next.backtracks,
            theta: next.theta,
            backward_error: self.backward_error.max(next.backward_error),
            assembly_seconds: self.assembly_seconds + next.assembly_seconds,
            rescued: self.rescued || next.rescued,
        }
    }
}

/// One iteration, as it happens.
#[derive(Debug, Clone, Copy)]
pub struct Iteration<'a> {
    /// Its record.
    pub record: IterationRecord,
    /// The linear system that gave the step; there is none at the start.
    pub system: Option<LinearSystem<'a>>,
}

/// The linearised equations of an iteration, as they were solved: `matrix · solution = rhs`.
///
/// The unknowns begin with `(u, p_t, p_o, p_n)` in the order of `layout`, forces and displacements in the units of
/// `scaling`. Rows of contact are scaled or combined where that keeps them well conditioned; the solution is that of
/// (22), or of (14) with what is eliminated left out.
#[derive(Debug, Clone, Copy)]
pub struct LinearSystem<'a> {
    /// The matrix.
    pub matrix: &'a SystemMatrix,
    /// The right-hand side.
    pub rhs: &'a [f64],
    /// The direction `dz`, before it is multiplied by the step size.
    pub solution: &'a [f64],
    /// Which unknowns there are, and where they stand.
    pub layout: &'a Layout,
    /// The units of the unknowns.
    pub scaling: Scaling,
}

impl Iteration<'_> {
    /// The start, before any iteration.
    fn start(theta: f64, error: Option<f64>) -> Self {
        Iteration { record: IterationRecord { error, ..IterationRecord::start(theta) }, system: None }
    }
}

/// What is recorded of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationRecord {
    /// Its number in the increment, from 1; 0 stands for the start.
    pub iteration: usize,
    /// `Theta` after the step.
    pub theta: f64,
    /// The step length taken.
    pub step: f64,
    /// Steps shortened.
    pub backtracks: usize,
    /// Componentwise backward error of the linear solve.
    pub backward_error: f64,
    /// Whether the matrix was factored; not when it is that of the last iteration.
    pub factored: bool,
    /// The error measure after the step, where the method has evaluated it: the settings `default`
    /// end by it.
    pub error: Option<f64>,
}

impl IterationRecord {
    /// The start, before any iteration.
    pub(crate) fn start(theta: f64) -> Self {
        IterationRecord {
            iteration: 0,
            theta,
            step: 0.0,
            backtracks: 0,
            backward_error: 0.0,
            factored: false,
            error: None,
        }
    }
}
