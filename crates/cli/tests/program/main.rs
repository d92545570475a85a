//! Tests of the program as called by a user.

#[path = "../../../../tests/common/mod.rs"]
mod common;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/whole.rs"]
mod whole;

mod blas_kernel;
mod capacity;
mod check;
mod cli;
mod cli_failures;
mod compare;
mod compare_elements;
mod compare_meshes;
mod compare_resumed;
mod converge;
mod cube;
mod disk;
mod documented;
mod documented_commands;
mod documented_units;
mod events;
mod examples;
mod exchange;
mod folder;
mod memory_limits;
mod names;
mod outputs;
mod report;
mod resume;
mod schema;
mod solvability;
mod start;
mod sweep;
mod threads;
mod units;
mod versions;
