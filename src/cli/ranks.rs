//! Several processes of this program, which a launcher of MPI has started side by side: rank 0 is the program, the others help it with
//! the factorisations of MUMPS and the cycles of multigrid.

use std::env;
use std::process::ExitCode;

use clap::FromArgMatches;
use stickslip::history::LinearAlgebra;
use stickslip::linear::{self, ranks};
use stickslip::sparse::NodeRows;

use super::{Cli, Command, Failure, interrupt, memory, output, program, threads};

/// What launchers tell of a process: Open MPI's mpirun, MPICH's, Slurm's srun with PMIx.
const RANK: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"];

/// The rank of this process, if a launcher has started it. MPI itself is not asked: to start it costs time.
fn rank() -> Option<usize> {
    RANK.iter().find_map(|name| env::var(name).ok()?.parse().ok())
}

/// Whether this process is there to help another one.
pub(super) fn helps() -> bool {
    rank().is_some_and(|rank| rank > 0)
}

/// All that a process does which helps.
pub(super) fn help() -> ExitCode {
    let code = helped();
    memory::exits();
    code
}

/// Helps; with commands that solve nothing there is nothing to do. What is wrong, rank 0 says.
fn helped() -> ExitCode {
    // Whatever is to end in order, rank 0 sees to it; and it can only if its helpers are there.
    interrupt::disregard();
    memory::end_in_order(false);
    let matches = program().try_get_matches();
    let cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2)),
    };
    let Command::Run(args) = &cli.command else { return ExitCode::SUCCESS };
    // It may start the program once more, here as on rank 0.
    if cli.kernel_before().is_err() {
        return ExitCode::from(2);
    }
    threads::start(threads::count(cli.threads));
    // Each assembles rows of its own, of the body that rank 0 has.
    let mut body = || match args.body() {
        Ok(body) => body.map(|body| Box::new(body) as Box<dyn NodeRows>),
        Err(error) => {
            output::note(&error);
            None
        }
    };
    match linear::help(&mut body) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            output::note(&error.to_string());
            ExitCode::from(3)
        }
    }
}

/// On rank 0: how many processes there are, MPI being started if a launcher has been at work.
pub(super) fn lead() -> Result<usize, Failure> {
    if rank().is_none() {
        return Ok(1);
    }
    let (_, count) = ranks::start().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
    Ok(count)
}

/// An error unless `linear`, if it is known already, has work for `count` processes.
pub(super) fn check(count: usize, linear: Option<LinearAlgebra>) -> Result<(), Failure> {
    match linear {
        Some(linear) if count > 1 && !linear.is_shared() => {
            let help = "use --solver mumps, in space multigrid, or auto, or start the program without the launcher";
            Err(Failure::Input(miette::miette!(
                help = help,
                "a launcher of MPI has started this program {count} times, and {linear} works in one process"
            )))
        }
        _ => Ok(()),
    }
}

/// An error if a launcher has started a `command` that shares its work among processes or threads of its own.
pub(super) fn refuse(command: &str) -> Result<(), Failure> {
    if rank().is_none() {
        return Ok(());
    }
    let help =
        "start the program without the launcher: it takes all processors of the machine, or as many as --threads says";
    Err(Failure::Input(miette::miette!(
        help = help,
        "a launcher of MPI has started {command}, which has no use for ranks"
    )))
}
