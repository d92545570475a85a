//! Solves a problem and judges the solution.
//!
//! A global problem with a symmetric `M` is equivalent to one increment, and is solved as such: uncondensed, by BN. If
//! this fails, or `M` is not symmetric, the problem is reduced to its contacts and solved by the cascade for local
//! problems. The result is the best of all stages, and only [`judge`] decides if it is a solution.

use super::judge::judge;
use super::reduction::{Reduction, ReductionError};
use super::{Errors, GlobalProblem, Problem, Solution};
use crate::local::{self, CascadeSettings, LocalProblem};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;
use stickslip::base::InputError;
use stickslip::solver::State;
use stickslip::solver::history::{self, HistorySettings, IncrementView, Method, Observer, SystemSolver};

/// The tolerance of BN, strict enough for the laws to hold in any units.
const WHOLE_TOLERANCE: f64 = 1e-13;
/// The largest number of its iterations.
const WHOLE_ITERATIONS: usize = 100;
/// The name of this stage.
const WHOLE: &str = "bn-whole";

/// A solution, or the best result in place of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Forces and velocities.
    pub solution: Solution,
    /// The errors of the laws.
    pub errors: Errors,
    /// The stages that were tried, in order. The last one has found the solution, if any.
    pub stages: Vec<Stage>,
}

/// The work of one method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Stage {
    /// The method.
    pub stage: String,
    /// The number of iterations.
    pub iterations: usize,
    /// The residual at the end of the stage, without units.
    pub residual: f64,
}

/// A solver of exchange problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strategy {
    /// All methods of [`solve`], one after the other, until a solution is found.
    Default,
    /// BN on the uncondensed system of a global problem.
    Whole,
    /// The cascade for local problems, on the contacts alone.
    Contacts,
    /// BN on the contacts alone.
    Newton,
    /// Gauss–Seidel sweeps on the contacts alone.
    Sweeps,
}

impl Strategy {
    /// All solvers.
    pub const ALL: [Self; 5] = [Self::Default, Self::Whole, Self::Contacts, Self::Newton, Self::Sweeps];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Whole => "whole",
            Self::Contacts => "contacts",
            Self::Newton => "newton",
            Self::Sweeps => "sweeps",
        }
    }

    /// Returns the settings of the cascade for local problems.
    fn cascade(self) -> CascadeSettings {
        let all = CascadeSettings::default();
        match self {
            Self::Default | Self::Whole | Self::Contacts => all,
            Self::Newton => CascadeSettings { interior_iterations: 0, sweeps: 0, ..all },
            Self::Sweeps => CascadeSettings { newton_iterations: 0, interior_iterations: 0, ..all },
        }
    }
}

/// The reason why a problem cannot be attempted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A guess does not fit the problem.
    #[error(transparent)]
    Guess(#[from] InputError),
    /// Neither the uncondensed system nor the reduction can use such a matrix.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The linear algebra cannot go on.
    #[error(transparent)]
    History(#[from] history::Error),
}

impl Answer {
    /// Returns `true` if all laws hold within [`TOLERANCE`](super::TOLERANCE).
    pub fn is_solved(&self) -> bool {
        self.errors.is_solved()
    }

    /// Returns the iterations of all stages.
    pub fn iterations(&self) -> usize {
        self.stages.iter().map(|stage| stage.iterations).sum()
    }
}

/// Solves `problem`, from `guess` for methods that use one.
///
/// # Errors
/// When the guess does not fit, or no method can begin. An answer that is no solution is no error.
pub fn solve(problem: &Problem, guess: Option<&Solution>) -> Result<Answer, SolveError> {
    if let Some(guess) = guess {
        guess.check(problem)?;
    }
    let r = guess.map(|guess| &guess.r[..]);
    match problem {
        Problem::Local(local) => on_contacts(Strategy::Default, problem, local, r),
        Problem::Global(global) => both(problem, global, r),
    }
}

/// Solves `problem` by one solver alone. Returns `None` if the solver does not apply to it.
///
/// # Errors
/// As [`solve`].
pub fn solve_by(strategy: Strategy, problem: &Problem, guess: Option<&Solution>) -> Result<Option<Answer>, SolveError> {
    if let Some(guess) = guess {
        guess.check(problem)?;
    }
    let r = guess.map(|guess| &guess.r[..]);
    match (strategy, problem) {
        (Strategy::Default, _) => solve(problem, guess).map(Some),
        (Strategy::Whole, Problem::Global(global)) => on_bodies(problem, global),
        (Strategy::Whole, Problem::Local(_)) => Ok(None),
        (_, Problem::Global(global)) => reduced(strategy, problem, global, r).map(Some),
        (_, Problem::Local(local)) => on_contacts(strategy, problem, local, r).map(Some),
    }
}

/// Solves a local problem by the cascade of a solver.
fn on_contacts(
    strategy: Strategy,
    problem: &Problem,
    local: &LocalProblem,
    guess: Option<&[f64]>,
) -> Result<Answer, SolveError> {
    let (solution, stages) = cascade(strategy, local, guess)?;
    let errors = judge(problem, &solution)?;
    Ok(Answer { solution, errors, stages })
}

/// Solves a global problem by BN on the uncondensed system.
fn on_bodies(problem: &Problem, global: &GlobalProblem) -> Result<Option<Answer>, SolveError> {
    let Some((solution, iterations)) = whole(global)? else { return Ok(None) };
    let errors = judge(problem, &solution)?;
    let stages = vec![Stage { stage: WHOLE.to_string(), iterations, residual: errors.worst() }];
    Ok(Some(Answer { solution, errors, stages }))
}

/// Reduces a global problem to its contacts and solves it by the cascade of a solver.
fn reduced(
    strategy: Strategy,
    problem: &Problem,
    global: &GlobalProblem,
    guess: Option<&[f64]>,
) -> Result<Answer, SolveError> {
    let mut reduction = Reduction::new(global)?;
    let (Solution { r, .. }, stages) = cascade(strategy, reduction.local(), guess)?;
    let solution = reduction.solution(r).map_err(ReductionError::from)?;
    let errors = judge(problem, &solution)?;
    Ok(Answer { solution, errors, stages })
}

fn both(problem: &Problem, global: &GlobalProblem, guess: Option<&[f64]>) -> Result<Answer, SolveError> {
    let first = on_bodies(problem, global)?;
    if let Some(answer) = first.as_ref().filter(|answer| answer.is_solved()) {
        return Ok(answer.clone());
    }
    match (first, reduced(Strategy::Default, problem, global, guess)) {
        (None, reduced) => reduced,
        (Some(first), Err(_)) => Ok(first),
        (Some(first), Ok(second)) => {
            let better = second.errors.worst() < first.errors.worst();
            let [mut stages, more] = [first.stages.clone(), second.stages.clone()];
            stages.extend(more);
            Ok(Answer { stages, ..if better { second } else { first } })
        }
    }
}

/// Solves the uncondensed system by BN, as one increment from rest. Returns `None` if there is no such increment, or BN
/// fails.
fn whole(global: &GlobalProblem) -> Result<Option<(Solution, usize)>, SolveError> {
    // A matrix that yields negative energy belongs to no body. The reduction may still work.
    let Ok(Some((problem, loading))) = global.contact_problem() else { return Ok(None) };
    let settings = HistorySettings::new(&problem, &loading, Method::BN)?.until(WHOLE_ITERATIONS, WHOLE_TOLERANCE);
    // Substeps of an increment would be another problem.
    let settings = HistorySettings { halvings: 0, ..settings };
    let mut last = Last(None);
    let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut last);
    match (outcome, last.0) {
        (Ok(outcome), Some(state)) => Ok(Some((of_state(global, &state), outcome.tally.iterations))),
        // The reduction may succeed, or report more.
        _ => Ok(None),
    }
}

/// Observer that keeps the state at the end of the last increment, converged or not.
struct Last(Option<State>);

impl Observer for Last {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.0 = Some(step.state.clone());
        ControlFlow::Continue(())
    }
}

/// Converts a state to the notation of exchange files.
fn of_state(global: &GlobalProblem, state: &State) -> Solution {
    let d = global.dimension();
    let force = |i: usize| {
        let [n, t, o] = [&state.p_n, &state.p_t, &state.p_o].map(|p| p[i]);
        [n, 0.0 - t, 0.0 - o].into_iter().take(d)
    };
    let r = (0..global.contacts()).flat_map(force).collect();
    let v = state.u.clone();
    let u = global.velocities(&v);
    Solution { v, r, u }
}

/// Solves a local problem by the cascade.
fn cascade(
    strategy: Strategy,
    problem: &LocalProblem,
    guess: Option<&[f64]>,
) -> Result<(Solution, Vec<Stage>), InputError> {
    let solved = local::solve(problem, &strategy.cascade(), guess)?;
    let stage = |record: &local::StageRecord| Stage {
        stage: record.stage.to_string(),
        iterations: record.iterations,
        residual: record.residual,
    };
    let stages = solved.stages.iter().map(stage).collect();
    Ok((Solution { v: Vec::new(), r: solved.r, u: solved.u }, stages))
}
