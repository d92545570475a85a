//! Writes problems as FCLIB files.

use super::{GLOBAL, LOCAL};
use crate::hdf5::{self, Node};
use crate::local::LocalProblem;
use crate::{GlobalProblem, Info, Problem, ProblemFile, Solution};
use stickslip::algebra::Csc;
use stickslip::base::InputError;

/// The largest number of guesses to write. The group also has an entry for their number.
const GUESSES: usize = 15;

/// Returns the bytes of an FCLIB file.
pub(crate) fn write(file: &ProblemFile) -> Result<Vec<u8>, InputError> {
    let mut children = Vec::new();
    let constraints = match &file.problem {
        Problem::Global(problem) => {
            children.push((GLOBAL.to_string(), global(problem, &file.info)?));
            problem.constraints()
        }
        Problem::Local(problem) => {
            children.push((LOCAL.to_string(), local(problem, &file.info)?));
            0
        }
    };
    if let Some(found) = &file.solution {
        children.push(("solution".to_string(), solution(found, constraints)));
    }
    if !file.guesses.is_empty() {
        let guesses = &file.guesses[..file.guesses.len().min(GUESSES)];
        let mut group = vec![("number_of_guesses".to_string(), one(guesses.len())?)];
        group.extend(guesses.iter().enumerate().map(|(k, guess)| ((k + 1).to_string(), solution(guess, constraints))));
        children.push(("guesses".to_string(), Node::Group(group)));
    }
    Ok(hdf5::write(&Node::Group(children)))
}

/// Converts to FCLIB's integers, which have 32 bits.
fn integer(number: usize) -> Result<i32, InputError> {
    i32::try_from(number).map_err(|_| {
        let message = format!("{number} is too large for the 32-bit integers of FCLIB");
        InputError::new("sizes", message, "export the local form, or a coarser mesh")
    })
}

fn one(number: usize) -> Result<Node, InputError> {
    Ok(Node::Integers(vec![integer(number)?]))
}

/// Writes a matrix in compressed columns.
fn matrix(matrix: &Csc) -> Result<Node, InputError> {
    let pattern = matrix.pattern();
    let mut starts = vec![0; pattern.columns() + 1];
    let (mut rows, mut values) = (Vec::new(), Vec::new());
    for (row, column, value) in matrix.entries() {
        starts[column + 1] += 1;
        rows.push(integer(row)?);
        values.push(value);
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    let starts = starts.into_iter().map(integer).collect::<Result<_, _>>()?;
    Ok(Node::group([
        ("nzmax", one(values.len())?),
        ("m", one(pattern.rows())?),
        ("n", one(pattern.columns())?),
        ("nz", Node::Integers(vec![-1])),
        ("p", Node::Integers(starts)),
        ("i", Node::Integers(rows)),
        ("x", Node::Numbers(values)),
    ]))
}

fn info(info: &Info) -> Node {
    let Info { title, description, math_info } = info;
    let texts = [("title", title), ("description", description), ("math_info", math_info)];
    let text = |(name, text): (&str, &Option<String>)| Some((name.to_string(), Node::Text(text.clone()?)));
    Node::Group(texts.into_iter().filter_map(text).collect())
}

fn global(problem: &GlobalProblem, about: &Info) -> Result<Node, InputError> {
    let (n, constraints) = (problem.unknowns() - problem.constraints(), problem.constraints());
    let part = |matrix: &Csc, columns: usize| {
        let entries: Vec<_> = matrix.entries().filter(|(i, j, _)| *i < n && *j < columns).collect();
        let whole = |error: stickslip::algebra::MatrixError| {
            InputError::new("group fclib_global", error.to_string(), "correct the matrices")
        };
        Csc::from_triplets(n, columns, &entries).map_err(whole)
    };
    let mut vectors = vec![
        ("f".to_string(), Node::Numbers(problem.f()[..n].to_vec())),
        ("w".to_string(), Node::Numbers(problem.w().to_vec())),
        ("mu".to_string(), Node::Numbers(problem.mu().to_vec())),
    ];
    let mut children = vec![
        ("spacedim".to_string(), one(problem.dimension())?),
        ("info".to_string(), info(about)),
        ("H".to_string(), matrix(&part(problem.h(), problem.w().len())?)?),
        ("M".to_string(), matrix(&part(problem.m(), n)?)?),
    ];
    if constraints > 0 {
        let of_g = problem.m().entries().filter(|(i, j, _)| *i < n && *j >= n).map(|(i, j, x)| (i, j - n, -x));
        let g = Csc::from_triplets(n, constraints, &of_g.collect::<Vec<_>>())
            .map_err(|error| InputError::new("group fclib_global/G", error.to_string(), "correct the matrix"))?;
        children.push(("G".to_string(), matrix(&g)?));
        vectors.push(("b".to_string(), Node::Numbers(problem.f()[n..].iter().map(|b| -b).collect())));
    }
    children.push(("vectors".to_string(), Node::Group(vectors)));
    Ok(Node::Group(children))
}

fn local(problem: &LocalProblem, about: &Info) -> Result<Node, InputError> {
    let vectors = [("q", Node::Numbers(problem.q().to_vec())), ("mu", Node::Numbers(problem.mu().to_vec()))];
    Ok(Node::group([
        ("spacedim", one(problem.dimension())?),
        ("info", info(about)),
        ("W", matrix(problem.delassus())?),
        ("vectors", Node::group(vectors)),
    ]))
}

/// Writes a solution whose `v` ends with this number of multipliers of constraints.
fn solution(solution: &Solution, constraints: usize) -> Node {
    let Solution { v, r, u } = solution;
    let mut children = vec![("u".to_string(), Node::Numbers(u.clone())), ("r".to_string(), Node::Numbers(r.clone()))];
    if !v.is_empty() {
        let (v, l) = v.split_at(v.len().saturating_sub(constraints));
        children.push(("v".to_string(), Node::Numbers(v.to_vec())));
        if !l.is_empty() {
            children.push(("l".to_string(), Node::Numbers(l.to_vec())));
        }
    }
    Node::Group(children)
}
