//! Work that all processes of an MPI launcher share: factorisations of MUMPS, a stiffness of which each process has
//! rows, and multigrid on it.

mod help;
#[cfg(feature = "petsc")]
mod multigrid;
#[cfg(feature = "mumps")]
mod mumps;
#[cfg(feature = "petsc")]
mod petsc;
pub mod ranks;

pub use help::{RankRows, help};
#[cfg(feature = "petsc")]
pub use multigrid::{Form, Grid, GridContact, Multigrid, share};
#[cfg(feature = "mumps")]
pub use mumps::Mumps;
