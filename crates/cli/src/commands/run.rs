//! `stickslip run`.

mod resume;
mod summary;
mod watcher;

pub(super) use summary::print_warnings;

use super::progress::Progress;
use super::{ExitStatus, Failure, SceneArgs, interrupt, origin, output, threads, uniqueness};
use clap::Args;
use resume::Left;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;
use stickslip::base::Budget;
use stickslip::body::Model;
use stickslip::run::report::ProbeTable;
use stickslip::run::{MemoryEstimate, Run};
use stickslip::scene::{Override, Provenance, Scene};
use stickslip::solver::Checkpoint;
use stickslip::solver::history::Status;
use stickslip_output::{KeptSolver, LockedOutputDir, Pace, ResultFolder};
use watcher::Watcher;

#[cfg(feature = "petsc")]
use stickslip::body::Body;

#[cfg(feature = "petsc")]
use super::ranks;

/// Options for the results and for resuming a run.
#[derive(Args)]
struct ResultArgs {
    /// Write contact lines, records, plots and the report into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Resume the interrupted run in the folder of --out; start a new run if there is none
    #[arg(long, requires = "out")]
    resume: bool,
    /// Seconds between checkpoints for --resume (0: after every increment) [default: checkpoints take 2 % of the run
    /// time]
    #[arg(long, value_name = "SECONDS", requires = "out", value_parser = seconds)]
    checkpoint_every: Option<Duration>,
}

/// Options for the printed text.
#[derive(Args)]
struct PrintedArgs {
    /// Print only the report, as one JSON object
    #[arg(long)]
    json: bool,
    /// Print only warnings, the largest displacement and pressure, and the verdict
    #[arg(long, conflicts_with = "json")]
    quiet: bool,
}

#[derive(Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    results: ResultArgs,
    #[command(flatten)]
    printed: PrintedArgs,
    /// Compute the friction coefficient up to which the rates at the end are unique for the contact statuses there
    #[arg(long)]
    uniqueness: bool,
    /// Number of increments, replaces time.increments
    #[arg(long, value_name = "N", value_parser = increments)]
    increments: Option<u32>,
}

impl RunArgs {
    /// Returns `true` if everything is printed, for people.
    fn is_verbose(&self) -> bool {
        !self.printed.json && !self.printed.quiet
    }

    /// Returns the data from which a rank assembles its rows, if the assembly can be shared.
    #[cfg(feature = "petsc")]
    pub(super) fn body(&self) -> Result<Option<Body>, String> {
        let scene = self.scene.read().map_err(|error| error.to_string())?;
        Body::of(&scene.description).map_err(|error| error.to_string())
    }
}

/// Runs on `count` threads.
pub(super) fn run(args: &RunArgs, count: usize) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let mut scene = args.scene.read()?;
    if let Some(number) = args.increments {
        scene = scene.with(&[Override::value("time.increments", i64::from(number))])?;
    }
    #[cfg(feature = "petsc")]
    ranks::check(stickslip::algebra::linear::rank_count(), scene.solver.linear)?;
    if args.is_verbose() {
        say!("{}", scene.title);
        row!("set-up       mesh, stiffness, contact");
    }
    let origin = origin(&scene)?;
    let claim =
        args.results.out.as_deref().map(|path| LockedOutputDir::new(path).map_err(|error| write_failure(path, &error)));
    let claim = claim.transpose()?;
    let mut reason = None;
    let left = match &claim {
        None => None,
        Some(claim) => match Left::of(claim, &origin, args)? {
            Some(Left::Ended(status)) => return resume::told_again(claim, args, status),
            Some(Left::Underway { checkpoint, linear, reason: earlier }) => {
                scene.solver.linear = Some(linear);
                reason = earlier;
                Some(checkpoint)
            }
            None => None,
        },
    };
    let done = left.as_ref().map_or(0, Checkpoint::increments);
    let resumes = left.is_some();
    let run = prepared(args, &scene, count, left)?;
    let linear = KeptSolver { name: run.choice().linear.to_string(), reason: run.choice().reason.clone().or(reason) };
    let choice = linear.reason.clone();
    let folder = claim.map(|claim| open_folder(claim, &scene, run.model(), (origin, linear), resumes)).transpose()?;
    if !args.printed.json {
        summary::print_head(&scene, &run, args.is_verbose());
    }
    // Records are kept only if the report is printed whole.
    let keeps = args.printed.json && folder.is_none();
    if keeps {
        MemoryEstimate::check_records(run.times().len() - done, Budget::of_process())?;
    }
    let mut watcher = Watcher {
        model: run.model(),
        title: &scene.title,
        output: &scene.output,
        wanted: scene.output.increments(run.times()),
        folder,
        progress: Progress::new(run.times().len(), done, args.is_verbose()),
        pace: Pace::new(args.results.checkpoint_every),
        failed_write: None,
    };
    if !resumes {
        watcher.start(&run.undeformed());
    }
    let report = if keeps { run.solve(&mut watcher) } else { run.solve_to(&mut watcher) };
    watcher.progress.finish();
    let Watcher { mut folder, failed_write, .. } = watcher;
    let mut report = report?;
    report.solver_choice = choice;
    let mut is_written = false;
    if let Some(folder) = &mut folder {
        let written = failed_write.map_or_else(|| folder.add_report(&report), Err);
        is_written = written.map_err(|error| disk_failure(folder.path(), &error))?;
    }
    if args.printed.json {
        resume::print_json(&report, folder.as_ref().filter(|_| is_written))?;
    } else {
        let lost = report.status == Status::NoContinuation;
        if let Some(critical) = report.critical_friction.as_ref().filter(|critical| !lost || critical.slipping > 0) {
            let (model, end) = (run.model(), run.times().last().copied().unwrap_or_default());
            let mu = model.loading.friction().map_or(model.problem.mu().to_vec(), |friction| friction.at(end));
            row!("uniqueness   {}", uniqueness::explain(critical, &mu));
        }
        summary::print_results(&scene, &report, run.times().len(), args.is_verbose());
        match &folder {
            Some(folder) => {
                let before = if is_written { "" } else { ": those of the earlier run, because this one has none" };
                say!("results      {}{before}", folder.path().display());
                if let Some(now) = folder.moved_to() {
                    row!("warning      the folder with the results was moved during the run to {}", now.display());
                }
            }
            None => say!("results      not written: --out FOLDER writes them"),
        }
    }
    Ok(match report.status {
        Status::Converged => ExitStatus::Success,
        Status::OutOfMemory => ExitStatus::MachineFailure,
        _ => ExitStatus::NotConverged,
    })
}

/// Prepares the run, from the checkpoint `left` if it was interrupted before.
fn prepared<'a>(args: &RunArgs, scene: &'a Scene, count: usize, left: Option<Checkpoint>) -> Result<Run<'a>, Failure> {
    let mut prepare = |model: &Model| {
        if scene.refine.is_some() && args.is_verbose() {
            row!("set-up       {} nodes", model.mesh.nodes.len());
        }
        threads::share_with_the_blas(model, count);
    };
    let mut run = Run::prepared(scene, &mut prepare, &mut interrupt::UntilInterrupted)?;
    if args.uniqueness {
        run = run.with_uniqueness()?;
    }
    Ok(match left {
        Some(checkpoint) => run.from(checkpoint),
        None => run,
    })
}

/// Parses a number of increments.
pub(super) fn increments(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| match text {
        "auto" => "give a number: `stickslip converge` refines increments until a quantity is known".to_string(),
        _ => "not a number".to_string(),
    })
}

fn open_folder(
    claim: LockedOutputDir,
    scene: &Scene,
    model: &Model,
    (origin, linear): (Provenance, KeptSolver),
    resumes: bool,
) -> Result<ResultFolder, Failure> {
    let probes = ProbeTable::all(model, &scene.output.probes).map_err(|fault| scene.located(fault))?;
    let path = claim.path().to_path_buf();
    let folder = if resumes { claim.resume(model, probes) } else { claim.begin(model, probes, origin, linear) };
    folder.map_err(|error| write_failure(&path, &error))
}

/// Parses a number of seconds, 0 or more.
fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    seconds.ok_or_else(|| "give a number of seconds, 0 or more".to_string())
}

/// Reports that results cannot be written. A full disk is a failure of the machine; any other cause is an error of the
/// input.
pub(super) fn write_failure(path: &Path, error: &io::Error) -> Failure {
    let message = format!("{}: results cannot be written: {error}", path.display());
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            Failure::machine(message, "free disk space, and type the command again")
        }
        _ => Failure::input(message, "choose a writable folder with --out"),
    }
}

fn disk_failure(path: &Path, error: &io::Error) -> Failure {
    let help = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "what was written before is complete; free disk space, and continue with --resume"
        }
        _ => "what was written before is complete; correct the cause, and continue with --resume",
    };
    Failure::machine(format!("{}: results cannot be written: {error}", path.display()), help)
}
