//! Tests of the feature `petsc`, which leads to the same results by other solvers. It is not on by default: see
//! `make petsc`.

#![cfg(feature = "petsc")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/whole.rs"]
mod whole;

#[cfg(target_os = "linux")]
mod job;
mod multigrid;
mod mumps;
#[cfg(target_os = "linux")]
mod options;
#[cfg(target_os = "linux")]
mod pieces;
#[cfg(target_os = "linux")]
mod ranks;
mod scenes;
#[cfg(target_os = "linux")]
mod shared;
