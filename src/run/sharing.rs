//! Decides which models have a stiffness in rows of nodes, distributed to one or more processes: those solved by
//! multigrid.

use crate::algebra::linear::{Engine, engine};
use crate::solver::history::{LinearAlgebra, SolverChoice};

/// Returns the engine that distributes the stiffness of a model solved by `solver`; `None` if it needs no rows.
pub(super) fn share(solver: &SolverChoice) -> Option<&'static dyn Engine> {
    let wants_rows = solver.linear.is_some_and(LinearAlgebra::iterates) && !solver.method.is_exact_path();
    engine().filter(|_| wants_rows)
}
