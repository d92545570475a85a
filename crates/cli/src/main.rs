//! The command line program: see `stickslip --help`.

mod commands;

use stickslip::algebra::linear::process::OrderlyEnd;

/// Where memory is refused the program ends with a message and a status of its own.
#[global_allocator]
static ALLOCATOR: OrderlyEnd = OrderlyEnd;

fn main() -> std::process::ExitCode {
    commands::main()
}
