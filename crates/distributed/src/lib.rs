//! PETSc for `stickslip`: systems that all processes of an MPI launcher share. Ours is the elimination of contact;
//! PETSc has the distributed matrices, the Krylov method, the multigrid on the body, and MUMPS.
//!
//! [`add`] makes these solvers known to the library. Rank 0 then runs the program; the others call [`help`].

mod direct;
mod job;
mod multigrid;
mod petsc;
mod ranks;
mod rows;
mod stiffness;
mod system;

pub use ranks::{RankRows, agree, end, help, start};

use std::sync::Arc;

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::{self, Engine, Grid, LinearError, LinearSolver, RankUse, Stiffness};

use direct::Direct;
use multigrid::Multigrid;

/// The engine that [`add`] adds.
pub struct Petsc;

impl Engine for Petsc {
    fn ranks(&self) -> usize {
        ranks::count()
    }

    fn used(&self) -> Vec<RankUse> {
        ranks::used()
    }

    fn share(&self, body: Arc<dyn NodeRows>, near: &[bool], contacts: usize) -> Result<Option<Stiffness>, LinearError> {
        stiffness::share(body, near, contacts)
    }

    fn direct(&self) -> Box<dyn LinearSolver> {
        Box::new(Direct::default())
    }

    fn iterative(&self, grid: Grid, options: Option<&str>) -> Box<dyn LinearSolver> {
        Box::new(Multigrid::new(grid, options))
    }
}

/// Adds MUMPS, multigrid and PETSc to the solvers of the library in this process.
pub fn add() {
    linear::add_engine(&Petsc);
}

const NOT_ANALYZED: LinearError = LinearError::Order { missing: "analyze" };
const NOT_FACTORIZED: LinearError = LinearError::Order { missing: "factorize" };

/// Returns an error unless both lengths agree.
fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), LinearError> {
    if expected == found { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
}
