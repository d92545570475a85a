//! The command line program: see `stickslip --help`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
