//! Tests of the features `mumps` and `petsc`, which lead to the same results by other solvers. Neither is on by
//! default: see `make mumps` and `make petsc`.

#![cfg(any(feature = "mumps", feature = "petsc"))]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/whole.rs"]
mod whole;

#[cfg(target_os = "linux")]
mod job;
#[cfg(feature = "petsc")]
mod multigrid;
#[cfg(feature = "mumps")]
mod mumps;
#[cfg(all(feature = "petsc", target_os = "linux"))]
mod pieces;
#[cfg(target_os = "linux")]
mod ranks;
mod scenes;
#[cfg(all(feature = "petsc", target_os = "linux"))]
mod shared;
