//! Algorithms for the equations of one increment.

mod armijo;
mod bn;
mod ip;
mod predictor_corrector;

pub use armijo::Armijo;
pub use bn::{Bn, Measure, StopCriterion};
pub use ip::{Centring, Ip, IpSettings};
pub(crate) use predictor_corrector::PredictorCorrector;
use std::time::Instant;

use crate::algebra::linear::{Computed, LinearError, SystemMatrix};
use crate::base::units::Scaling;
use crate::solver::formulation::Layout;
use std::ops::ControlFlow;

/// The reason why the iteration of one increment ended, by the method's own stopping test.
#[derive(Debug, Clone, PartialEq)]
pub enum Termination {
    /// The stopping test was met.
    Converged,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The limit of iterations was reached, and in half of the iterations the sets of contact cases repeated.
    Cycling,
    /// The merit or the iterate is not finite.
    Diverged,
    /// No step along the direction improves the iterate.
    Stalled,
    /// The contact statuses leave the rigid mode with these weights unconstrained, and there is no solution along it.
    Unconstrained(Vec<f64>),
    /// No equilibrium exists: the loads drive the rigid mode with these weights.
    NoEquilibrium(Vec<f64>),
    /// The loads drive the rigid mode with these weights along the contact, against all friction that there is.
    Slips(Vec<f64>),
    /// The linearisation is singular for another reason.
    Singular(LinearError),
    /// The observer asked to stop.
    Interrupted,
}

impl Termination {
    /// Converts an error of a linear solve: a singular matrix gives a termination, anything else stays an error.
    fn at(error: LinearError) -> Computed<Self> {
        match error {
            LinearError::Singular { .. } | LinearError::NotFinite => Ok(Termination::Singular(error)),
            error => Err(error),
        }
    }
}

/// The result of a method in one increment.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResult {
    /// The reason why it ended.
    pub stop: Termination,
    /// The number of linear systems solved, the paper's nle.
    pub iterations: usize,
    /// The number of shortened steps over all iterations.
    pub backtracks: usize,
    /// The last merit `Theta`.
    pub theta: f64,
    /// The largest backward error of the linear solves.
    pub backward_error: f64,
    /// The time spent on residual, merit and Jacobian, s.
    pub assembly_seconds: f64,
    /// The number of attempts, each of one method.
    pub attempts: usize,
    /// `true` if a fallback method solved the increment.
    pub rescued: bool,
}

impl MethodResult {
    /// Creates the result before the first iteration, with the initial merit `theta`.
    pub fn new(theta: f64) -> Self {
        MethodResult {
            stop: Termination::MaxIterations,
            iterations: 0,
            backtracks: 0,
            theta,
            backward_error: 0.0,
            assembly_seconds: 0.0,
            attempts: 1,
            rescued: false,
        }
    }

    /// Creates the result of no attempt, before the first.
    pub(crate) fn nothing() -> Self {
        MethodResult { attempts: 0, ..MethodResult::new(f64::NAN) }
    }

    /// Adds an iteration.
    fn add(&mut self, theta: f64, backtracks: usize, backward_error: f64) {
        self.iterations += 1;
        self.backtracks += backtracks;
        self.theta = theta;
        self.backward_error = self.backward_error.max(backward_error);
    }

    /// Returns `true` if the iteration ends here: the iteration has `converged`, the numbers are not finite, or the
    /// observer asks to stop.
    fn ends(&mut self, converged: bool, flow: ControlFlow<()>) -> bool {
        self.stop = if converged {
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

    /// Combines this result with that of a later attempt, `next`.
    #[must_use]
    pub fn then(self, next: MethodResult) -> MethodResult {
        MethodResult {
            stop: next.stop,
            iterations: self.iterations + next.iterations,
            backtracks: self.backtracks + next.backtracks,
            theta: next.theta,
            backward_error: self.backward_error.max(next.backward_error),
            assembly_seconds: self.assembly_seconds + next.assembly_seconds,
            attempts: self.attempts + next.attempts,
            rescued: self.rescued || next.rescued,
        }
    }
}

/// An iteration, as reported to an observer.
#[derive(Debug, Clone, Copy)]
pub struct Iteration<'a> {
    /// The record of the iteration.
    pub record: IterationRecord,
    /// The linear system of the step; `None` at the start.
    pub system: Option<LinearSystem<'a>>,
}

/// The linearised equations of an iteration, as they were solved: `matrix · solution = rhs`.
///
/// The unknowns begin with `(u, p_t, p_o, p_n)` in the order of `layout`, forces and displacements in the units of
/// `scaling`. Contact rows are scaled or combined to keep them well conditioned. The solution is that of (22), or of
/// (14) without the eliminated unknowns.
#[derive(Debug, Clone, Copy)]
pub struct LinearSystem<'a> {
    /// The matrix.
    pub matrix: &'a SystemMatrix,
    /// The right-hand side.
    pub rhs: &'a [f64],
    /// The direction `dz`, before it is multiplied by the step size.
    pub solution: &'a [f64],
    /// The layout of the unknowns.
    pub layout: &'a Layout,
    /// The units of the unknowns.
    pub scaling: Scaling,
}

impl Iteration<'_> {
    /// Creates the entry of the start, before any iteration.
    fn start(theta: f64, error: Option<f64>) -> Self {
        Iteration { record: IterationRecord { error, ..IterationRecord::start(theta) }, system: None }
    }
}

/// The record of an iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationRecord {
    /// The number of the iteration in the increment, from 1; 0 means the start.
    pub iteration: usize,
    /// `Theta` after the step.
    pub theta: f64,
    /// The step length taken.
    pub step: f64,
    /// The number of times that the step was shortened.
    pub backtracks: usize,
    /// The componentwise backward error of the linear solve.
    pub backward_error: f64,
    /// `true` if the matrix was factored, `false` if it is that of the last iteration.
    pub factored: bool,
    /// The error measure after the step, if the method has evaluated it. The constants `default` use it as the
    /// stopping test.
    pub error: Option<f64>,
}

impl IterationRecord {
    /// Creates the record of the start, before any iteration.
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

#[derive(Default)]
struct Clock {
    pub seconds: f64,
}

impl Clock {
    fn time<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.seconds += start.elapsed().as_secs_f64();
        result
    }
}
