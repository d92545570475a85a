//! From a problem to a solution with its verdict.
//!
//! A global problem with a symmetric `M` is one increment of ours, so it is solved as such: uncondensed, by BN. Where that
//! does not solve it, or `M` is not symmetric, it is reduced to its contacts, and goes through the cascade for local problems.
//! What is answered is the best that any stage has found, and whether it is a solution [`judge`] says alone.

use serde::{Deserialize, Serialize};

use super::judge::judge;
use super::reduction::{Reduction, ReductionError};
use super::{Errors, GlobalProblem, Problem, Solution};
use crate::local::{self, CascadeSettings, LocalProblem, LocalProblemError};
use std::ops::ControlFlow;
use stickslip::base::input_error::InputError;
use stickslip::solver::history::{self, HistorySettings, IncrementView, Method, Observer, SystemSolver};
use stickslip::solver::problem::State;

/// What BN is to reach, so that the laws hold in everybody's units.
const WHOLE_TOLERANCE: f64 = 1e-13;
/// Its iterations at most.
const WHOLE_ITERATIONS: usize = 100;
/// The name of that stage.
const WHOLE: &str = "bn-whole";

/// A solution, or the best that was found in place of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Forces and velocities.
    pub solution: Solution,
    /// How far it is from the laws.
    pub errors: Errors,
    /// What was tried, in this order; the last has found the solution.
    pub stages: Vec<Stage>,
}

/// What a method has done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stage {
    /// Which method.
    pub stage: String,
    /// Its iterations.
    pub iterations: usize,
    /// The residual at its end, without units.
    pub residual: f64,
}

/// A way to a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// What [`solve`] does: one after the other, until a solution is found.
    Default,
    /// The uncondensed system of a global problem, by BN.
    Whole,
    /// The contacts alone, by the cascade for local problems.
    Contacts,
    /// The contacts alone, by BN.
    Newton,
    /// The contacts alone, by Gauss–Seidel sweeps.
    Sweeps,
}

impl Way {
    /// All of them.
    pub const ALL: [Way; 5] = [Way::Default, Way::Whole, Way::Contacts, Way::Newton, Way::Sweeps];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Way::Default => "default",
            Way::Whole => "whole",
            Way::Contacts => "contacts",
            Way::Newton => "newton",
            Way::Sweeps => "sweeps",
        }
    }

    /// What the cascade for local problems is told.
    fn cascade(self) -> CascadeSettings {
        let all = CascadeSettings::default();
        match self {
            Way::Default | Way::Whole | Way::Contacts => all,
            Way::Newton => CascadeSettings { interior_iterations: 0, sweeps: 0, ..all },
            Way::Sweeps => CascadeSettings { newton_iterations: 0, interior_iterations: 0, ..all },
        }
    }
}

/// Why a problem cannot even be tried.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A guess does not fit the problem.
    #[error(transparent)]
    Guess(#[from] InputError),
    /// The local problem or a guess for it is refused.
    #[error(transparent)]
    Local(#[from] LocalProblemError),
    /// Neither the uncondensed path nor the reduction goes on with such a matrix.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The linear algebra cannot go on.
    #[error(transparent)]
    History(#[from] history::Error),
}

impl Answer {
    /// Whether all laws hold within [`TOLERANCE`](super::TOLERANCE).
    pub fn is_solved(&self) -> bool {
        self.errors.is_solved()
    }

    /// All iterations.
    pub fn iterations(&self) -> usize {
        self.stages.iter().map(|stage| stage.iterations).sum()
    }
}

/// Solves `problem`, from `guess` where a method takes one.
///
/// # Errors
/// When the guess does not fit, or no method can begin; that none has found a solution is no error.
pub fn solve(problem: &Problem, guess: Option<&Solution>) -> Result<Answer, SolveError> {
    if let Some(guess) = guess {
        guess.check(problem)?;
    }
    let r = guess.map(|guess| &guess.r[..]);
    match problem {
        Problem::Local(local) => on_contacts(Way::Default, problem, local, r),
        Problem::Global(global) => both(problem, global, r),
    }
}

/// The same by one way alone; `None` where it is none for such a problem.
///
/// # Errors
/// As [`solve`].
pub fn solve_by(way: Way, problem: &Problem, guess: Option<&Solution>) -> Result<Option<Answer>, SolveError> {
    if let Some(guess) = guess {
        guess.check(problem)?;
    }
    let r = guess.map(|guess| &guess.r[..]);
    match (way, problem) {
        (Way::Default, _) => solve(problem, guess).map(Some),
        (Way::Whole, Problem::Global(global)) => on_bodies(problem, global),
        (Way::Whole, Problem::Local(_)) => Ok(None),
        (_, Problem::Global(global)) => reduced(way, problem, global, r).map(Some),
        (_, Problem::Local(local)) => on_contacts(way, problem, local, r).map(Some),
    }
}

/// A local problem through the cascade of a way.
fn on_contacts(way: Way, problem: &Problem, local: &LocalProblem, guess: Option<&[f64]>) -> Result<Answer, SolveError> {
    let (solution, stages) = cascade(way, local, guess)?;
    let errors = judge(problem, &solution)?;
    Ok(Answer { solution, errors, stages })
}

/// A global problem by BN on the uncondensed system.
fn on_bodies(problem: &Problem, global: &GlobalProblem) -> Result<Option<Answer>, SolveError> {
    let Some((solution, iterations)) = whole(global)? else { return Ok(None) };
    let errors = judge(problem, &solution)?;
    let stages = vec![Stage { stage: WHOLE.to_string(), iterations, residual: errors.worst() }];
    Ok(Some(Answer { solution, errors, stages }))
}

/// A global problem reduced to its contacts, through the cascade of a way.
fn reduced(way: Way, problem: &Problem, global: &GlobalProblem, guess: Option<&[f64]>) -> Result<Answer, SolveError> {
    let mut reduction = Reduction::new(global)?;
    let (Solution { r, .. }, stages) = cascade(way, reduction.local(), guess)?;
    let solution = reduction.solution(r).map_err(ReductionError::from)?;
    let errors = judge(problem, &solution)?;
    Ok(Answer { solution, errors, stages })
}

fn both(problem: &Problem, global: &GlobalProblem, guess: Option<&[f64]>) -> Result<Answer, SolveError> {
    let first = on_bodies(problem, global)?;
    if let Some(answer) = first.as_ref().filter(|answer| answer.is_solved()) {
        return Ok(answer.clone());
    }
    match (first, reduced(Way::Default, problem, global, guess)) {
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

/// The uncondensed system by BN, as one increment from rest; `None` where that has no such increment.
fn whole(global: &GlobalProblem) -> Result<Option<(Solution, usize)>, SolveError> {
    // A matrix that takes energy out of a displacement is none of a body; the reduction may do with it.
    let Ok(Some((problem, loading))) = global.contact_problem() else { return Ok(None) };
    let settings = HistorySettings::new(&problem, &loading, Method::BN)?.until(WHOLE_ITERATIONS, WHOLE_TOLERANCE);
    // Parts of an increment would be another problem.
    let settings = HistorySettings { halvings: 0, ..settings };
    let mut last = Last(None);
    let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut last);
    match (outcome, last.0) {
        (Ok(outcome), Some(state)) => Ok(Some((of_state(global, &state), outcome.tally.iterations))),
        // The reduction may do better, or say more.
        _ => Ok(None),
    }
}

/// Keeps the state at the end of the last increment, converged or not.
struct Last(Option<State>);

impl Observer for Last {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.0 = Some(step.state.clone());
        ControlFlow::Continue(())
    }
}

/// A state in the letters of exchange files.
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

/// The cascade for local problems.
fn cascade(
    way: Way,
    problem: &LocalProblem,
    guess: Option<&[f64]>,
) -> Result<(Solution, Vec<Stage>), LocalProblemError> {
    let solved = local::solve(problem, &way.cascade(), guess)?;
    let stage = |record: &local::StageRecord| Stage {
        stage: record.stage.to_string(),
        iterations: record.iterations,
        residual: record.residual,
    };
    let stages = solved.stages.iter().map(stage).collect();
    Ok((Solution { v: Vec::new(), r: solved.r, u: solved.u }, stages))
}
