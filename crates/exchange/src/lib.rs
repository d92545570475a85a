//! Problems in the formats of other programs: FCLIB, the exchange format of the friction community, and Siconos' text.
//!
//! ```text
//! global   M v = f + H r,   u = Hᵀ v + w          M: stiffness or mass, H: contact forces to nodal forces
//! local    u = W r + q                            W = Hᵀ M⁻¹ H, the Delassus matrix; q = Hᵀ M⁻¹ f + w
//! laws     u_N ≥ 0,  r_N ≥ 0,  u_N r_N = 0,  |r_T| ≤ μ r_N,  r_T = -μ r_N u_T / |u_T|  where u_T ≠ 0
//! ```
//!
//! Rows of `u` and `r` are ordered contact by contact, the normal first. In the notation of
//! [`stickslip::ContactProblem`], `K = M`, `H = [-C_nᵀ, C_tᵀ, C_oᵀ]`, `r_N = p_n`, `r_T = -p_T` and `w = (g, -w̄_T)`,
//! so `u_N` is the gap and `u_T` the slip increment.
//!
//! | file | content |
//! | --- | --- |
//! | `hdf5.rs` | bytes of HDF5 |
//! | `fclib.rs` | FCLIB's groups and datasets, read and written |
//! | `siconos.rs` | the text of Siconos |
//! | `global.rs`, `reduction.rs` | the global problem, as a [`ContactProblem`](stickslip::solver::ContactProblem) and as a local one |
//! | `measure.rs`, `judge.rs` | the error measure of any solution |
//! | `checks.rs` | checks of sizes and numbers that both kinds of problems share |
//! | `solve.rs` | from a problem to a solution with its verdict |
//! | `export.rs` | an increment of ours as a problem for other programs |
//!
//! ```
//! use stickslip_exchange::{Problem, ProblemFile, solve};
//!
//! // Siconos' text of a unit mass that falls on a floor and slides: dimension, contacts, W (dense, 2 × 2), q, μ.
//! let text = b"2 1  0 2 2  2 2  1 0 0 1  -2 3  0.5";
//! let file = ProblemFile::from_bytes("mass.dat", text)?;
//! let answer = solve(&file.problem, None)?;
//! assert!(answer.is_solved());
//! assert_eq!(answer.solution.r, [2.0, -1.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod checks;
mod error;
mod export;
mod fclib;
mod global;
mod hdf5;
mod judge;
pub mod local;
mod measure;
mod reduction;
mod siconos;
mod solve;

use crate::local::LocalProblem;
use std::path::Path;
use stickslip::base::read_bytes;

pub use error::ExchangeError;
pub use export::{export, export_local};
pub use global::{GlobalProblem, Parts};
pub use hdf5::Hdf5Error;
pub use judge::judge;
pub use measure::{Errors, Law, TOLERANCE};
pub use reduction::{Reduction, ReductionError};
pub use solve::{Answer, SolveError, Stage, Strategy, solve, solve_by};

/// A problem with the other content of its file.
#[derive(Debug, Clone)]
pub struct ProblemFile {
    /// Its name and its origin.
    pub info: Info,
    /// The problem.
    pub problem: Problem,
    /// A solution, if the file contains one.
    pub solution: Option<Solution>,
    /// Initial guesses for solvers.
    pub guesses: Vec<Solution>,
}

/// The description of a problem in its file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Info {
    /// A short name.
    pub title: Option<String>,
    /// The origin of the problem.
    pub description: Option<String>,
    /// Known properties of its solutions.
    pub math_info: Option<String>,
}

/// A problem in one of two forms.
#[derive(Debug, Clone)]
pub enum Problem {
    /// A problem with the unknowns of bodies.
    Global(GlobalProblem),
    /// A problem of the contacts alone.
    Local(LocalProblem),
}

/// Forces and velocities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Solution {
    /// `v`, the unknowns of the bodies of a global problem, n; empty for a local one.
    pub v: Vec<f64>,
    /// `r`, contact forces, n_c d.
    pub r: Vec<f64>,
    /// `u`, relative velocities, n_c d.
    pub u: Vec<f64>,
}

impl Problem {
    /// Returns `d`, the dimension: 2 in the plane and 3 in space.
    pub fn dimension(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.dimension(),
            Problem::Local(problem) => problem.dimension(),
        }
    }

    /// Returns n_c, the number of contacts.
    pub fn contacts(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.contacts(),
            Problem::Local(problem) => problem.contacts(),
        }
    }

    /// Returns the number of unknowns of the bodies; 0 for a local problem.
    pub fn unknowns(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.unknowns(),
            Problem::Local(_) => 0,
        }
    }

    /// Returns the form: `global` or `local`.
    pub fn form(&self) -> &'static str {
        match self {
            Problem::Global(_) => "global",
            Problem::Local(_) => "local",
        }
    }
}

impl ProblemFile {
    /// Reads the problem in the file at `path`: FCLIB's HDF5 or Siconos' text, recognised by the first bytes.
    ///
    /// # Errors
    /// [`ExchangeError`] with the invalid line or dataset, and the cure.
    pub fn read(path: &Path) -> Result<Self, ExchangeError> {
        let name = path.display().to_string();
        let bytes = read_bytes(path).map_err(|error| ExchangeError::Io { file: name.clone(), error })?;
        Self::from_bytes(&name, &bytes)
    }

    /// Reads the problem in the `bytes` of a file called `name`.
    ///
    /// # Errors
    /// As [`ProblemFile::read`].
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, ExchangeError> {
        let read = if hdf5::is_hdf5(bytes) {
            fclib::read(bytes)
        } else if bytes.contains(&0) {
            return Err(ExchangeError::Unknown { file: name.to_string() });
        } else {
            siconos::read(&String::from_utf8_lossy(bytes))
        };
        read.map_err(|fault| ExchangeError::Content { file: name.to_string(), fault })
    }

    /// Returns the bytes of an FCLIB file.
    ///
    /// # Errors
    /// When it is too large for the 32-bit integers of FCLIB.
    pub fn to_fclib(&self) -> Result<Vec<u8>, ExchangeError> {
        fclib::write(self).map_err(|fault| ExchangeError::Content { file: "FCLIB".to_string(), fault })
    }
}

/// Reads the solution of `problem` in the FCLIB file at `path`. The problem may be in another file.
///
/// # Errors
/// As [`ProblemFile::read`], and when the file has no solution, or one of another problem.
pub fn read_solution(path: &Path, problem: &Problem) -> Result<Solution, ExchangeError> {
    let name = path.display().to_string();
    let bytes = read_bytes(path).map_err(|error| ExchangeError::Io { file: name.clone(), error })?;
    if !hdf5::is_hdf5(&bytes) {
        return Err(ExchangeError::Unknown { file: name });
    }
    fclib::read_solution(&bytes, problem).map_err(|fault| ExchangeError::Content { file: name, fault })
}
