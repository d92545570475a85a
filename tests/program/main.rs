//! The program, as it is called.

#[path = "../common/mod.rs"]
mod common;

mod cli;
mod cli_failures;
mod compare;
mod documented;
mod names;
mod schema;
mod solvability;
mod start;
mod units;
