//! The command line program: see `stickslip --help`.

use std::env;
use std::process::ExitCode;
use stickslip::algebra::linear::process::ReportingAllocator;
use stickslip_cli::commands::{Invocation, main as run};

/// Makes the program end with a message and its own exit status if memory is refused.
#[global_allocator]
static ALLOCATOR: ReportingAllocator = ReportingAllocator;

fn main() -> ExitCode {
    let mut arguments = env::args_os();
    let name = arguments.next();
    // On systems that do not say where a program lies, the name under which it was started finds it.
    let program = env::current_exe().map(Into::into).ok().or(name).into_iter().collect();
    ExitCode::from(run(Invocation { program, arguments: arguments.collect() }) as u8)
}
