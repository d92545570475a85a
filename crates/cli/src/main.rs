//! The command line program: see `stickslip --help`.

mod commands;

use stickslip::algebra::linear::process::OrderlyEnd;

/// Makes the program end with a message and its own exit status if memory is refused.
#[global_allocator]
static ALLOCATOR: OrderlyEnd = OrderlyEnd;

fn main() -> std::process::ExitCode {
    commands::main()
}
