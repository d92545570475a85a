//! PETSc for `stickslip`: factorisations of MUMPS, and multigrid on a stiffness of which each process of an MPI launcher
//! has rows.
//!
//! [`add`] makes these solvers known to the library. Rank 0 then runs the program; the others call [`help`].

mod help;
mod multigrid;
mod mumps;
mod petsc;
pub mod ranks;

pub use help::{RankRows, help};

use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::{self, Engine, Grid, LinearError, LinearSolver, RankUse, Stiffness};

use multigrid::Multigrid;
use stickslip::solver::ContactProblem;

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
        multigrid::share(body, near)
    }

    fn direct(&self) -> Box<dyn LinearSolver> {
        Box::new(mumps::Mumps::default())
    }

    fn iterative(&self, stiffness: &Stiffness, grid: Grid) -> Box<dyn LinearSolver> {
        Box::new(Multigrid::of(stiffness, grid))
    }
}

/// Creates the iterative solver of the systems of `problem`, whose unknowns have the positions in `grid`.
pub fn multigrid(problem: &ContactProblem, grid: Grid) -> Box<dyn LinearSolver> {
    Petsc.iterative(problem.stiffness(), grid)
}

/// Adds MUMPS and multigrid to the solvers of the library in this process.
pub fn add() {
    linear::add_engine(&Petsc);
}

/// Returns an error unless both lengths agree.
fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), LinearError> {
    if expected == found { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
}

/// Returns an error if one of `values` is NaN or infinite.
fn expect_finite(values: &[f64]) -> Result<(), LinearError> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(LinearError::NotFinite) }
}
