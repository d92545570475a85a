//! Several processes of this program, started side by side by a launcher of MPI. Rank 0 runs the program; the others
//! are workers for the factorisations of MUMPS and the cycles of multigrid.

use std::env;
use std::hash::{DefaultHasher, Hash, Hasher};

use clap::FromArgMatches;
use stickslip::algebra::NodeRows;
use stickslip::algebra::linear::LinearError;
use stickslip::run::RunError;
use stickslip::solver::history::LinearAlgebra;
use stickslip_distributed as ranks;

use super::{Cli, Command, ExitStatus, Failure, interrupt, memory, output, program, threads};

/// Environment variables for the rank: of Open MPI's mpirun, of MPICH's, and of Slurm's srun with PMIx.
const RANK: [&str; 3] = ["OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK"];

/// Returns the rank of this process if a launcher has started it. The rank comes from the environment, because starting
/// MPI takes time.
fn rank() -> Option<usize> {
    RANK.iter().find_map(|name| env::var(name).ok()?.parse().ok())
}

/// Returns `true` if the environment says that a launcher has started this process as a worker.
pub(super) fn may_help() -> bool {
    rank().is_some_and(|rank| rank > 0)
}

/// Runs this process as a worker, for rank 0 in any command. Rank 0 reports errors in full. Returns `None` if MPI knows
/// of no other process, e.g. if a job of another program has started this one.
pub(super) fn help() -> Option<ExitStatus> {
    // Arguments that cannot be parsed are reported by rank 0, or by this process if it turns out to be the only one.
    let cli = program().try_get_matches().and_then(|matches| Cli::from_arg_matches(&matches)).ok();
    // The launcher returns the status of the process that ends first.
    let failed = |error: LinearError| {
        output::note(&error.to_string());
        let is_of_the_input = RunError::from(error).is_of_the_input();
        Some(if is_of_the_input { ExitStatus::BadInput } else { ExitStatus::MachineFailure })
    };
    let rank = match ranks::start() {
        Ok((0, _)) => return None,
        Ok((rank, _)) => rank,
        Err(error) => return failed(error),
    };
    // Rank 0 handles the signals. It can end in order only while its workers run.
    interrupt::disregard();
    memory::end_in_order(false);
    let count = threads::count(cli.as_ref().and_then(|cli| cli.threads));
    threads::start(count);
    threads::let_the_blas_have(threads::of_this_rank(count));
    match ranks::agree(arguments()) {
        Ok(true) => {}
        Ok(false) => {
            output::note(&format!(
                "rank {rank} was started with other arguments than rank 0; those of rank 0 are used"
            ));
        }
        Err(error) => return failed(error),
    }
    // Each rank assembles its own rows of the body of rank 0.
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
    match ranks::help(&mut body) {
        Ok(()) => Some(ExitStatus::Success),
        Err(error) => failed(error),
    }
}

/// Returns a hash of the arguments of this process.
fn arguments() -> u64 {
    let mut hasher = DefaultHasher::new();
    env::args_os().skip(1).for_each(|argument| argument.hash(&mut hasher));
    hasher.finish()
}

/// Returns the number of processes, on rank 0. If a launcher has been used, it starts MPI, for which the other
/// processes wait.
pub(super) fn lead() -> Result<usize, Failure> {
    if rank().is_none() {
        return Ok(1);
    }
    let started = ranks::start().and_then(|(_, count)| ranks::agree(arguments()).map(|_| count));
    started.map_err(|error| Failure::Machine(miette::miette!("{error}")))
}

/// Returns an error if `linear`, where already known, cannot use `count` processes.
pub(super) fn check(count: usize, linear: Option<LinearAlgebra>) -> Result<(), Failure> {
    match linear {
        Some(linear) if count > 1 && !linear.is_shared() => {
            let help = "use --solver mumps, in space multigrid, or auto, or start the program without the launcher";
            let started = format!("a launcher of MPI has started {count} processes of this program");
            Err(Failure::input(format!("{started}, but {linear} uses only one"), help))
        }
        _ => Ok(()),
    }
}

/// Returns an error if a launcher has started `count` processes for a `command` that uses processes or threads of its
/// own.
pub(super) fn refuse(command: &str, count: usize) -> Result<(), Failure> {
    if count == 1 {
        return Ok(());
    }
    let help = "start the program without the launcher: it uses all processors of the machine, or the number given by \
         --threads";
    Err(Failure::input(format!("a launcher of MPI has started {command}, which has no use for ranks"), help))
}
