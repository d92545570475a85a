//! Decides which models have a stiffness in rows of nodes, distributed to one or more MPI processes: those solved by
//! multigrid.

use crate::body::model::Share;
use crate::solver::history::SolverChoice;

/// Returns the distribution of the stiffness of a model solved by `solver`; `None` if it needs no rows.
#[cfg(feature = "petsc")]
pub(super) fn share(solver: &SolverChoice) -> Option<Share<'static>> {
    use crate::solver::history::LinearAlgebra;

    let wants_rows = solver.linear == Some(LinearAlgebra::Multigrid) && !solver.method.is_exact_path();
    wants_rows.then_some(&crate::algebra::linear::share)
}

#[cfg(not(feature = "petsc"))]
pub(super) fn share(_solver: &SolverChoice) -> Option<Share<'static>> {
    None
}
