//! Sparse linear systems `A x = b` with one fixed pattern and many values.
//!
//! A direct solver has three steps: [`LinearSolver::analyze`] once for a pattern, [`LinearSolver::factorize`] when the
//! values have changed, [`LinearSolver::solve`] for each right-hand side. An iterative solver prepares in `factorize` and
//! iterates in `solve`. [`RefinedSolver`] wraps a backend: it counts, measures time, refines the solution and computes its
//! backward error, in the same way for every backend; only an iterative solver of inexact directions is not refined. `unsafe` is used in this module only.

use std::sync::Arc;

use crate::algebra::sparse::Pattern;

pub(crate) mod built_in;
mod choice;
mod cholesky;
#[cfg(feature = "umfpack")]
mod cholmod;
pub(crate) mod cost;
mod dense;
mod direct;
#[cfg(feature = "mpi")]
mod distributed;
mod error;
#[cfg(feature = "faer")]
mod faer;
mod kernel;
#[cfg(any(feature = "umfpack", feature = "mpi"))]
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
pub use dense::Dense;
pub use dense::Lu;
pub(crate) use dense::times_transposed;
pub use direct::{RefinedSolver, Statistics};
#[cfg(feature = "mumps")]
pub use distributed::Mumps;
#[cfg(feature = "petsc")]
pub use distributed::{Form, Grid, GridContact, Multigrid, share};
#[cfg(feature = "mpi")]
pub use distributed::{RankRows, help, ranks};
pub use error::LinearError;
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
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError>;

    /// Factors the matrix with `values` on the analysed pattern; whenever the values have changed.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a pivot vanishes; an error if memory is short.
    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError>;

    /// Solves with the last factors, without refinement.
    ///
    /// # Errors
    /// If there are no factors, or the backend fails.
    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError>;

    /// Runs [`LinearSolver::analyze`] for matrices like `a`, which may have a dense or distributed block besides
    /// compressed columns.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    fn analyze_system(&mut self, a: &SystemMatrix) -> Result<(), LinearError> {
        self.analyze(a.to_csc()?.pattern())
    }

    /// Runs [`LinearSolver::factorize`] for such a matrix `a`.
    ///
    /// # Errors
    /// As [`LinearSolver::factorize`].
    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
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
    fn solve_to(&mut self, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let _ = tolerance;
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

/// The resources used by one MPI process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RankUse {
    /// The CPU time, s.
    pub cpu_seconds: f64,
    /// The peak resident memory, bytes.
    pub peak_rss_bytes: u64,
}
