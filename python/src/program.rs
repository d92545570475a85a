//! The program `stickslip`, which the wheel installs as a command.

use pyo3::prelude::*;
use std::ffi::OsString;
use stickslip_cli::commands::{Invocation, main};

/// Runs the program with these arguments, as `program` starts it again, and returns its exit status.
#[pyfunction]
pub(crate) fn program(py: Python<'_>, program: Vec<OsString>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| main(Invocation { program, arguments }) as u8)
}
