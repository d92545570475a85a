//! FCLIB's groups and datasets in HDF5 (V. Acary, M. Brémond, T. Koziara, F. Pérignon: FCLIB, a collection of discrete 3D frictional
//! contact problems, INRIA technical report RT-0444, 2014).
//!
//! | path | content |
//! | --- | --- |
//! | `fclib_global` or `fclib_local` | the problem: `spacedim`, matrices `M`, `H`, `G` or `W`, `V`, `R`, `vectors` |
//! | a matrix | `m`, `n`, `nzmax`, `nz`: -1 compressed columns, -2 compressed rows, otherwise triplets with row `i`, column `p`; `p`, `i`, `x` |
//! | `info` in the problem | `title`, `description`, `math_info`, all optional |
//! | `solution`, `guesses/1` ... | `v` (global), `l` (multipliers of `G`), `u`, `r`; ignored unless all of them exist and were written |
//!
//! Equality constraints `Gᵀ v + b = 0` with multipliers `l` become rows and columns of the global problem: unknowns `(v, l)`.

mod matrix;
mod vectors;
mod write;

pub(super) use write::write;

use super::error::of_dataset;
use super::global::Parts;
use super::hdf5::{Dataset, File};
use super::{GlobalProblem, Info, Problem, ProblemFile, Solution};
use crate::local::LocalProblem;
use matrix::{has_sizes, is_empty, matrix};
use stickslip::algebra::Csc;
use stickslip::base::InputError;
use vectors::{length, need, numbers, one, written};

const GLOBAL: &str = "fclib_global";
const LOCAL: &str = "fclib_local";
/// The largest number of guesses to look for.
const GUESSES: i64 = 1000;
/// Memory per number of a vector while it is read, bytes: in the file, as an element, as a number, in the problem.
const BYTES_OF_A_NUMBER: u64 = 32;

fn open(bytes: &[u8]) -> Result<File, InputError> {
    File::open(bytes).map_err(|error| InputError::new("head of the file", error.to_string(), error.help()))
}

fn has(file: &File, path: &str) -> Result<bool, InputError> {
    file.has(path).map_err(|error| of_dataset(path, &error))
}

/// Reads the problem in the `bytes` of an FCLIB file.
pub(super) fn read(bytes: &[u8]) -> Result<ProblemFile, InputError> {
    let file = open(bytes)?;
    let (problem, group) = match (has(&file, GLOBAL)?, has(&file, LOCAL)?) {
        (true, _) => (Problem::Global(global(&file)?), GLOBAL),
        (false, true) => (Problem::Local(local(&file)?), LOCAL),
        (false, false) => {
            let (message, help) =
                ("there is neither fclib_global nor fclib_local", "name a file with an FCLIB problem");
            return Err(InputError::new("groups", message, help));
        }
    };
    // An unreadable info is no reason to refuse the problem.
    let info = |name: &str| {
        let dataset = written(&file, &format!("{group}/info/{name}")).ok().flatten();
        dataset.and_then(|dataset| dataset.text().ok().flatten()).filter(|text| !text.is_empty())
    };
    let info = Info { title: info("title"), description: info("description"), math_info: info("math_info") };
    let solution = solution(&file, "solution", &problem)?;
    let mut guesses = Vec::new();
    if written(&file, "guesses/number_of_guesses")?.is_some() {
        let count = one(&file, "guesses/number_of_guesses")?;
        for k in 1..=count.min(GUESSES) {
            guesses.extend(self::solution(&file, &format!("guesses/{k}"), &problem)?);
        }
    }
    Ok(ProblemFile { info, problem, solution, guesses })
}

/// Reads the solution of `problem` in the `bytes` of an FCLIB file, with or without a problem of its own.
pub(super) fn read_solution(bytes: &[u8], problem: &Problem) -> Result<Solution, InputError> {
    solution(&open(bytes)?, "solution", problem)?.ok_or_else(|| {
        let help = "name a file with a solution, such as `stickslip solve --out` writes";
        let what = match problem {
            Problem::Global(_) => "v, u and r do not all exist",
            Problem::Local(_) => "r and u do not both exist",
        };
        InputError::new("group solution", format!("{what}, or were never written"), help)
    })
}

fn dimension(file: &File, path: &str) -> Result<usize, InputError> {
    match one(file, path)? {
        2 => Ok(2),
        3 => Ok(3),
        other => Err(InputError::new(
            format!("dataset {path}"),
            format!("it is {other}"),
            "the dimension is 2 in the plane and 3 in space",
        )),
    }
}

/// The vectors `names` in the group `path`. Their lengths are checked before anything is read.
struct Vectors<const N: usize> {
    paths: [String; N],
    datasets: [Dataset; N],
}

impl<const N: usize> Vectors<N> {
    fn open(file: &File, group: &str, names: [&str; N]) -> Result<Self, InputError> {
        let paths = names.map(|name| format!("{group}/{name}"));
        let datasets: Vec<Dataset> = paths.iter().map(|path| need(file, path)).collect::<Result<_, _>>()?;
        match datasets.try_into() {
            Ok(datasets) => Ok(Vectors { paths, datasets }),
            Err(_) => Err(InputError::new(group, "it has unexpected vectors", "write the vectors of FCLIB")),
        }
    }

    fn lengths(&self) -> [usize; N] {
        std::array::from_fn(|k| self.datasets[k].count())
    }

    /// Reads them if there is memory for all of them.
    fn read(&self, file: &File) -> Result<[Vec<f64>; N], InputError> {
        for (path, length) in self.paths.iter().zip(self.lengths()) {
            let bytes = BYTES_OF_A_NUMBER.saturating_mul(length as u64);
            file.take_room(bytes).map_err(|error| of_dataset(path, &error))?;
        }
        let mut read = std::array::from_fn(|_| Vec::new());
        for ((read, path), dataset) in read.iter_mut().zip(&self.paths).zip(&self.datasets) {
            *read = numbers(dataset, path)?;
        }
        Ok(read)
    }
}

/// Returns an error unless there is a coefficient of friction at `path` for each contact. A contact has as many of the
/// `rows` of a matrix as there are directions.
fn friction_fits(path: &str, dimension: usize, rows: usize, coefficients: usize) -> Result<(), InputError> {
    if rows.is_multiple_of(dimension) && rows / dimension != coefficients {
        return Err(length(path, rows / dimension, coefficients, "one for each contact that the matrices have"));
    }
    Ok(())
}

fn global(file: &File) -> Result<GlobalProblem, InputError> {
    let dimension = dimension(file, "fclib_global/spacedim")?;
    let vectors = Vectors::open(file, "fclib_global/vectors", ["f", "w", "mu"])?;
    let [n, rows, coefficients] = vectors.lengths();
    has_sizes(file, "fclib_global/M", n, n)?;
    has_sizes(file, "fclib_global/H", n, rows)?;
    friction_fits("fclib_global/vectors/mu", dimension, rows, coefficients)?;
    let b = match written(file, "fclib_global/vectors/b")? {
        Some(b) if b.count() > 0 => {
            has_sizes(file, "fclib_global/G", n, b.count())?;
            Some(Vectors::open(file, "fclib_global/vectors", ["b"])?)
        }
        _ => None,
    };
    let [mut f, w, mu] = vectors.read(file)?;
    let m = matrix(file, "fclib_global/M", n, n)?;
    let h = matrix(file, "fclib_global/H", n, w.len())?;
    let [constraints] = b.map_or(Ok([Vec::new()]), |b| b.read(file))?;
    if constraints.is_empty() {
        if !is_empty(file, "fclib_global/G")? {
            let help = "write fclib_global/vectors/b, one number for each column of G";
            return Err(InputError::new("dataset fclib_global/G", "there are constraints, but no b", help));
        }
        return GlobalProblem::new(Parts { dimension, m, h, f, w, mu, constraints: 0 });
    }
    let g = matrix(file, "fclib_global/G", n, constraints.len())?;
    f.extend(constraints.iter().map(|b| -b));
    let all = n + constraints.len();
    // M v - G l = f + H r, Gᵀ v = -b.
    let entries: Vec<_> =
        m.entries().chain(g.entries().flat_map(|(i, j, x)| [(i, n + j, -x), (n + j, i, x)])).collect();
    let wrong = |error: stickslip::algebra::MatrixError| {
        InputError::new("group fclib_global", error.to_string(), "correct the matrices")
    };
    let m = Csc::from_triplets(all, all, &entries).map_err(wrong)?;
    let h = Csc::from_triplets(all, w.len(), &h.entries().collect::<Vec<_>>()).map_err(wrong)?;
    GlobalProblem::new(Parts { dimension, m, h, f, w, mu, constraints: constraints.len() })
}

fn local(file: &File) -> Result<LocalProblem, InputError> {
    let dimension = dimension(file, "fclib_local/spacedim")?;
    for name in ["fclib_local/V", "fclib_local/R"] {
        if !is_empty(file, name)? {
            let help = "eliminate them, or give the problem in its global form, where constraints are read";
            return Err(InputError::new(format!("group {name}"), "constraints of a local problem are not read", help));
        }
    }
    let vectors = Vectors::open(file, "fclib_local/vectors", ["q", "mu"])?;
    let [rows, coefficients] = vectors.lengths();
    has_sizes(file, "fclib_local/W", rows, rows)?;
    friction_fits("fclib_local/vectors/mu", dimension, rows, coefficients)?;
    let [q, mu] = vectors.read(file)?;
    let delassus = matrix(file, "fclib_local/W", rows, rows)?;
    LocalProblem::new(dimension, delassus, q, mu)
}

/// Reads the solution of `problem` at `path`. Returns `None` unless all vectors of such a problem exist and were
/// written, because some tools create the datasets of a solution that they do not have.
fn solution(file: &File, path: &str, problem: &Problem) -> Result<Option<Solution>, InputError> {
    let rows = problem.contacts() * problem.dimension();
    let (unknowns, multipliers) = match problem {
        Problem::Global(problem) => (problem.unknowns() - problem.constraints(), problem.constraints()),
        Problem::Local(_) => (0, 0),
    };
    let vector = |name: &str, expected: usize| -> Result<Option<Vec<f64>>, InputError> {
        let path = format!("{path}/{name}");
        if expected == 0 {
            return Ok(Some(Vec::new()));
        }
        let Some(dataset) = written(file, &path)? else { return Ok(None) };
        if dataset.count() != expected {
            let message = format!("it has {} entries, but the problem needs {expected}", dataset.count());
            let help = "give a solution of this problem, in the same form: global or local";
            return Err(InputError::new(format!("dataset {path}"), message, help));
        }
        numbers(&dataset, &path).map(Some)
    };
    let v = (vector("v", unknowns)?, vector("l", multipliers)?);
    let ((Some(mut v), Some(l)), Some(r), Some(u)) = (v, vector("r", rows)?, vector("u", rows)?) else {
        return Ok(None);
    };
    v.extend(l);
    Ok(Some(Solution { v, r, u }))
}
