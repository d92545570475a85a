//! FCLIB's groups and datasets in HDF5 (V. Acary, M. Brémond, T. Koziara, F. Pérignon: FCLIB, a collection of discrete 3D frictional
//! contact problems, INRIA technical report RT-0444, 2014).
//!
//! | path | what |
//! | --- | --- |
//! | `fclib_global` or `fclib_local` | the problem: `spacedim`, matrices `M`, `H`, `G` or `W`, `V`, `R`, `vectors` |
//! | a matrix | `m`, `n`, `nzmax`, `nz`: -1 compressed columns, -2 compressed rows, otherwise triplets with row `i`, column `p`; `p`, `i`, `x` |
//! | `info` in the problem | `title`, `description`, `math_info`; none of them has to be there |
//! | `solution`, `guesses/1` ... | `v` (global), `l` (multipliers of `G`), `u`, `r`; left out where nothing was written into them |
//!
//! Equality constraints `Gᵀ v + b = 0` with multipliers `l` become rows and columns of the global problem: unknowns `(v, l)`.

mod matrix;
mod vectors;
mod write;

pub(super) use write::write;

use super::error::of_dataset;
use super::global::Parts;
use super::hdf5::File;
use super::{GlobalProblem, Info, Problem, ProblemFile, Solution};
use crate::fault::Fault;
use crate::local::LocalProblem;
use crate::sparse::Csc;
use matrix::{is_empty, matrix};
use vectors::{finite, length, need};

const GLOBAL: &str = "fclib_global";
const LOCAL: &str = "fclib_local";
/// Guesses that are looked for.
const GUESSES: i64 = 1000;

fn open(bytes: &[u8]) -> Result<File<'_>, Fault> {
    File::open(bytes).map_err(|error| Fault::new("head of the file", error.to_string(), error.help()))
}

fn has(file: &File<'_>, path: &str) -> Result<bool, Fault> {
    file.has(path).map_err(|error| of_dataset(path, &error))
}

/// Whether somebody has written forces and velocities below `path`. Some tools make the datasets of a solution that they do not have.
fn is_written(file: &File<'_>, path: &str) -> Result<bool, Fault> {
    for name in ["r", "u"] {
        let path = format!("{path}/{name}");
        if !file.is_written(&path).map_err(|error| of_dataset(&path, &error))? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The problem in the `bytes` of an FCLIB file.
pub(super) fn read(bytes: &[u8]) -> Result<ProblemFile, Fault> {
    let file = open(bytes)?;
    let (problem, group) = match (has(&file, GLOBAL)?, has(&file, LOCAL)?) {
        (true, _) => (Problem::Global(global(&file)?), GLOBAL),
        (false, true) => (Problem::Local(local(&file)?), LOCAL),
        (false, false) => {
            let (message, help) =
                ("neither fclib_global nor fclib_local is there", "name a file that holds an FCLIB problem");
            return Err(Fault::new("groups", message, help));
        }
    };
    // What cannot be read of it is no reason to refuse the problem.
    let info = |name: &str| file.text(&format!("{group}/info/{name}")).ok().flatten().filter(|text| !text.is_empty());
    let info = Info { title: info("title"), description: info("description"), math_info: info("math_info") };
    let solution = if is_written(&file, "solution")? { Some(solution(&file, "solution", &problem)?) } else { None };
    let mut guesses = Vec::new();
    if has(&file, "guesses/number_of_guesses")? {
        let count = one(&file, "guesses/number_of_guesses")?;
        for k in 1..=count.min(GUESSES) {
            let path = format!("guesses/{k}");
            if is_written(&file, &path)? {
                guesses.push(self::solution(&file, &path, &problem)?);
            }
        }
    }
    Ok(ProblemFile { info, problem, solution, guesses })
}

/// The solution in the `bytes` of an FCLIB file, with or without a problem.
pub(super) fn read_solution(bytes: &[u8]) -> Result<Solution, Fault> {
    let file = open(bytes)?;
    if !is_written(&file, "solution")? {
        let help = "name a file with a solution, such as `stickslip solve --out` writes";
        return Err(Fault::new("group solution", "r and u are not both there, or nothing was written into them", help));
    }
    any_solution(&file, "solution")
}

/// The integer of a dataset that has one.
fn one(file: &File<'_>, path: &str) -> Result<i64, Fault> {
    let values = need(path, file.integers(path))?;
    match values[..] {
        [value] => Ok(value),
        _ => Err(length(path, 1, values.len(), "it is one number")),
    }
}

fn dimension(file: &File<'_>, path: &str) -> Result<usize, Fault> {
    match one(file, path)? {
        2 => Ok(2),
        3 => Ok(3),
        other => Err(Fault::new(
            format!("dataset {path}"),
            format!("it is {other}"),
            "the dimension is 2 in the plane and 3 in space",
        )),
    }
}

fn numbers(file: &File<'_>, path: &str) -> Result<Vec<f64>, Fault> {
    finite(path, need(path, file.numbers(path))?)
}

/// An error unless there is a coefficient of friction at `path` for each contact, of which each has so many of the `rows` of a matrix as there are directions.
fn friction_fits(path: &str, dimension: usize, rows: usize, coefficients: usize) -> Result<(), Fault> {
    if rows.is_multiple_of(dimension) && rows / dimension != coefficients {
        return Err(length(path, rows / dimension, coefficients, "one for each contact that the matrices have"));
    }
    Ok(())
}

fn global(file: &File<'_>) -> Result<GlobalProblem, Fault> {
    let dimension = dimension(file, "fclib_global/spacedim")?;
    let vector = |name: &str| numbers(file, &format!("fclib_global/vectors/{name}"));
    let (mut f, w, mu) = (vector("f")?, vector("w")?, vector("mu")?);
    let n = f.len();
    let m = matrix(file, "fclib_global/M", n, n)?;
    let h = matrix(file, "fclib_global/H", n, w.len())?;
    friction_fits("fclib_global/vectors/mu", dimension, w.len(), mu.len())?;
    let constraints = if has(file, "fclib_global/vectors/b")? { vector("b")? } else { Vec::new() };
    if constraints.is_empty() {
        if !is_empty(file, "fclib_global/G")? {
            let help = "write fclib_global/vectors/b, one number for each column of G";
            return Err(Fault::new("dataset fclib_global/G", "there are constraints, but no b", help));
        }
        return GlobalProblem::new(Parts { dimension, m, h, f, w, mu, constraints: 0 });
    }
    let g = matrix(file, "fclib_global/G", n, constraints.len())?;
    f.extend(constraints.iter().map(|b| -b));
    let all = n + constraints.len();
    // M v - G l = f + H r, Gᵀ v = -b.
    let entries: Vec<_> =
        m.entries().chain(g.entries().flat_map(|(i, j, x)| [(i, n + j, -x), (n + j, i, x)])).collect();
    let wrong =
        |error: crate::sparse::MatrixError| Fault::new("group fclib_global", error.to_string(), "mend the matrices");
    let m = Csc::from_triplets(all, all, &entries).map_err(wrong)?;
    let h = Csc::from_triplets(all, w.len(), &h.entries().collect::<Vec<_>>()).map_err(wrong)?;
    GlobalProblem::new(Parts { dimension, m, h, f, w, mu, constraints: constraints.len() })
}

fn local(file: &File<'_>) -> Result<LocalProblem, Fault> {
    let dimension = dimension(file, "fclib_local/spacedim")?;
    for name in ["fclib_local/V", "fclib_local/R"] {
        if !is_empty(file, name)? {
            let help = "eliminate them, or give the problem in its global form, where constraints are read";
            return Err(Fault::new(format!("group {name}"), "constraints of a local problem are not read", help));
        }
    }
    let vector = |name: &str| numbers(file, &format!("fclib_local/vectors/{name}"));
    let (q, mu) = (vector("q")?, vector("mu")?);
    let delassus = matrix(file, "fclib_local/W", q.len(), q.len())?;
    friction_fits("fclib_local/vectors/mu", dimension, q.len(), mu.len())?;
    let help = "q has one number for each direction of each contact, mu one for each contact";
    LocalProblem::new(dimension, delassus, q, mu)
        .map_err(|error| Fault::new("group fclib_local", error.to_string(), help))
}

/// What stands at `path`, of whatever lengths.
fn any_solution(file: &File<'_>, path: &str) -> Result<Solution, Fault> {
    let optional = |name: &str| {
        let path = format!("{path}/{name}");
        if has(file, &path)? { numbers(file, &path) } else { Ok(Vec::new()) }
    };
    let (mut v, multipliers) = (optional("v")?, optional("l")?);
    v.extend(multipliers);
    Ok(Solution { v, r: numbers(file, &format!("{path}/r"))?, u: numbers(file, &format!("{path}/u"))? })
}

/// The solution at `path` of `problem`.
fn solution(file: &File<'_>, path: &str, problem: &Problem) -> Result<Solution, Fault> {
    let solution = any_solution(file, path)?;
    solution.check(problem).map_err(|fault| fault.under(&format!("group {path}")))?;
    Ok(solution)
}
