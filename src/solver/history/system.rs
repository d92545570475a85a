//! The linear system of an iteration: whole, or condensed to the contact displacements.

use crate::algebra::linear::{
    Cholesky, FactorInfo, LinearSolver, RefinedSolver, SparseCholesky, SparseLu, Statistics, built_in, engine,
};
use crate::solver::condensation::Condensation;
use serde::{Serialize, Serializer};
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// The form of the linear systems of a run, and the solver for them.
///
/// All forms give the same solution. Condensation is by far the fastest if few displacements are in contact and an
/// increment takes several iterations. It needs memory for the square of their number, and as many solves with `K` in
/// advance. The whole system has no such limit. [`crate::run::Choice`] decides by the sizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LinearAlgebra {
    /// The uncondensed system on all displacements and contact forces.
    Whole(SparseLu),
    /// Static condensation: the displacements without contact are eliminated once a run.
    Condensed(SparseCholesky),
    /// The uncondensed system by GMRES, preconditioned by algebraic multigrid including contact, without
    /// factorisation: for bodies that are too large for the others.
    Multigrid,
    /// The uncondensed system by a solver of PETSc, as options say; without any it is that of multigrid.
    Petsc,
}

impl LinearAlgebra {
    /// The variants that need nothing but the matrix, each with its word in scenes and reports.
    pub const WORDS: [(&'static str, LinearAlgebra); 6] = [
        ("umfpack", LinearAlgebra::Whole(SparseLu::Umfpack)),
        ("mumps", LinearAlgebra::Whole(SparseLu::Mumps)),
        ("faer", LinearAlgebra::Whole(SparseLu::Faer)),
        ("partial", LinearAlgebra::Whole(SparseLu::Partial)),
        ("condensed-cholmod", LinearAlgebra::Condensed(SparseCholesky::Cholmod)),
        ("condensed-faer", LinearAlgebra::Condensed(SparseCholesky::Faer)),
    ];

    /// Returns condensation by the Cholesky factorisation of this build.
    pub fn condensed() -> Self {
        LinearAlgebra::Condensed(SparseCholesky::default())
    }

    /// Returns `true` if the body is condensed.
    pub fn condenses(self) -> bool {
        matches!(self, LinearAlgebra::Condensed(_))
    }

    /// Returns `true` if this build includes the solver, which depends on the cargo features, or the program has added
    /// it.
    pub fn is_built_in(self) -> bool {
        match self {
            LinearAlgebra::Whole(lu) => lu.is_built_in(),
            LinearAlgebra::Condensed(cholesky) => cholesky.is_built_in(),
            LinearAlgebra::Multigrid | LinearAlgebra::Petsc => engine().is_some(),
        }
    }
}

impl Default for LinearAlgebra {
    /// Returns the uncondensed system with the sparse LU of this build.
    fn default() -> Self {
        LinearAlgebra::Whole(SparseLu::default())
    }
}

impl LinearAlgebra {
    /// Returns `true` if several MPI processes share the work.
    pub fn is_shared(self) -> bool {
        matches!(self, LinearAlgebra::Whole(SparseLu::Mumps)) || self.iterates()
    }

    /// Returns `true` if the system is solved by iterations, which need the positions of the unknowns.
    pub fn iterates(self) -> bool {
        matches!(self, LinearAlgebra::Multigrid | LinearAlgebra::Petsc)
    }
}

impl fmt::Display for LinearAlgebra {
    /// Writes the word of [`LinearAlgebra::WORDS`], or `condensed` for this build's condensation.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearAlgebra::Whole(lu) => lu.fmt(f),
            LinearAlgebra::Multigrid => f.write_str("multigrid"),
            LinearAlgebra::Petsc => f.write_str("petsc"),
            condensed if *condensed == LinearAlgebra::condensed() => f.write_str("condensed"),
            LinearAlgebra::Condensed(cholesky) => write!(f, "condensed-{cholesky}"),
        }
    }
}

impl FromStr for LinearAlgebra {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let others = [
            ("condensed", Self::condensed()),
            ("multigrid", LinearAlgebra::Multigrid),
            ("petsc", LinearAlgebra::Petsc),
        ];
        let known = Self::WORDS.into_iter().chain(others).find(|(known, _)| *known == word);
        known.map(|(_, linear)| linear).ok_or_else(|| {
            "it is one of umfpack, mumps, faer, partial, condensed, condensed-cholmod, condensed-faer, multigrid and petsc"
                .to_string()
        })
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
    /// The uncondensed system, with this solver.
    Whole(RefinedSolver),
    /// The system on the contact displacements.
    Condensed(Condensation),
}

impl Default for SystemSolver {
    fn default() -> Self {
        LinearAlgebra::default().into()
    }
}

impl From<LinearAlgebra> for SystemSolver {
    /// Creates the system of a choice. Multigrid needs the positions of the unknowns: for a model see
    /// [`crate::run::Run`].
    fn from(choice: LinearAlgebra) -> Self {
        match choice {
            LinearAlgebra::Whole(lu) => SystemSolver::from(lu.solver()),
            LinearAlgebra::Condensed(cholesky) => SystemSolver::Condensed(cholesky.into()),
            LinearAlgebra::Multigrid | LinearAlgebra::Petsc => SystemSolver::from(built_in::without_grid()),
        }
    }
}

impl From<Box<dyn LinearSolver>> for SystemSolver {
    /// Creates the uncondensed system with a caller's solver.
    fn from(solver: Box<dyn LinearSolver>) -> Self {
        SystemSolver::Whole(RefinedSolver::new(solver))
    }
}

impl SystemSolver {
    /// Creates the system on the contact displacements. It can reuse the `factor` of `K` with the contact
    /// displacements last.
    pub(crate) fn condensed(cholesky: SparseCholesky, factor: Option<Arc<Cholesky>>) -> Self {
        SystemSolver::Condensed(Condensation::factored(cholesky, factor))
    }

    /// Returns the name shown in reports.
    pub fn name(&self) -> String {
        match self {
            SystemSolver::Whole(linear) => linear.name().to_string(),
            SystemSolver::Condensed(condensation) => LinearAlgebra::Condensed(condensation.cholesky()).to_string(),
        }
    }

    /// Returns `true` if the body is condensed.
    pub fn condenses(&self) -> bool {
        matches!(self, SystemSolver::Condensed(_))
    }
}

/// Combines the statistics of the linear solver with the factors of a condensed body and the backward error of the
/// whole system.
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
