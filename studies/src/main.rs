//! The studies as a program: see `stickslip-studies --help`.
//!
//! Exit status: 0 everything came out as it should, 1 something did not, 2 the command could not be carried out.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
