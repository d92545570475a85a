//! Gauss–Seidel sweeps over the contacts: each is given the force that its own law asks for, the others being as they are.

use std::fmt;

use super::{LocalErrors, LocalProblem, LocalProblemError, SOLVED};
use crate::sparse::Csr;

/// What the solvers are told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CascadeSettings {
    /// The natural map at which a problem counts as solved, without units.
    pub tolerance: f64,
    /// Iterations of BN at most.
    pub newton_iterations: usize,
    /// Iterations of the interior point method at most.
    pub interior_iterations: usize,
    /// Sweeps at most.
    pub sweeps: usize,
}

impl Default for CascadeSettings {
    fn default() -> Self {
        CascadeSettings { tolerance: SOLVED, newton_iterations: 0, interior_iterations: 0, sweeps: 1000 }
    }
}

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LocalStatus {
    /// All laws hold within the tolerance, by the independent measure.
    Solved,
    /// They do not.
    NotSolved,
}

/// A method of the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Gauss–Seidel sweeps.
    Sweeps,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("gauss-seidel")
    }
}

/// What a stage has done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StageRecord {
    /// Which.
    pub stage: Stage,
    /// Its iterations.
    pub iterations: usize,
    /// The natural map at its end.
    pub residual: f64,
}

/// Forces and velocities, and how far they are from the laws.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// Forces, n_c d.
    pub r: Vec<f64>,
    /// Velocities, n_c d.
    pub u: Vec<f64>,
    /// The verdict.
    pub status: LocalStatus,
    /// The independent measure.
    pub errors: LocalErrors,
    /// What was tried.
    pub stages: Vec<StageRecord>,
}

/// Solves `problem` from `guess` (n_c d), or from no forces.
///
/// # Errors
/// When the guess does not fit the problem.
pub fn solve(
    problem: &LocalProblem,
    settings: &CascadeSettings,
    guess: Option<&[f64]>,
) -> Result<Solved, LocalProblemError> {
    let mut r = guess.map_or_else(|| vec![0.0; problem.q().len()], <[f64]>::to_vec);
    let mut errors = problem.errors(&r, None)?;
    let (rows, d) = (Csr::from(problem.delassus()), problem.dimension());
    let mut iterations = 0;
    while iterations < settings.sweeps && !errors.within(0.01 * settings.tolerance) {
        iterations += 1;
        for (i, mu) in problem.mu().iter().enumerate() {
            let w = (d * i..d * (i + 1)).map(|k| rows.row(k).iter().find(|e| e.0 == k).map_or(0.0, |e| e.1));
            let largest = w.fold(0.0, f64::max);
            let step = if largest > 0.0 { 1.0 / largest } else { 1.0 };
            for _ in 0..20 {
                let u: Vec<f64> = (d * i..d * (i + 1)).map(|k| rows.dot(k, &r) + problem.q()[k]).collect();
                r[d * i] = (r[d * i] - step * u[0]).max(0.0);
                let trial: Vec<f64> = (1..d).map(|k| r[d * i + k] - step * u[k]).collect();
                let size = trial.iter().map(|t| t * t).sum::<f64>().sqrt();
                let radius = mu * r[d * i];
                let factor = if size > radius { radius / size } else { 1.0 };
                (1..d).for_each(|k| r[d * i + k] = factor * trial[k - 1]);
            }
        }
        if iterations % 10 == 0 || iterations < 10 {
            errors = problem.errors(&r, None)?;
        }
    }
    errors = problem.errors(&r, None)?;
    let u = rows.mul(&r).iter().zip(problem.q()).map(|(u, q)| u + q).collect();
    let status = if errors.within(settings.tolerance) { LocalStatus::Solved } else { LocalStatus::NotSolved };
    let stages = vec![StageRecord { stage: Stage::Sweeps, iterations, residual: errors.natural_map }];
    Ok(Solved { r, u, status, errors, stages })
}
