//! The factorisations of this build.

use serde::{Deserialize, Serialize};

use super::{LinearSolver, Partial, built_in, engine};
use crate::base::displayed_as_written;

/// A direct solver of the uncondensed system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SparseLu {
    /// UMFPACK from SuiteSparse.
    Umfpack,
    /// MUMPS, on all MPI processes.
    Mumps,
    /// faer's LU: pure Rust, slower on large meshes.
    Faer,
    /// The interior of the body by a Cholesky factorisation once a run, contact by a dense LU.
    Partial,
}

/// A sparse Cholesky factorisation, for a stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SparseCholesky {
    /// CHOLMOD from SuiteSparse.
    Cholmod,
    /// faer's Cholesky factorisation: pure Rust.
    Faer,
}

impl Default for SparseLu {
    /// Returns UMFPACK if it is built in, otherwise MUMPS, otherwise faer.
    fn default() -> Self {
        let by_speed = [SparseLu::Umfpack, SparseLu::Mumps];
        by_speed.into_iter().find(|lu| lu.is_built_in()).unwrap_or(SparseLu::Faer)
    }
}

impl Default for SparseCholesky {
    /// Returns CHOLMOD if it is built in, otherwise faer.
    fn default() -> Self {
        if cfg!(feature = "umfpack") { SparseCholesky::Cholmod } else { SparseCholesky::Faer }
    }
}

impl SparseLu {
    /// Returns `true` if this build includes it, which depends on the cargo features, or the program has added it.
    pub fn is_built_in(self) -> bool {
        match self {
            SparseLu::Umfpack => cfg!(feature = "umfpack"),
            SparseLu::Mumps => engine().is_some(),
            SparseLu::Faer => cfg!(feature = "faer"),
            SparseLu::Partial => SparseCholesky::default().is_built_in(),
        }
    }

    /// Returns the default; if there are several MPI processes and MUMPS is built in, MUMPS, which all of them share.
    pub fn for_ranks() -> Self {
        if built_in::ranks() > 1 && SparseLu::Mumps.is_built_in() { SparseLu::Mumps } else { SparseLu::default() }
    }

    /// Creates the solver. If it is not built in, its analysis returns an error.
    pub fn solver(self) -> Box<dyn LinearSolver> {
        self.solver_for(false)
    }

    /// Creates the solver, with `many_in_the_plane` for ten or more factorisations of a plane body. UMFPACK then
    /// takes the best of several orderings: at n = 400 its factorisations take 0.7 of the time, and the ordering
    /// takes one second more.
    pub fn solver_for(self, many_in_the_plane: bool) -> Box<dyn LinearSolver> {
        match self {
            SparseLu::Umfpack => built_in::umfpack(many_in_the_plane),
            SparseLu::Mumps => built_in::mumps(),
            SparseLu::Faer => built_in::faer(),
            SparseLu::Partial => Box::new(Partial::default()),
        }
    }
}

impl SparseCholesky {
    /// Returns `true` if this build includes it, which depends on the cargo features.
    pub fn is_built_in(self) -> bool {
        match self {
            SparseCholesky::Cholmod => cfg!(feature = "umfpack"),
            SparseCholesky::Faer => cfg!(feature = "faer"),
        }
    }
}

displayed_as_written!(SparseLu, SparseCholesky);
