//! `stickslip solve` and `stickslip judge`: problems in exchange files.

use std::fs;
use std::path::{Path, PathBuf};

use crate::problems::{ProblemReport, Verdict};
use clap::Args;
use stickslip::algebra::linear::LinearError;
use stickslip::run::report::cpu_seconds;
use stickslip::solver::history;
use stickslip_exchange::{Answer, ProblemFile, ReductionError, SolveError, TOLERANCE, judge, read_solution, solve};
use stickslip_output::{Table, write_file};

use super::run::write_failure;
use super::study::pretty;
use super::{ExitStatus, Failure};

#[derive(Args)]
pub(super) struct SolveArgs {
    /// Problem file: FCLIB (HDF5) or Siconos text
    file: PathBuf,
    /// Start from the initial guess of this number in the file, from 1
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    guess: Option<u16>,
    /// Write the problem with the solution into this FCLIB file
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print only the report, as one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Args)]
pub(super) struct JudgeArgs {
    /// Problem file: FCLIB (HDF5) or Siconos text
    file: PathBuf,
    /// FCLIB file with the solution [default: the solution in the problem file]
    solution: Option<PathBuf>,
    /// Print only the report, as one JSON object
    #[arg(long)]
    json: bool,
}

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Self {
        let (of_memory, help) = match &error {
            SolveError::Reduction(ReductionError::Linear(LinearError::OutOfMemory { .. }))
            | SolveError::History(history::Error::Linear(LinearError::OutOfMemory { .. })) => {
                (true, "raise the memory limit, or use a machine with more memory")
            }
            SolveError::Reduction(_) => (false, "add supports to the bodies, or give the local problem"),
            _ => (false, "correct the problem or the guess"),
        };
        if of_memory { Failure::machine(error, help) } else { Failure::input(error, help) }
    }
}

/// Exit status 1: the problem is not solved.
pub(super) fn solve_file(args: &SolveArgs) -> Result<ExitStatus, Failure> {
    let name = args.file.display().to_string();
    args.out.as_deref().map(destination).transpose()?;
    let mut file = ProblemFile::read(&args.file)?;
    let guess = args.guess.map(|number| file.guesses.get(usize::from(number) - 1).ok_or(number)).transpose();
    let guess = guess.map_err(|number| {
        let help = "choose one of the existing guesses, or none";
        Failure::input(format!("{name}: there is no guess {number}, but only {}", file.guesses.len()), help)
    })?;
    if !args.json {
        head(&name, &file);
    }
    let start = cpu_seconds();
    let answer = solve(&file.problem, guess)?;
    let report = ProblemReport::solved(&name, &file, &answer, cpu_seconds() - start);
    let Answer { solution, .. } = answer;
    if let Some(path) = &args.out {
        file.solution = Some(solution);
        write(path, &file)?;
    }
    print_report(&report, args.json)?;
    if let (Some(path), false) = (&args.out, args.json) {
        say!("results      {}", path.display());
    }
    Ok(status(report.status))
}

/// Exit status 1: the solution violates a law.
pub(super) fn judge_file(args: &JudgeArgs) -> Result<ExitStatus, Failure> {
    let name = args.file.display().to_string();
    let file = ProblemFile::read(&args.file)?;
    let solution = match &args.solution {
        Some(path) => read_solution(path, &file.problem)?,
        None => file.solution.clone().ok_or_else(|| {
            let help = "name a file that contains a solution: u and r, and for a global problem v, all of them written";
            Failure::input(format!("{name}: the file contains no solution"), help)
        })?,
    };
    let errors = judge(&file.problem, &solution).map_err(|fault| {
        let of = args.solution.as_ref().map_or(name.clone(), |path| path.display().to_string());
        Failure::input(format!("{of}, {fault}"), &fault.help)
    })?;
    if !args.json {
        head(&name, &file);
    }
    let report = ProblemReport::judged(&name, &file, errors);
    print_report(&report, args.json)?;
    Ok(status(report.status))
}

fn status(verdict: Verdict) -> ExitStatus {
    if verdict == Verdict::Solved { ExitStatus::Success } else { ExitStatus::NotConverged }
}

fn head(name: &str, file: &ProblemFile) {
    let problem = &file.problem;
    say!("{}", file.info.title.as_deref().unwrap_or(name));
    let unknowns =
        if problem.unknowns() > 0 { format!(", {} unknowns of bodies", problem.unknowns()) } else { String::new() };
    let space = if problem.dimension() == 2 { "in the plane" } else { "in space" };
    row!("problem      {}, {} contacts {space}{unknowns}", problem.form(), problem.contacts());
    if let Some(description) = &file.info.description {
        row!("             {}", description.replace('\n', " "));
    }
}

fn print_report(report: &ProblemReport, json: bool) -> Result<(), Failure> {
    if json {
        say!("{}", pretty(report)?);
        return Ok(());
    }
    for warning in &report.warnings {
        row!("warning      {warning}");
    }
    for stage in &report.stages {
        row!("stage        {}: {} iterations, residual {:.1e}", stage.stage, stage.iterations, stage.residual);
    }
    let mut laws = Table::new(&["error", "law"]);
    let mut violated = Vec::new();
    for (law, error) in report.errors.laws() {
        laws.push(vec![format!("{error:.1e}"), format!("{} ({})", law.name, law.demands)]);
        if error.is_nan() || error > TOLERANCE {
            violated.push(law.violation);
        }
    }
    say!("{}", laws.to_string().trim_end());
    let verdict = if report.status == Verdict::Solved { "solved" } else { "not solved" };
    row!("verdict      {verdict}: residual {:.1e} (tolerance {TOLERANCE:.0e})", report.residual);
    for violation in violated {
        row!("             {violation}");
    }
    if report.status != Verdict::Solved && report.contacts > 0 {
        row!("             the worst contact has number {}, from 0", report.errors.contact);
    }
    if !report.stages.is_empty() {
        row!("time         {:.3} s CPU", report.cpu_seconds);
    }
    Ok(())
}

/// Returns folder and name of a file to be written. An existing file of that name is replaced.
pub(super) fn destination(path: &Path) -> Result<(&Path, &str), Failure> {
    let refused = |help: &str, why: &str| Failure::input(format!("{}: {why}", path.display()), help);
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else {
        return Err(refused("name a file", "it is not a writable file"));
    };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if let Err(error) = fs::create_dir_all(folder) {
        return Err(refused("name a file in a writable folder", &format!("its folder cannot be created: {error}")));
    }
    // Replacing would destroy a link or a device.
    match path.symlink_metadata() {
        Ok(there) if !there.is_file() => Err(refused("name a file", "it exists and is no regular file")),
        _ => Ok((folder, name)),
    }
}

/// Writes `file` as FCLIB.
pub(super) fn write(path: &Path, file: &ProblemFile) -> Result<(), Failure> {
    let (folder, name) = destination(path)?;
    write_file(folder, name, file.to_fclib()?).map_err(|error| write_failure(path, &error))
}
