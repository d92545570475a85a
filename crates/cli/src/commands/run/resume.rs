//! `stickslip run --resume`: reads what an earlier run has left in the folder and checks that this scene may resume it.

use super::super::{ExitStatus, Failure};
use super::RunArgs;
use std::io::{self, BufRead, BufReader, Read};
use stickslip::run::report::RunReport;
use stickslip::scene::Provenance;
use stickslip::solver::Checkpoint;
use stickslip::solver::history::{LinearAlgebra, Status};
use stickslip_output::{KeptSolver, LockedOutputDir, ResultFolder};

/// The cure where a run cannot be resumed.
const ANEW: &str =
    "run without --resume to start a new run; it replaces the existing results after its first increment";

/// The state left in the folder by an earlier run.
pub(super) enum Left {
    /// A finished run.
    Ended(Status),
    /// An interrupted run that can be resumed, with its linear solver and the reason for its choice, if there was a choice.
    Underway { checkpoint: Checkpoint, linear: LinearAlgebra, reason: Option<String> },
}

impl Left {
    /// Returns what `lock` holds for a scene of this `origin`. Returns an error if something has changed since.
    pub(super) fn of(lock: &LockedOutputDir, origin: &Provenance, args: &RunArgs) -> Result<Option<Self>, Failure> {
        let path = lock.path().display();
        if args.results.resume && lock.is_damaged() {
            let damaged = "cannot be read: it is damaged, or of another build";
            return Err(Failure::input(format!("the checkpoint in {path} {damaged}"), ANEW));
        }
        let Some((checkpoint, earlier, KeptSolver { name, reason }, ended)) = lock.earlier_run() else {
            if args.results.resume && !args.printed.json {
                row!("resume       no earlier run was found: a new run begins");
            }
            return Ok(None);
        };
        if !args.results.resume {
            if ended.is_none() && !args.printed.json {
                say!(
                    "unfinished   an earlier run was interrupted here after {} increments: --resume would continue \
                     it, this run replaces it",
                    checkpoint.increments()
                );
            }
            return Ok(None);
        }
        let changes = origin.changes_since(earlier);
        let linear = name.parse::<LinearAlgebra>().ok().filter(|linear| linear.is_built_in());
        let Some(linear) = linear.filter(|_| changes.is_empty()) else {
            let what =
                if changes.is_empty() { "this build lacks its linear solver".to_string() } else { changes.join("; ") };
            return Err(Failure::input(format!("the run in {path} is a different one: {what}"), ANEW));
        };
        if let Some(status) = ended {
            if let Some(name) = lock.missing_file() {
                let message = format!("the run in {path} is complete, but {name} is missing or was shortened");
                return Err(Failure::input(message, "run without --resume to start a new run"));
            }
            return Ok(Some(Left::Ended(status)));
        }
        if !args.printed.json {
            row!("resume       after {} increments, at t = {} s", checkpoint.increments(), checkpoint.time());
        }
        Ok(Some(Left::Underway { checkpoint: checkpoint.clone(), linear, reason: reason.clone() }))
    }
}

/// Repeats the report of a run that has already finished.
pub(super) fn told_again(claim: &LockedOutputDir, args: &RunArgs, status: Status) -> Result<ExitStatus, Failure> {
    if args.printed.json {
        print(claim.report().map_err(|error| unreadable(&error))?)?;
    } else {
        row!("resume       nothing to do: the run here is complete");
        say!("\nverdict      {status}\nresults      {}", claim.path().display());
    }
    Ok(if status == Status::Converged { ExitStatus::Success } else { ExitStatus::NotConverged })
}

/// Prints a report as JSON, either from the folder or from memory.
pub(super) fn print_json(report: &RunReport, folder: Option<&ResultFolder>) -> Result<(), Failure> {
    if let Some(folder) = folder {
        return print(folder.report().map_err(|error| unreadable(&error))?);
    }
    say!("{}", report.to_json().map_err(|error| Failure::Machine(miette::miette!("{error}")))?);
    Ok(())
}

fn print(report: impl Read) -> Result<(), Failure> {
    for line in BufReader::new(report).lines() {
        say!("{}", line.map_err(|error| unreadable(&error))?);
    }
    Ok(())
}

fn unreadable(error: &io::Error) -> Failure {
    let help = "run without --resume to start a new run";
    Failure::machine(format!("run.json cannot be read: {error}"), help)
}
