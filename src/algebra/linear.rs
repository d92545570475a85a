//! Sparse linear systems `A x = b` with one fixed pattern and many values.
//!
//! Three steps, as every direct solver has them: [`LinearSolver::analyze`] once a run,
//! [`LinearSolver::factorize`] once an iteration, [`LinearSolver::solve`] for each right-hand side.
//! [`RefinedSolver`] stands in front of a backend: it counts, measures time, refines the solution and
//! reports its backward error, the same way for every backend. `unsafe` lives in this module and
//! nowhere else.

use std::sync::Arc;

use crate::algebra::sparse::{Pattern, SystemMatrix};

pub mod blas;
pub mod built_in;
mod choice;
mod cholesky;
#[cfg(feature = "umfpack")]
mod cholmod;
pub mod cost;
mod dense;
mod direct;
mod error;
#[cfg(feature = "faer")]
mod faer;
#[cfg(feature = "mpi")]
mod help;
mod kernel;
#[cfg(feature = "petsc")]
mod multigrid;
#[cfg(feature = "mumps")]
mod mumps;
#[cfg(any(feature = "umfpack", feature = "mpi"))]
mod ordering;
#[cfg(feature = "petsc")]
mod petsc;
pub mod process;
#[cfg(feature = "mpi")]
pub mod ranks;
mod refine;
mod supernodal;
#[cfg(feature = "umfpack")]
mod sys;
#[cfg(feature = "umfpack")]
mod umfpack;
#[cfg(feature = "umfpack")]
mod versions;

#[cfg(feature = "faer")]
pub use self::faer::FaerLu;
pub use choice::{SparseCholesky, SparseLu};
pub use cholesky::{Cholesky, Reduced};
pub use dense::Lu;
pub use dense::{Dense, times_transposed};
pub use direct::{RefinedSolver, Statistics};
pub use error::LinearError;
#[cfg(feature = "mpi")]
pub use help::{RankRows, help};
pub use kernel::null_space_of;
#[cfg(feature = "petsc")]
pub use multigrid::{Contact, Form, Grid, Multigrid, share};
#[cfg(feature = "mumps")]
pub use mumps::Mumps;
pub use refine::{SolveInfo, backward_error, componentwise_error};
#[cfg(feature = "umfpack")]
pub use umfpack::{Strategy, Umfpack};
#[cfg(feature = "umfpack")]
pub use versions::{suitesparse_version, umfpack_version};

use serde::{Deserialize, Serialize};

/// What a factorisation tells about itself.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FactorInfo {
    /// Entries stored in the factors L and U, or a bound of them.
    pub entries: usize,
    /// Floating point operations; 0 if the backend does not tell.
    pub flops: f64,
    /// The smallest over the largest pivot, or what a backend has in its place: of the dense one the smallest pivot of the contact
    /// block over the size of its column, of faer's LU a bound of the reciprocal condition number, 1 of what iterates. For people
    /// only: a coarse sign of trouble, of which one backend says nothing to another. Whether a matrix is singular for all that is
    /// concluded from it, [`RefinedSolver::reciprocal_condition`] says, the same with every backend.
    pub pivot_ratio: f64,
    /// Peak memory of the factorisation, bytes; 0 if the backend does not tell.
    pub peak_bytes: f64,
}

/// A direct solver for square systems.
pub trait LinearSolver: Send {
    /// The name a report shows.
    fn name(&self) -> &'static str;

    /// Orders the unknowns and predicts the fill for `pattern`; once a run.
    ///
    /// # Errors
    /// When memory is short or the backend refuses the pattern.
    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError>;

    /// Factors the matrix with `values` on the analysed pattern; once an iteration.
    ///
    /// # Errors
    /// [`LinearError::Singular`] when a pivot vanishes, or when memory is short.
    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError>;

    /// Solves with the last factors, without refinement.
    ///
    /// # Errors
    /// When there are no factors, or the backend fails.
    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError>;

    /// [`LinearSolver::analyze`] for matrices like `a`, of which a dense or shared block may not be among compressed columns.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    fn analyze_system(&mut self, a: &SystemMatrix) -> Result<(), LinearError> {
        self.analyze(a.to_csc().pattern())
    }

    /// [`LinearSolver::factorize`] of `a`, likewise.
    ///
    /// # Errors
    /// As [`LinearSolver::factorize`].
    fn factorize_system(&mut self, a: &SystemMatrix) -> Result<FactorInfo, LinearError> {
        self.factorize(a.to_csc().values())
    }

    /// Whether it solves by iterations, of which each digit takes some.
    fn iterates(&self) -> bool {
        false
    }

    /// Solves to a residual of `tolerance` times `b`, or better; who does not iterate solves as ever.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    fn solve_to(&mut self, tolerance: f64, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let _ = tolerance;
        self.solve(b, x)
    }

    /// What the iterations came to since this was last asked.
    fn iterated(&mut self) -> Iterated {
        Iterated::default()
    }
}

/// What the iterations of a solver came to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Iterated {
    /// How many there were.
    pub iterations: usize,
    /// The direct solver that took over, if they stood still.
    pub instead: Option<SparseLu>,
}

/// What one of several processes of MPI has taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankUse {
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: u64,
}
