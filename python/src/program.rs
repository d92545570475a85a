//! The program `stickslip`, which the wheel installs as a command.

use pyo3::prelude::*;
use std::ffi::OsString;
use stickslip::algebra::linear::process::OrderlyEnd;
use stickslip_cli::commands::{Invocation, main};

/// Makes the program end with a message and its own exit status if memory is refused.
#[global_allocator]
static ALLOCATOR: OrderlyEnd = OrderlyEnd;

/// Runs the program with these arguments, as `program` starts it again, and returns its exit status.
#[pyfunction]
pub(crate) fn program(py: Python<'_>, program: Vec<OsString>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| main(Invocation { program, arguments }) as u8)
}
