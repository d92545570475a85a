//! Several processes of this program, which a launcher of MPI has started side by side: rank 0 is the program, the others help it with
//! the factorisations of MUMPS and the cycles of multigrid.

use std::env;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::process::ExitCode;

use clap::FromArgMatches;
use stickslip::algebra::linear::{self, LinearError, ranks};
use stickslip::algebra::sparse::NodeRows;
use stickslip::solver::history::LinearAlgebra;

use super::{Cli, Command, Failure, interrupt, memory, output, program, threads};

/// What launchers tell of a process: Open MPI's mpirun, MPICH's, Slurm's srun with PMIx.
const RANK: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"];

/// The rank of this process, if a launcher has started it. MPI itself is not asked: to start it costs time.
fn rank() -> Option<usize> {
    RANK.iter().find_map(|name| env::var(name).ok()?.parse().ok())
}

/// Whether a launcher has started this process to help another one, as far as the environment tells.
pub(super) fn may_help() -> bool {
    rank().is_some_and(|rank| rank > 0)
}

/// All that a process does which helps; none if MPI knows of no other one, as in a job of somebody else's that this program is started from.
pub(super) fn help() -> Option<ExitCode> {
    let code = helped();
    if code.is_some() {
        memory::exits();
    }
    code
}

/// Helps rank 0, whatever its command. What is wrong, rank 0 says in full.
fn helped() -> Option<ExitCode> {
    // Arguments that cannot be read rank 0 is told of, or this process once it is known that it has none.
    let cli = program().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)).ok();
    // It may start the program once more, here as on rank 0.
    if cli.as_ref().is_some_and(|cli| cli.kernel_before().is_err()) {
        output::note("a process that was started to help another one cannot choose the kernel of its BLAS");
        return Some(ExitCode::from(2));
    }
    let failed = |error: &LinearError| {
        output::note(&error.to_string());
        Some(ExitCode::from(3))
    };
    let rank = match ranks::start() {
        Ok((0, _)) => return None,
        Ok((rank, _)) => rank,
        Err(error) => return failed(&error),
    };
    // Whatever is to end in order, rank 0 sees to it; and it can only if its helpers are there.
    interrupt::disregard();
    memory::end_in_order(false);
    let count = threads::count(cli.as_ref().and_then(|cli| cli.threads));
    threads::start(count);
    threads::let_the_blas_have(threads::of_this_rank(count));
    match ranks::agree(arguments()) {
        Ok(true) => {}
        Ok(false) => {
            output::note(&format!("rank {rank} was started with other arguments than rank 0, whose are obeyed"));
        }
        Err(error) => return failed(&error),
    }
    // Each assembles rows of its own, of the body that rank 0 has.
    let mut body = || {
        let Command::Run(args) = &cli.as_ref()?.command else { return None };
        match args.body() {
            Ok(body) => body.map(|body| Box::new(body) as Box<dyn NodeRows>),
            Err(error) => {
                output::note(&format!("rank {rank}: {error}"));
                None
            }
        }
    };
    match linear::help(&mut body) {
        Ok(()) => Some(ExitCode::SUCCESS),
        Err(error) => failed(&error),
    }
}

/// A number for the arguments of this process.
fn arguments() -> u64 {
    let mut hasher = DefaultHasher::new();
    env::args_os().skip(1).for_each(|argument| argument.hash(&mut hasher));
    hasher.finish()
}

/// On rank 0: how many processes there are, MPI being started if a launcher has been at work, whose other processes wait for that.
pub(super) fn lead() -> Result<usize, Failure> {
    if rank().is_none() {
        return Ok(1);
    }
    let started = ranks::start().and_then(|(_, count)| ranks::agree(arguments()).map(|_| count));
    started.map_err(|error| Failure::Machine(miette::miette!("{error}")))
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

/// An error if a launcher has started `count` processes for a `command` that shares its work among processes or threads of its own.
pub(super) fn refuse(command: &str, count: usize) -> Result<(), Failure> {
    if count == 1 {
        return Ok(());
    }
    let help =
        "start the program without the launcher: it takes all processors of the machine, or as many as --threads says";
    Err(Failure::Input(miette::miette!(
        help = help,
        "a launcher of MPI has started {command}, which has no use for ranks"
    )))
}
