//! What the cascade is told, and what it tells.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{LocalErrors, SOLVED};

/// How long the stages are tried, 0 leaving one out, and what counts as solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CascadeSettings {
    /// The natural map, without units, at which a problem is solved; [`SOLVED`].
    pub tolerance: f64,
    /// The most iterations of BN, each time that it is called; 50. Without them the other stages have no finish.
    pub newton_iterations: usize,
    /// The most iterations on each path of the interior point method; 60.
    pub interior_iterations: usize,
    /// The most Gauss–Seidel sweeps of the rescue; 1280.
    pub sweeps: usize,
}

impl Default for CascadeSettings {
    fn default() -> Self {
        CascadeSettings { tolerance: SOLVED, newton_iterations: 50, interior_iterations: 60, sweeps: 1280 }
    }
}

/// What was tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// No forces at all: nothing approaches.
    Free,
    /// BN from a guess that was handed over.
    Guess,
    /// BN after a few Gauss–Seidel sweeps.
    Newton,
    /// The interior point method, finished by BN.
    Interior,
    /// The same on paths from further inside, or nearer to the border.
    InteriorElsewhere,
    /// The same on paths that keep to the cone.
    InteriorOnCone,
    /// Many Gauss–Seidel sweeps, with BN every now and then.
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

/// What a stage came to, over all islands that it was tried on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct StageRecord {
    /// The stage.
    pub stage: Stage,
    /// The islands that it was tried on: contacts that feel each other.
    pub islands: usize,
    /// Of these, those that it solved.
    pub solved: usize,
    /// Iterations, each with a matrix factored; of [`Stage::Sweeps`] the sweeps with them.
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
    /// It is not; whether there is a solution is not known.
    NotSolved,
    /// There is none: nothing can stop the contact of this number, which approaches while its normal row of `W` is 0.
    Unsolvable {
        /// The contact.
        contact: usize,
    },
}

/// What [`solve`](super::solve) has found.
#[derive(Debug, Clone, PartialEq)]
pub struct Solved {
    /// `r`, n_c d: the solution, or the forces with the least natural map that were found.
    pub r: Vec<f64>,
    /// `u = W r + q`, n_c d.
    pub u: Vec<f64>,
    /// The verdict, by `errors` alone.
    pub status: LocalStatus,
    /// The measure of `r`.
    pub errors: LocalErrors,
    /// How many islands there are.
    pub islands: usize,
    /// The stages that were tried, in their order.
    pub stages: Vec<StageRecord>,
}

impl Solved {
    /// The iterations of all stages.
    pub fn iterations(&self) -> usize {
        self.stages.iter().map(|record| record.iterations).sum()
    }
}
