//! The cascade: what is tried on a local problem, from cheap to dear, until the independent measure says that it is solved.
//!
//! Each island goes its own way. All that its stages have in common are the forces with the least natural map so far.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::interior::{Path, interior};
use super::islands::{Island, islands};
use super::judge::Judge;
use super::newton::newton;
use super::scaled::Scaled;
use super::sweeps::sweep;
use super::{LocalErrors, LocalProblem, LocalProblemError, SOLVED};

/// How long the stages are tried, and what counts as solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CascadeSettings {
    /// The natural map, without units, at which a problem is solved; [`SOLVED`].
    pub tolerance: f64,
    /// The most iterations of BN from sweeps; 50.
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
    /// The same on a path from further inside.
    InteriorFromFar,
    /// The same on two paths that keep to the cone, of which one is from far inside.
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
            Stage::InteriorFromFar => "interior point from far",
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

/// What [`solve`] has found.
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

/// Solves `problem`, from a `guess` of its forces (n_c d) if there is one. That it was not solved is no error but a status.
///
/// # Errors
/// When the guess does not fit the problem or is not finite, or the tolerance is not above 0.
pub fn solve(
    problem: &LocalProblem,
    settings: &CascadeSettings,
    guess: Option<&[f64]>,
) -> Result<Solved, LocalProblemError> {
    let tolerance = settings.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        return Err(LocalProblemError::Setting { setting: "tolerance", value: tolerance, must: "finite, and above 0" });
    }
    if let Some(guess) = guess {
        problem.check("guess", guess)?;
    }
    let mut r = vec![0.0; problem.q().len()];
    let mut stages = Vec::new();
    let islands = islands(problem);
    for island in &islands {
        let guess = guess.map(|guess| island.read(guess));
        island.write(&forces(island, settings, guess.as_deref(), &mut stages), &mut r);
    }
    stages.sort_by_key(|record| record.stage);
    let (u, errors) = super::errors::judged(problem, &r);
    let status = if errors.within(tolerance) {
        LocalStatus::Solved
    } else {
        helpless(problem).map_or(LocalStatus::NotSolved, |contact| LocalStatus::Unsolvable { contact })
    };
    Ok(Solved { r, u, status, errors, islands: islands.len(), stages })
}

/// A contact that approaches whatever the forces are.
fn helpless(problem: &LocalProblem) -> Option<usize> {
    let d = problem.dimension();
    let mut held = vec![false; problem.contacts()];
    for (row, _, w) in problem.delassus().entries() {
        held[row / d] |= row % d == 0 && w != 0.0;
    }
    (0..problem.contacts()).find(|&i| !held[i] && problem.q()[d * i] < 0.0)
}

/// The best forces of one island; what was tried is added to the `records`.
fn forces(
    island: &Island,
    settings: &CascadeSettings,
    guess: Option<&[f64]>,
    records: &mut Vec<StageRecord>,
) -> Vec<f64> {
    let scaled = Scaled::new(&island.problem);
    let mut judge = Judge::new(&island.problem, &scaled, settings.tolerance);
    let stages = [
        Stage::Free,
        Stage::Guess,
        Stage::Newton,
        Stage::Interior,
        Stage::InteriorFromFar,
        Stage::InteriorOnCone,
        Stage::Sweeps,
    ];
    for stage in stages {
        if stage == Stage::Guess && guess.is_none() {
            continue;
        }
        let iterations = run(stage, &mut judge, settings, guess);
        note(records, stage, iterations, &judge);
        if judge.solved() {
            break;
        }
    }
    judge.into_forces()
}

/// Adds what a stage came to to the record of that stage.
fn note(records: &mut Vec<StageRecord>, stage: Stage, iterations: usize, judge: &Judge<'_>) {
    let (solved, residual) = (usize::from(judge.solved()), judge.error());
    match records.iter_mut().find(|record| record.stage == stage) {
        Some(record) => {
            record.islands += 1;
            record.solved += solved;
            record.iterations += iterations;
            record.residual = record.residual.max(residual);
        }
        None => records.push(StageRecord { stage, islands: 1, solved, iterations, residual }),
    }
}

/// Sweeps before the first stage: more find no more statuses.
const FIRST_SWEEPS: usize = 10;
/// The paths of each stage of the interior point method. Of 240 problems of spheres, rocks, boxes, capsules, planks, arches and walls,
/// most of them with a singular `W`, BN solves 142, the first path 60 more, and each of the others two or three.
const PATHS: [&[Path]; 3] = [
    &[Path { reach: 1.0, on_cone: false }],
    &[Path { reach: 10.0, on_cone: false }],
    &[Path { reach: 1.0, on_cone: true }, Path { reach: 100.0, on_cone: true }],
];

/// Tries one stage; how many iterations it took.
fn run(stage: Stage, judge: &mut Judge<'_>, settings: &CascadeSettings, guess: Option<&[f64]>) -> usize {
    let scaled = judge.scaled();
    let limit = settings.newton_iterations;
    match stage {
        Stage::Free => 0,
        Stage::Guess => guess.map_or(0, |guess| newton(judge, scaled.read(guess), limit)),
        Stage::Newton => {
            let mut r = vec![0.0; scaled.rows()];
            sweep(scaled, &mut r, FIRST_SWEEPS);
            newton(judge, r, limit)
        }
        Stage::Interior => follow(judge, settings, PATHS[0]),
        Stage::InteriorFromFar => follow(judge, settings, PATHS[1]),
        Stage::InteriorOnCone => follow(judge, settings, PATHS[2]),
        Stage::Sweeps => {
            let mut r = judge.best();
            let (mut done, mut iterations, mut next) = (0, 0, 2 * FIRST_SWEEPS);
            while done < settings.sweeps && !judge.solved() {
                let more = next.min(settings.sweeps - done);
                sweep(scaled, &mut r, more);
                (done, next) = (done + more, done + more);
                iterations += newton(judge, r.clone(), limit);
            }
            done + iterations
        }
    }
}

/// Follows one path after the other, each finished by BN.
fn follow(judge: &mut Judge<'_>, settings: &CascadeSettings, paths: &[Path]) -> usize {
    let mut iterations = 0;
    for path in paths {
        if !judge.solved() {
            let (r, more) = interior(judge, *path, settings.interior_iterations);
            iterations += more + newton(judge, r, settings.newton_iterations);
        }
    }
    iterations
}
