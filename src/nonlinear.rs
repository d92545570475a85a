//! Solvers for the equations of one increment, each reading like the algorithm it is.

mod armijo;
mod bn;

pub use armijo::Armijo;
pub use bn::{Bn, BnSettings};

use crate::linear::LinearError;

/// How the iteration of one increment ended, by the solver's own stop test.
#[derive(Debug, Clone, PartialEq)]
pub enum Stop {
    /// The stop test was met.
    Met,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The merit or the iterate is not finite.
    Diverged,
    /// The linearisation is singular: nothing stops the free motion with these weights.
    Unheld(Vec<f64>),
    /// The linearisation is singular for another reason.
    Singular(LinearError),
    /// The observer asked to stop.
    Interrupted,
}

/// What the solver did in one increment.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub stop: Stop,
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
}

/// One iteration, as it happens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IterationRecord {
    /// Its number in the increment, from 1.
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
}

/// What an observer wants.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Continue,
    /// Stop after the last good increment.
    Stop,
}
