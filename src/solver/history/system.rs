//! How the linear system of an iteration is set up: whole, or condensed to the contact displacements.

use crate::algebra::linear::{
    Cholesky, FactorInfo, LinearSolver, RefinedSolver, SparseCholesky, SparseLu, Statistics, built_in,
};
use crate::solver::condensation::Condensation;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// How the linear systems of a run are set up, and what factors them.
///
/// All give the same answer. Condensed is faster by far where few displacements are in contact and an increment takes
/// several iterations; it needs memory for the square of their number, and for as many solves with `K` beforehand. The whole
/// system has no such limit. Where nobody knows, [`crate::run::auto`] counts both and takes the cheaper one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LinearAlgebra {
    /// The uncondensed system on all displacements and contact forces.
    Whole(SparseLu),
    /// Static condensation: what no contact touches is eliminated once a run.
    Condensed(SparseCholesky),
    /// The uncondensed system by GMRES, with contact inside algebraic multigrid, which factors nothing: for bodies that are too large for
    /// the others.
    Multigrid,
}

impl LinearAlgebra {
    /// All that need nothing but the matrix, each with the word that scenes and reports have for it.
    pub const WORDS: [(&'static str, LinearAlgebra); 5] = [
        ("umfpack", LinearAlgebra::Whole(SparseLu::Umfpack)),
        ("mumps", LinearAlgebra::Whole(SparseLu::Mumps)),
        ("faer", LinearAlgebra::Whole(SparseLu::Faer)),
        ("condensed-cholmod", LinearAlgebra::Condensed(SparseCholesky::Cholmod)),
        ("condensed-faer", LinearAlgebra::Condensed(SparseCholesky::Faer)),
    ];

    /// Condensed by the Cholesky factorisation of this build.
    pub fn condensed() -> Self {
        LinearAlgebra::Condensed(SparseCholesky::default())
    }

    /// Whether the body is condensed.
    pub fn condenses(self) -> bool {
        matches!(self, LinearAlgebra::Condensed(_))
    }

    /// Whether this build has it, which the cargo features decide.
    pub fn is_built_in(self) -> bool {
        match self {
            LinearAlgebra::Whole(lu) => lu.is_built_in(),
            LinearAlgebra::Condensed(cholesky) => cholesky.is_built_in(),
            LinearAlgebra::Multigrid => cfg!(feature = "petsc"),
        }
    }
}

impl Default for LinearAlgebra {
    /// The uncondensed system, by the sparse LU of this build.
    fn default() -> Self {
        LinearAlgebra::Whole(SparseLu::default())
    }
}

impl LinearAlgebra {
    /// Whether several processes of MPI share its work.
    pub fn is_shared(self) -> bool {
        matches!(self, LinearAlgebra::Whole(SparseLu::Mumps) | LinearAlgebra::Multigrid)
    }
}

impl fmt::Display for LinearAlgebra {
    /// The word of [`LinearAlgebra::WORDS`], and `condensed` for what that is in this build.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearAlgebra::Whole(lu) => lu.fmt(f),
            LinearAlgebra::Multigrid => f.write_str("multigrid"),
            condensed if *condensed == LinearAlgebra::condensed() => f.write_str("condensed"),
            LinearAlgebra::Condensed(cholesky) => write!(f, "condensed-{cholesky}"),
        }
    }
}

/// A word that names no linear algebra.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("it is one of umfpack, mumps, faer, condensed, condensed-cholmod, condensed-faer and multigrid")]
pub struct UnknownLinearAlgebra;

impl FromStr for LinearAlgebra {
    type Err = UnknownLinearAlgebra;

    fn from_str(word: &str) -> Result<Self, Self::Err> {
        let known =
            Self::WORDS.into_iter().chain([("condensed", Self::condensed()), ("multigrid", LinearAlgebra::Multigrid)]);
        known.into_iter().find(|(known, _)| *known == word).map(|(_, linear)| linear).ok_or(UnknownLinearAlgebra)
    }
}

impl Serialize for LinearAlgebra {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The linear system of a run.
#[allow(clippy::large_enum_variant)] // There is one of it.
pub enum SystemSolver {
    /// The uncondensed one, with this solver.
    Whole(RefinedSolver),
    /// The one on the contact displacements.
    Condensed(Condensation),
}

impl Default for SystemSolver {
    fn default() -> Self {
        LinearAlgebra::default().into()
    }
}

impl From<LinearAlgebra> for SystemSolver {
    /// The system of a choice. Multigrid has to know where the unknowns are: of a model, see [`crate::run::Run`]; otherwise from
    /// `linear::Multigrid`.
    fn from(choice: LinearAlgebra) -> Self {
        match choice {
            LinearAlgebra::Whole(lu) => SystemSolver::from(lu.solver()),
            LinearAlgebra::Condensed(cholesky) => SystemSolver::Condensed(cholesky.into()),
            LinearAlgebra::Multigrid => SystemSolver::from(built_in::without_grid()),
        }
    }
}

impl From<Box<dyn LinearSolver>> for SystemSolver {
    /// The uncondensed system with a solver of one's own.
    fn from(solver: Box<dyn LinearSolver>) -> Self {
        SystemSolver::Whole(RefinedSolver::new(solver))
    }
}

impl SystemSolver {
    /// The one on the contact displacements, where the factors of `K` with those of all contact nodes last may be there already.
    pub(crate) fn condensed(cholesky: SparseCholesky, factor: Option<Arc<Cholesky>>) -> Self {
        SystemSolver::Condensed(Condensation::factored(cholesky, factor))
    }

    /// The name a report shows.
    pub fn name(&self) -> String {
        match self {
            SystemSolver::Whole(linear) => linear.name().to_string(),
            SystemSolver::Condensed(condensation) => LinearAlgebra::Condensed(condensation.cholesky()).to_string(),
        }
    }

    /// Whether the body is condensed.
    pub fn condenses(&self) -> bool {
        matches!(self, SystemSolver::Condensed(_))
    }
}

/// What the linear algebra did, the factors of a condensed body and the backward error of the whole system included.
pub(super) fn statistics(linear: Statistics, body: Option<FactorInfo>, backward_error: f64) -> Statistics {
    let mut statistics = linear;
    if let Some(body) = body {
        let last = statistics.factor;
        let flops = if statistics.factorizations == 0 { body.flops } else { last.flops };
        let pivot_ratio = if statistics.factorizations == 0 { body.pivot_ratio } else { last.pivot_ratio };
        statistics.factor = FactorInfo {
            entries: body.entries + last.entries,
            peak_bytes: body.peak_bytes + last.peak_bytes,
            flops,
            pivot_ratio,
        };
    }
    statistics.worst_backward_error = statistics.worst_backward_error.max(backward_error);
    statistics
}
