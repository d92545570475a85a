//! PETSc for `stickslip`: systems that all processes of an MPI launcher share. Ours is the elimination of contact;
//! PETSc has the distributed matrices, the Krylov method, the multigrid on the body, and MUMPS.
//!
//! [`add`] makes these solvers known to the library. Rank 0 then runs the program; the others call [`help`].

mod direct;
mod exchange;
mod job;
mod multigrid;
mod petsc;
mod ranks;
mod rows;
mod stiffness;
mod system;

pub use ranks::{RankRows, agree, end, help, start};

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::{self, Engine, Grid, LinearError, LinearSolver, RankUse, Stiffness};

use direct::Direct;
use multigrid::Multigrid;

/// The engine that [`add`] adds.
struct Petsc;

impl Engine for Petsc {
    fn ranks(&self) -> usize {
        ranks::count()
    }

    fn used(&self) -> Vec<RankUse> {
        ranks::used()
    }

    fn share(&self, body: &dyn NodeRows, near: &[bool]) -> Result<Option<Stiffness>, LinearError> {
        stiffness::share(body, near)
    }

    fn direct(&self) -> Box<dyn LinearSolver> {
        Box::new(Direct::default())
    }

    fn iterative(&self, stiffness: &Stiffness, grid: Grid, options: Option<&str>) -> Box<dyn LinearSolver> {
        Box::new(Multigrid::new(stiffness, grid, options))
    }
}

/// Creates the iterative solver of systems with this `stiffness`, whose unknowns have the positions in `grid`.
pub fn multigrid(stiffness: &Stiffness, grid: Grid) -> Box<dyn LinearSolver> {
    Petsc.iterative(stiffness, grid, None)
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
