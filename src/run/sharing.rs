//! Which models have a stiffness in rows of nodes, shared by the processes of MPI, be it one: those that multigrid solves.

use crate::body::model::Share;
use crate::solver::history::SolverChoice;

/// What shares the stiffness of a model that `solver` solves, if it wants one in rows.
#[cfg(feature = "petsc")]
pub(super) fn share(solver: &SolverChoice) -> Option<Share<'static>> {
    use crate::solver::history::{LinearAlgebra, Method};

    let wants_rows = solver.linear == Some(LinearAlgebra::Multigrid) && !matches!(solver.method, Method::Events { .. });
    wants_rows.then_some(&crate::algebra::linear::share)
}

#[cfg(not(feature = "petsc"))]
pub(super) fn share(_solver: &SolverChoice) -> Option<Share<'static>> {
    None
}
