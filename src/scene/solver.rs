//! The names of methods and linear algebra in a scene.

use serde::Deserialize;

use crate::solver::history::{self, LinearAlgebra};

/// The name of an algorithm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum MethodName {
    #[default]
    Bn,
    Ip,
    Events,
}

/// The name of a set of constants and scalings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Setting {
    Paper,
    #[default]
    Default,
}

/// The starting point of the paper's interior point method in an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Start {
    #[default]
    Safe,
    Prev,
}

/// The linear algebra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum LinearName {
    Umfpack,
    Mumps,
    Faer,
    Partial,
    Condensed,
    CondensedCholmod,
    CondensedFaer,
    Multigrid,
    Auto,
}

impl Start {
    pub(super) fn constants(self) -> history::Start {
        match self {
            Start::Safe => history::Start::Safe,
            Start::Prev => history::Start::PREV,
        }
    }
}

impl LinearName {
    /// Returns the named linear algebra; `None` for `auto`.
    pub(super) fn algebra(self) -> Option<LinearAlgebra> {
        use crate::algebra::linear::{SparseCholesky, SparseLu};
        Some(match self {
            LinearName::Umfpack => LinearAlgebra::Whole(SparseLu::Umfpack),
            LinearName::Mumps => LinearAlgebra::Whole(SparseLu::Mumps),
            LinearName::Faer => LinearAlgebra::Whole(SparseLu::Faer),
            LinearName::Partial => LinearAlgebra::Whole(SparseLu::Partial),
            LinearName::Condensed => LinearAlgebra::condensed(),
            LinearName::CondensedCholmod => LinearAlgebra::Condensed(SparseCholesky::Cholmod),
            LinearName::CondensedFaer => LinearAlgebra::Condensed(SparseCholesky::Faer),
            LinearName::Multigrid => LinearAlgebra::Multigrid,
            LinearName::Auto => return None,
        })
    }
}
