//! Sparse linear systems `A x = b` with one fixed pattern and many values.
//!
//! A direct solver has three steps: [`LinearSolver::analyze`] once for a pattern, [`LinearSolver::factorize`] when the
//! values have changed, [`LinearSolver::solve`] for each right-hand side. An iterative solver prepares in `factorize` and
//! iterates in `solve`. [`RefinedSolver`] wraps a backend: it counts, measures time, refines the solution and computes its
//! backward error, in the same way for every backend; only an iterative solver of inexact directions is not refined. In the library `unsafe` is used in this module only.

use std::sync::Arc;

use crate::algebra::sparse::Pattern;

pub(crate) mod built_in;
mod choice;
mod cholesky;
#[cfg(feature = "umfpack")]
mod cholmod;
mod dense;
mod direct;
mod engine;
#[cfg(feature = "faer")]
mod faer;
mod grid;
mod kernel;
#[cfg(feature = "umfpack")]
mod ordering;
mod partial;
pub mod process;
mod refine;
mod stiffness;
mod supernodal;
#[cfg(feature = "umfpack")]
mod sys;
mod system;
#[cfg(feature = "umfpack")]
mod umfpack;
#[cfg(feature = "umfpack")]
mod versions;

#[cfg(feature = "faer")]
pub use self::faer::FaerLu;
pub use built_in::ranks as rank_count;
pub use choice::{SparseCholesky, SparseLu};
pub use cholesky::{Cholesky, Reduced};
pub(crate) use dense::times_transposed;
pub use dense::{Dense, Lu};
pub use direct::{RefinedSolver, Statistics};
pub(crate) use engine::engine;
pub use engine::{Engine, RankUse, add_engine};
pub use grid::{Grid, GridContact};
pub(crate) use kernel::null_space_of;
pub use partial::Partial;
pub(crate) use refine::componentwise_error;
pub use refine::{SolveInfo, backward_error};
pub use stiffness::{Distributed, Stiffness};
pub use system::SystemMatrix;
#[cfg(feature = "umfpack")]
pub use umfpack::{Strategy, Umfpack};
#[cfg(feature = "umfpack")]
pub use versions::{suitesparse_version, umfpack_version};

use serde::{Deserialize, Serialize};

/// The properties of a factorisation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FactorInfo {
    /// The number of entries stored in the factors L and U, or a bound on it.
    pub entries: usize,
    /// The number of floating point operations; 0 if the backend does not report it.
    pub flops: f64,
    /// The ratio of the smallest to the largest pivot, or the substitute of a backend: the smallest pivot of the contact block
    /// relative to its column (dense), a bound of the reciprocal condition number (faer's LU), 1 (iterative). It is a coarse
    /// indicator for people, and two backends do not compare. [`RefinedSolver::reciprocal_condition`] decides whether a matrix is
    /// singular, by one definition for every backend.
    pub pivot_ratio: f64,
    /// The peak memory of the factorisation, bytes; 0 if the backend does not report it.
    pub peak_bytes: f64,
}

/// A solver for square linear systems.
pub trait LinearSolver: Send {
    /// Returns the name shown in reports.
    fn name(&self) -> &'static str;

    /// Orders the unknowns and predicts the fill for `pattern`; once for a set-up of the equations.
    ///
    /// # Errors
    /// If memory is short or the backend refuses the pattern.
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Computed<()>;

    /// Factors the matrix with `values` on the analysed pattern; whenever the values have changed.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a pivot vanishes; an error if memory is short.
    fn factorize(&mut self, values: &[f64]) -> Computed<FactorInfo>;

    /// Solves with the last factors, without refinement.
    ///
    /// # Errors
    /// If there are no factors, or the backend fails.
    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()>;

    /// Runs [`LinearSolver::analyze`] for matrices like `a`, which may have a dense or distributed block besides
    /// compressed columns.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    fn analyze_system(&mut self, a: &SystemMatrix) -> Computed<()> {
        self.analyze(a.to_csc()?.pattern())
    }

    /// Runs [`LinearSolver::factorize`] for such a matrix `a`.
    ///
    /// # Errors
    /// As [`LinearSolver::factorize`].
    fn factorize_system(&mut self, a: &SystemMatrix) -> Computed<FactorInfo> {
        self.factorize(a.to_csc()?.values())
    }

    /// Returns `true` if the solver is iterative, so that each digit takes some iterations.
    fn iterates(&self) -> bool {
        false
    }

    /// Solves to a relative residual of `tolerance`. Direct solvers ignore `tolerance`.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    fn solve_to(&mut self, _tolerance: f64, b: &[f64], x: &mut [f64]) -> Computed<()> {
        self.solve(b, x)
    }

    /// Returns the statistics of the iterations since the last call.
    fn iterated(&mut self) -> Iterated {
        Iterated::default()
    }
}

/// The statistics of an iterative solver.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Iterated {
    /// The number of iterations.
    pub iterations: usize,
    /// The direct solver that took over, if the iterations stalled.
    pub instead: Option<SparseLu>,
}

/// A value that linear algebra computes, or why it cannot.
pub type Computed<T> = Result<T, LinearError>;

/// An error of a linear solver, after which the run cannot continue with this matrix.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearError {
    /// A pivot is exactly zero.
    #[error("the matrix is singular (smallest over largest pivot: {pivot_ratio:.1e})")]
    Singular {
        /// The ratio of the smallest to the largest pivot.
        pivot_ratio: f64,
    },
    /// The solution has NaN or an infinity although every pivot was accepted.
    #[error("the solution of the linear system is not finite")]
    NotFinite,
    /// The solution is further from one than the question asked of it bears.
    #[error("the linear system is solved badly (backward error {backward_error:.1e})")]
    Inaccurate {
        /// The componentwise backward error.
        backward_error: f64,
    },
    /// The backend could not get the memory it needs.
    #[error("out of memory in {step}")]
    OutOfMemory {
        /// The step that failed.
        step: &'static str,
    },
    /// The pattern differs from the analysed one.
    #[error("the matrix has another pattern than the one analysed")]
    PatternChanged,
    /// The matrix is not square, or an array has the wrong length.
    #[error("{what}: expected length {expected}, got {found}")]
    Shape {
        /// The array or dimension.
        what: &'static str,
        /// The required length.
        expected: usize,
        /// The given length.
        found: usize,
    },
    /// `factorize` was called before `analyze`, or `solve` before `factorize`.
    #[error("{missing} must be called first")]
    Order {
        /// The step that is missing.
        missing: &'static str,
    },
    /// The solver factors the stiffness apart, and the matrix does not say which unknowns are displacements.
    #[error(
        "the solver \"partial\" must know which unknowns are displacements: create the matrix with \
         SystemMatrix::with_displacements, or use another solver"
    )]
    UnknownDisplacements,
    /// The cargo feature of the backend is off.
    #[error("this build has no {backend}")]
    NotBuiltIn {
        /// The missing backend.
        backend: &'static str,
    },
    /// A process that shares this work has failed, or this process has left it, so that the others no longer answer.
    #[error("a rank has failed before, and the ranks can no longer work together: start the program again")]
    RankFailed,
    /// The loaded C library is not the one whose headers were compiled in. None of its functions was called.
    #[error(
        "{library} {} is loaded, but this was built with the headers of {}: rebuild it here, or let LD_LIBRARY_PATH lead to \
         the library that it was built with",
        dotted(.loaded),
        dotted(.built)
    )]
    Version {
        /// The name of the library.
        library: &'static str,
        /// The version of the headers, `[main, sub, subsub]`.
        built: [i32; 3],
        /// The loaded version.
        loaded: [i32; 3],
    },
    /// A solver that the program has added failed.
    #[error("{engine} failed in {step}: {reason}")]
    Engine {
        /// The name of the solver.
        engine: &'static str,
        /// The step that failed.
        step: &'static str,
        /// The reason, in its words.
        reason: String,
        /// The cure.
        help: &'static str,
        /// `true` if its options are wrong.
        of_options: bool,
    },
    /// Another status of a backend.
    #[error("{backend} failed in {step} with status {status}")]
    Backend {
        /// The name of the backend.
        backend: &'static str,
        /// The step that failed.
        step: &'static str,
        /// The status code.
        status: i64,
    },
}

/// Formats a version.
fn dotted([main, sub, subsub]: &[i32; 3]) -> String {
    format!("{main}.{sub}.{subsub}")
}

/// Returns an error unless both lengths agree.
fn expect_length(what: &'static str, expected: usize, found: usize) -> Computed<()> {
    if expected == found { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
}

/// Returns an error if one of `values` is NaN or infinite.
#[cfg(any(feature = "umfpack", feature = "faer"))]
fn expect_finite(values: &[f64]) -> Computed<()> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(LinearError::NotFinite) }
}
