//! The settings and the results of the cascade.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::measure::{Errors, TOLERANCE};

/// The limits of the stages, 0 to omit a stage, and the tolerance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CascadeSettings {
    /// The natural map, without units, below which a problem counts as solved; [`TOLERANCE`].
    pub tolerance: f64,
    /// The largest number of iterations of BN per call; 50. Without BN the other stages cannot finish.
    pub newton_iterations: usize,
    /// The largest number of iterations on each path of the interior point method; 60.
    pub interior_iterations: usize,
    /// The largest number of Gauss–Seidel sweeps of the last stage; 1280.
    pub sweeps: usize,
}

impl Default for CascadeSettings {
    fn default() -> Self {
        CascadeSettings { tolerance: TOLERANCE, newton_iterations: 50, interior_iterations: 60, sweeps: 1280 }
    }
}

/// A stage of the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Zero forces: nothing approaches.
    Free,
    /// BN from a given guess.
    Guess,
    /// BN after a few Gauss–Seidel sweeps.
    Newton,
    /// The interior point method, finished by BN.
    Interior,
    /// The interior point method on paths from further inside, or nearer to the boundary.
    InteriorElsewhere,
    /// The interior point method on paths that satisfy the cone equation at every step.
    InteriorOnCone,
    /// Many Gauss–Seidel sweeps, with BN at intervals.
    Sweeps,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stage::Free => "free",
            Stage::Guess => "guess",
            Stage::Newton => "Newton",
            Stage::Interior => "interior point",
            Stage::InteriorElsewhere => "interior point from elsewhere",
            Stage::InteriorOnCone => "interior point on the cone",
            Stage::Sweeps => "sweeps",
        })
    }
}

/// The result of a stage over all islands on which it was tried.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// The stage.
    pub stage: Stage,
    /// The number of islands (groups of contacts that influence each other) on which it was tried.
    pub islands: usize,
    /// The number of islands that it solved.
    pub solved: usize,
    /// The number of iterations, each with a factorisation; for [`Stage::Sweeps`] including the sweeps.
    pub iterations: usize,
    /// The largest natural map of these islands at its end, each in its own scales.
    pub residual: f64,
}

/// The verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LocalStatus {
    /// The natural map is within the tolerance.
    Solved,
    /// The natural map exceeds the tolerance; a solution may or may not exist.
    NotSolved,
    /// No solution exists: nothing can stop this contact, which approaches while its normal row of `W` is 0.
    Unsolvable {
        /// The number of the contact.
        contact: usize,
    },
}

/// The result of [`solve`](super::solve).
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// `r`, n_c d: the solution, or otherwise the forces with the smallest natural map.
    pub r: Vec<f64>,
    /// `u = W r + q`, n_c d.
    pub u: Vec<f64>,
    /// The verdict, from `errors` alone.
    pub status: LocalStatus,
    /// The errors of `r`.
    pub errors: Errors,
    /// The number of islands.
    pub islands: usize,
    /// The stages that were tried, in order.
    pub stages: Vec<StageRecord>,
}

impl Solved {
    /// Returns the iterations of all stages.
    pub fn iterations(&self) -> usize {
        self.stages.iter().map(|record| record.iterations).sum()
    }
}
