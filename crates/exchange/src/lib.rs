//! Problems of other people, and ours for them: FCLIB, the exchange format of the friction community, and Siconos' texts.
//!
//! ```text
//! global   M v = f + H r,   u = Hᵀ v + w          M: stiffness or mass, H: contact forces to nodal forces
//! local    u = W r + q                            W = Hᵀ M⁻¹ H, the Delassus matrix; q = Hᵀ M⁻¹ f + w
//! laws     u_N ≥ 0,  r_N ≥ 0,  u_N r_N = 0,  |r_T| ≤ μ r_N,  r_T = -μ r_N u_T / |u_T|  where u_T ≠ 0
//! ```
//!
//! Rows of `u` and `r` go contact by contact, the normal first. In the letters of [`stickslip::solver::problem`] is `K = M`,
//! `H = [-C_nᵀ, C_tᵀ, C_oᵀ]`, `r_N = p_n`, `r_T = -p_T`, `w = (g, -w̄_T)`, so `u_N` is the gap and `u_T` the slip increment.
//!
//! | what | file |
//! | --- | --- |
//! | bytes of HDF5 | `hdf5.rs` |
//! | FCLIB's groups and datasets, read and written | `fclib.rs` |
//! | the texts of Siconos | `siconos.rs` |
//! | the global problem, as a [`ContactProblem`](stickslip::solver::problem::ContactProblem) and as a local one | `global.rs`, `reduction.rs` |
//! | how far somebody's solution is from the laws | `judge.rs` |
//! | from a problem to a solution with its verdict | `solve.rs` |
//! | an increment of ours as a problem for others | `export.rs` |
//! | what is told of it, of whole folders, and in performance profiles | `report.rs`, `collection.rs`, `profile.rs` |
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

mod error;
mod export;
mod fclib;
mod global;
mod hdf5;
mod judge;
pub mod local;
mod reduction;
mod siconos;
mod solve;

use std::path::Path;

pub use error::ExchangeError;
pub use export::{export, export_local};
pub use global::{GlobalProblem, Parts};
pub use hdf5::Hdf5Error;
pub use judge::{Errors, Law, TOLERANCE, judge};
pub use reduction::{Reduction, ReductionError};
pub use solve::{Answer, SolveError, Stage, Way, solve, solve_by};

use crate::local::LocalProblem;
use stickslip::base::input;

/// A problem with what stands beside it in its file.
#[derive(Debug, Clone)]
pub struct ProblemFile {
    /// What it is called, and from where it comes.
    pub info: Info,
    /// The problem.
    pub problem: Problem,
    /// Somebody's solution.
    pub solution: Option<Solution>,
    /// Where solvers may begin.
    pub guesses: Vec<Solution>,
}

/// What a file says of its problem.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Info {
    /// A short name.
    pub title: Option<String>,
    /// Where it comes from.
    pub description: Option<String>,
    /// What is known of its solutions.
    pub math_info: Option<String>,
}

/// A problem in one of both forms.
#[derive(Debug, Clone)]
pub enum Problem {
    /// With the unknowns of bodies.
    Global(GlobalProblem),
    /// Of contacts alone.
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
    /// `d`, 2 in the plane and 3 in space.
    pub fn dimension(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.dimension(),
            Problem::Local(problem) => problem.dimension(),
        }
    }

    /// n_c, the number of contacts.
    pub fn contacts(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.contacts(),
            Problem::Local(problem) => problem.contacts(),
        }
    }

    /// The unknowns of the bodies; 0 of a local problem.
    pub fn unknowns(&self) -> usize {
        match self {
            Problem::Global(problem) => problem.unknowns(),
            Problem::Local(_) => 0,
        }
    }

    /// `global` or `local`.
    pub fn form(&self) -> &'static str {
        match self {
            Problem::Global(_) => "global",
            Problem::Local(_) => "local",
        }
    }
}

impl ProblemFile {
    /// The problem in the file at `path`: FCLIB's HDF5 or Siconos' text, by what it begins with.
    ///
    /// # Errors
    /// [`ExchangeError`] with the line or the dataset that is wrong, and how to mend it.
    pub fn read(path: &Path) -> Result<Self, ExchangeError> {
        let name = path.display().to_string();
        let bytes = input::bytes(path).map_err(|error| ExchangeError::Io { file: name.clone(), error })?;
        Self::from_bytes(&name, &bytes)
    }

    /// The same of the `bytes` of a file called `name`.
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

    /// The bytes of an FCLIB file.
    ///
    /// # Errors
    /// When it is too large for the 32-bit integers of FCLIB.
    pub fn to_fclib(&self) -> Result<Vec<u8>, ExchangeError> {
        fclib::write(self).map_err(|fault| ExchangeError::Content { file: "FCLIB".to_string(), fault })
    }
}

/// The solution of `problem` in the FCLIB file at `path`; the problem may be in another file.
///
/// # Errors
/// As [`ProblemFile::read`], when there is no solution in the file, or one of another problem.
pub fn read_solution(path: &Path, problem: &Problem) -> Result<Solution, ExchangeError> {
    let name = path.display().to_string();
    let bytes = input::bytes(path).map_err(|error| ExchangeError::Io { file: name.clone(), error })?;
    if !hdf5::is_hdf5(&bytes) {
        return Err(ExchangeError::Unknown { file: name });
    }
    fclib::read_solution(&bytes, problem).map_err(|fault| ExchangeError::Content { file: name, fault })
}
