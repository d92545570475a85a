//! Exports an increment as a problem for other programs, with its solution, and the state before it as a guess.

use super::global::Parts;
use super::reduction::{Reduction, ReductionError};
use super::{GlobalProblem, Info, Problem, ProblemFile, Solution};
use crate::checks::expect_size;
use stickslip::algebra::Csc;
use stickslip::base::InputError;
use stickslip::solver::{ContactProblem, Increment, ProblemError, State};

/// Exports one increment of `problem` in space of `dimension` (2 or 3), from `before` to `state`, as a global problem.
///
/// # Errors
/// [`InputError`] of an array of wrong length.
pub fn export(
    problem: &ContactProblem,
    dimension: usize,
    increment: &Increment<'_>,
    state: &State,
    before: &State,
    info: Info,
) -> Result<ProblemFile, InputError> {
    let help = "give the state and the increment of this problem";
    let refused = |error: ProblemError| InputError::new("increment", error.to_string(), help);
    problem.equilibrium(increment.force, state).map_err(refused)?;
    problem.equilibrium(increment.force, before).map_err(refused)?;
    let (n, n_c) = (problem.displacements(), problem.contacts());
    for (key, values) in
        [("gap", increment.gap), ("mu", increment.mu), ("w_t", increment.w_t_last), ("w_o", increment.w_o_last)]
    {
        expect_size(key, "entries", n_c, values.len(), help)?;
    }
    let wrong = |error: stickslip::algebra::MatrixError| InputError::new("problem", error.to_string(), help);
    let stiffness = problem.stiffness().assembled().map_err(|error| refused(error.into()))?;
    let m = Csc::from_triplets(n, n, &stiffness.entries().collect::<Vec<_>>()).map_err(wrong)?;
    let maps = [(problem.c_n(), -1.0), (problem.c_t(), 1.0), (problem.c_o(), 1.0)];
    let mut entries = Vec::new();
    for i in 0..n_c {
        for (k, (map, sign)) in maps.iter().take(dimension).enumerate() {
            entries.extend(map.row(i).iter().map(|&(dof, value)| (dof, dimension * i + k, sign * value)));
        }
    }
    let h = Csc::from_triplets(n, dimension * n_c, &entries).map_err(wrong)?;
    let Increment { force, gap, mu, w_t_last, w_o_last } = *increment;
    let of_contact = |i: usize| [gap[i], 0.0 - w_t_last[i], 0.0 - w_o_last[i]].into_iter().take(dimension);
    let w = (0..n_c).flat_map(of_contact).collect();
    let parts = Parts { dimension, m, h, f: force.to_vec(), w, mu: mu.to_vec(), constraints: 0 };
    let solution_of = |state: &State| solution(problem, dimension, increment, state).map_err(refused);
    let (solution, guesses) = (Some(solution_of(state)?), vec![solution_of(before)?]);
    Ok(ProblemFile { info, problem: Problem::Global(GlobalProblem::new(parts)?), solution, guesses })
}

/// Converts a state of `problem`. Velocities include the digits that `u` loses by rounding.
fn solution(
    problem: &ContactProblem,
    dimension: usize,
    increment: &Increment<'_>,
    state: &State,
) -> Result<Solution, ProblemError> {
    let (mut r, mut u) = (Vec::new(), Vec::new());
    for (i, [normal, t, o]) in problem.relative_motions(increment, state)?.into_iter().enumerate() {
        u.extend([0.0 - normal, t, o].into_iter().take(dimension));
        r.extend([state.p_n[i], 0.0 - state.p_t[i], 0.0 - state.p_o[i]].into_iter().take(dimension));
    }
    Ok(Solution { v: state.u.clone(), r, u })
}

/// Reduces a problem to its contacts. A local problem is returned unchanged.
///
/// # Errors
/// [`ReductionError`] if only contact holds the body.
pub fn export_local(file: ProblemFile) -> Result<ProblemFile, ReductionError> {
    let local = match &file.problem {
        Problem::Local(_) => return Ok(file),
        Problem::Global(problem) => Reduction::new(problem)?.local().clone(),
    };
    let without_v = |Solution { r, u, .. }: Solution| Solution { v: Vec::new(), r, u };
    let guesses = file.guesses.into_iter().map(without_v).collect();
    let (info, solution) = (file.info, file.solution.map(without_v));
    Ok(ProblemFile { info, problem: Problem::Local(local), solution, guesses })
}
