//! The factorisations of this build by name.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::{LinearSolver, built_in};

/// A sparse LU factorisation, for the uncondensed system.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SparseLu {
    /// UMFPACK of SuiteSparse.
    Umfpack,
    /// MUMPS, on all processes that MPI has started.
    Mumps,
    /// faer's: no library but Rust's, slower on large meshes.
    Faer,
}

/// A sparse Cholesky factorisation, for a stiffness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SparseCholesky {
    /// CHOLMOD of SuiteSparse.
    Cholmod,
    /// faer's: no library but Rust's.
    Faer,
}

impl Default for SparseLu {
    /// UMFPACK where it is built in, otherwise MUMPS, otherwise faer.
    fn default() -> Self {
        let by_speed = [SparseLu::Umfpack, SparseLu::Mumps];
        by_speed.into_iter().find(|lu| lu.is_built_in()).unwrap_or(SparseLu::Faer)
    }
}

impl Default for SparseCholesky {
    /// CHOLMOD where it is built in, otherwise faer.
    fn default() -> Self {
        if cfg!(feature = "umfpack") { SparseCholesky::Cholmod } else { SparseCholesky::Faer }
    }
}

impl SparseLu {
    /// Whether this build has it, which the cargo features decide.
    pub fn is_built_in(self) -> bool {
        match self {
            SparseLu::Umfpack => cfg!(feature = "umfpack"),
            SparseLu::Mumps => cfg!(feature = "mumps"),
            SparseLu::Faer => cfg!(feature = "faer"),
        }
    }

    /// The default one; where there are several processes MUMPS, if it is built in, which all of them share.
    pub fn for_ranks() -> Self {
        if built_in::ranks() > 1 && SparseLu::Mumps.is_built_in() { SparseLu::Mumps } else { SparseLu::default() }
    }

    /// A solver; one that is not built in says so when it is to analyse.
    pub fn solver(self) -> Box<dyn LinearSolver> {
        self.solver_for(false)
    }

    /// The same, if `many_in_the_plane` for ten or more factorisations of a body in the plane. UMFPACK then takes the best of
    /// several orders: at n = 400 its factorisations take 0.7 of the time, and ordering a second more.
    pub fn solver_for(self, many_in_the_plane: bool) -> Box<dyn LinearSolver> {
        match self {
            SparseLu::Umfpack => built_in::umfpack(many_in_the_plane),
            SparseLu::Mumps => built_in::mumps(),
            SparseLu::Faer => built_in::faer(),
        }
    }
}

impl SparseCholesky {
    /// Whether this build has it, which the cargo features decide.
    pub fn is_built_in(self) -> bool {
        match self {
            SparseCholesky::Cholmod => cfg!(feature = "umfpack"),
            SparseCholesky::Faer => cfg!(feature = "faer"),
        }
    }
}

impl fmt::Display for SparseLu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SparseLu::Umfpack => "umfpack",
            SparseLu::Mumps => "mumps",
            SparseLu::Faer => "faer",
        })
    }
}

impl fmt::Display for SparseCholesky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            SparseCholesky::Cholmod => "cholmod",
            SparseCholesky::Faer => "faer",
        })
    }
}
