//! `stickslip run`.

mod increments;
mod pace;
mod resume;
mod watcher;

use super::progress::Progress;
use super::{Failure, SceneArgs, interrupt, origin, output, threads, uniqueness};
use clap::Args;
use increments::{IncrementArgs, explain};
use pace::Pace;
use resume::Left;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use stickslip::algebra::linear::process::Blas;
use stickslip::base::{Budget, Quantity};
use stickslip::body::{Model, PeakOf};
use stickslip::run::report::{
    AppliedForce, BalanceRecord, CompanionEstimate, ComponentSums, EliminatedUnknown, ProbeTable, RankRecord,
    Resultant, RunReport, Unknowns, Warning,
};
use stickslip::run::{MemoryEstimate, Run};
use stickslip::scene::{Provenance, Scene, Time};
use stickslip::solver::Checkpoint;
use stickslip::solver::formulation::Layout;
use stickslip::solver::history::{IncrementError, Status, WorkingSet};
use stickslip_output::{LockedOutputDir, ResultFolder};
use watcher::Watcher;

#[cfg(feature = "mpi")]
use stickslip::body::Body;

#[cfg(feature = "mpi")]
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

#[derive(Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    results: ResultArgs,
    /// Print only the report, as one JSON object
    #[arg(long)]
    json: bool,
    /// Compute the friction coefficient up to which the rates at the end are unique for the contact statuses there
    #[arg(long)]
    uniqueness: bool,
    /// Estimate the time-step error of the friction forces by a second run with a quarter of the increments
    #[arg(long)]
    companion: bool,
    #[command(flatten)]
    increments: IncrementArgs,
}

impl RunArgs {
    /// Returns the data from which a rank assembles its rows, if the assembly can be shared.
    #[cfg(feature = "mpi")]
    pub(super) fn body(&self) -> Result<Option<Body>, String> {
        let scene = self.scene.read().map_err(|error| error.to_string())?;
        Body::of(&scene.description).map_err(|error| error.to_string())
    }
}

/// Runs on `count` threads.
pub(super) fn run(args: &RunArgs, count: usize) -> Result<ExitCode, Failure> {
    interrupt::listen();
    let scene = args.scene.read()?;
    #[cfg(feature = "mpi")]
    ranks::check(stickslip::algebra::linear::ranks::count(), scene.solver.linear)?;
    if !args.json {
        say!("{}", scene.title);
        say!("set-up       mesh, stiffness, contact");
    }
    let (mut scene, chosen) = args.increments.of(scene, count)?;
    if let (Some(chosen), false) = (&chosen, args.json) {
        say!("increments   {}", explain(chosen));
    }
    let origin = origin(&scene)?;
    let claim =
        args.results.out.as_deref().map(|path| LockedOutputDir::new(path).map_err(|error| write_failure(path, &error)));
    let claim = claim.transpose()?;
    let left = match &claim {
        None => None,
        Some(claim) => match Left::of(claim, &origin, args)? {
            Some(Left::Ended(status)) => return resume::told_again(claim, args, status),
            Some(Left::Underway { checkpoint, linear }) => {
                scene.solver.linear = Some(linear);
                Some(checkpoint)
            }
            None => None,
        },
    };
    let done = left.as_ref().map_or(0, Checkpoint::increments);
    let resumes = left.is_some();
    let run = prepared(args, &scene, count, left)?;
    let linear = run.choice().linear.to_string();
    let folder = claim.map(|claim| open_folder(claim, &scene, run.model(), (origin, linear), resumes)).transpose()?;
    if !args.json {
        print_head(&scene, &run);
        if let Some(warning) = Blas::loaded().as_ref().and_then(Warning::of_blas) {
            say!("warning      {}", warning.message);
        }
        say!("set-up       symbolic analysis");
    }
    // Records are kept only if the report is printed whole.
    let keeps = args.json && folder.is_none();
    if keeps {
        MemoryEstimate::check_records(run.times().len() - done, Budget::of_process())?;
    }
    let mut watcher = Watcher {
        model: run.model(),
        title: &scene.title,
        output: &scene.output,
        wanted: scene.output.increments(run.times()),
        folder,
        progress: Progress::new(run.times().len(), done, !args.json),
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
    report.chosen_increments = chosen;
    let mut is_written = false;
    if let Some(folder) = &mut folder {
        let written = failed_write.map_or_else(|| folder.add_report(&report), Err);
        is_written = written.map_err(|error| disk_failure(folder.path(), &error))?;
    }
    if args.json {
        resume::print_json(&report, folder.as_ref().filter(|_| is_written))?;
    } else {
        print_verdict(&report, run.times().len());
        for warning in report.warnings.iter().filter(|warning| warning.kind.needs_the_solution()) {
            say!("warning      {}", warning.message);
        }
        let lost = report.status == Status::NoContinuation;
        if let Some(critical) = report.critical_friction.as_ref().filter(|critical| !lost || critical.slipping > 0) {
            let (model, end) = (run.model(), run.times().last().copied().unwrap_or_default());
            let mu = model.loading.friction().map_or(model.problem.mu().to_vec(), |friction| friction.at(end));
            say!("uniqueness   {}", uniqueness::explain(critical, &mu));
        }
        if let Some(folder) = &folder {
            let before = if is_written { "" } else { ": those of the earlier run, because this one has none" };
            say!("results      {}{before}", folder.path().display());
            if let Some(now) = folder.moved_to() {
                say!("warning      the folder with the results was moved during the run to {}", now.display());
            }
        }
    }
    Ok(match report.status {
        Status::Converged => ExitCode::SUCCESS,
        Status::OutOfMemory => ExitCode::from(3),
        _ => ExitCode::from(1),
    })
}

/// Prepares the run, from the checkpoint `left` if it was interrupted before.
fn prepared<'a>(args: &RunArgs, scene: &'a Scene, count: usize, left: Option<Checkpoint>) -> Result<Run<'a>, Failure> {
    let mut run = Run::prepared(scene, |model| threads::share_with_the_blas(model, count))?;
    if args.uniqueness {
        run = run.with_uniqueness()?;
    }
    if args.companion && scene.solver.method.is_exact_path() {
        let help = "remove --companion";
        return Err(Failure::Input(miette::miette!(
            help = help,
            "the exact path has no increments to compare with fewer"
        )));
    }
    if args.companion {
        run = run.with_companion();
    }
    Ok(match left {
        Some(checkpoint) => run.from(checkpoint),
        None => run,
    })
}

fn open_folder(
    claim: LockedOutputDir,
    scene: &Scene,
    model: &Model,
    (origin, linear): (Provenance, String),
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
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => disk_failure(path, error),
        _ => {
            let help = "choose a writable folder with --out";
            Failure::Input(miette::miette!(help = help, "{}: results cannot be written: {error}", path.display()))
        }
    }
}

fn disk_failure(path: &Path, error: &io::Error) -> Failure {
    let help = match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "what was written before is complete; free disk space, and continue with --resume"
        }
        _ => "what was written before is complete; correct the cause, and continue with --resume",
    };
    Failure::Machine(miette::miette!(help = help, "{}: results cannot be written: {error}", path.display()))
}

fn print_head(scene: &Scene, run: &Run<'_>) {
    let (model, choice, method) = (run.model(), run.choice(), scene.solver.method);
    let Unknowns { u, p_t, p_o, p_n, v_n, s, lambda } =
        Unknowns::new(&Layout::new(&model.problem), method.increments());
    let blocks = [(u, "u"), (p_t, "p_t"), (p_o, "p_o"), (p_n, "p_n"), (v_n, "v_n"), (s, "s"), (lambda, "lambda")];
    let present = blocks.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}"));
    let reduced = if method.increments().is_interior() {
        format!(", reduced to {} in the matrix", u + p_t + p_o + p_n)
    } else {
        String::new()
    };
    say!("method       {}, setting {}", method.name(), method.setting());
    if let Some(reason) = choice.reason() {
        say!("solver       auto: {reason}");
    }
    let total: usize = blocks.iter().map(|(count, _)| count).sum();
    let Time { increments, kinks, .. } = &scene.time;
    if !kinks.is_empty() {
        let fewer = if kinks.len() > *increments { "; histories with fewer points have fewer" } else { "" };
        say!("increments   {increments} equal ones, and {} more to end at kinks of histories{fewer}", kinks.len());
    }
    say!("unknowns     {total} = {}{reduced}", present.collect::<Vec<_>>().join(" + "));
    let condenses = choice.linear.condenses();
    let left_out = EliminatedUnknown::all(model, condenses, run.working_set().filter(|_| condenses));
    for (k, EliminatedUnknown { count, unknown, reason }) in left_out.iter().enumerate() {
        say!("{:<12} {count} {unknown} {reason}", if k == 0 { "left out" } else { "" });
    }
    for warning in Warning::of_model(model).iter().filter(|warning| !warning.kind.needs_the_solution()) {
        say!("warning      {}", warning.message);
    }
}

fn print_verdict(report: &RunReport, increments: usize) {
    let totals = &report.totals;
    say!("\nverdict      {}, {} of {increments} increments", report.status, totals.converged);
    if !report.explanation.reason.is_empty() {
        say!("             {}", report.explanation.reason);
    }
    // An interrupted first increment has reached nothing.
    if totals.converged == 0 && matches!(report.status, Status::Interrupted | Status::OutOfMemory) {
        return;
    }
    let (law, error) = totals.kkt.worst();
    say!("error        {error:.1e} at most ({law}); backward error of the solves {:.1e}", totals.backward_error);
    let units = &report.units;
    let unit = units.name(Quantity::Force);
    let told = |x: f64| units.of_si(Quantity::Force, x);
    let components = |force: &[f64]| force.iter().map(|f| format!("{:.6e}", told(*f))).collect::<Vec<_>>().join(", ");
    for Resultant { boundary, force, sums: ComponentSums { sum_p_n, sum_p_t, sum_p_o }, obstacles, opposite, .. } in
        &report.boundaries
    {
        let other = sum_p_o.map_or(String::new(), |sum| format!(", sum p_o = {:.6e} {unit}", told(sum)));
        let [normal, tangential] = [sum_p_n, sum_p_t].map(|sum| told(*sum));
        say!("contact      {boundary}: sum p_n = {normal:.6e} {unit}, sum p_t = {tangential:.6e} {unit}{other}");
        let on = opposite.as_ref().map_or("the obstacle", |of| of.boundary.as_str());
        say!("             force on {on} ({}) {unit}", components(force));
        for on in obstacles {
            say!("             of it on {} ({}) {unit}", on.obstacle, components(&on.force));
        }
    }
    if let Some(BalanceRecord { supports, springs, balance, .. }) = &report.last_reactions {
        for (kind, AppliedForce { at, force, .. }) in
            supports.iter().map(|support| ("reaction", support)).chain(springs.iter().map(|spring| ("spring", spring)))
        {
            say!("{kind:<12} {at}: ({}) {unit} on the body", components(force));
        }
        say!("balance      the forces on the body balance to {balance:.1e} of their sizes");
    }
    if let Some(largest) = &report.largest_displacement {
        let length = units.of_si(Quantity::Length, largest.length);
        say!("displaced    by {length:.3e} {} at most", units.name(Quantity::Length));
    }
    if let Some(largest) = &report.largest_pressure {
        let stress =
            |pressure: f64| format!("{:.3e} {}", units.of_si(Quantity::Stress, pressure), units.name(Quantity::Stress));
        match (largest.peak_of, largest.pressure.map(stress)) {
            (Some(PeakOf::Nodes), Some(pressure)) => say!("pressed      by {pressure} at most"),
            (Some(PeakOf::Patches), Some(pressure)) => {
                say!("pressed      by {pressure} at most, on a node with its neighbours");
            }
            _ => say!("pressed      too few tetrahedra across the contact for a peak pressure"),
        }
    }
    if let Some(error) = report.estimates.discretisation {
        say!("mesh         error about {:.1} % in the energy norm", 100.0 * error);
    }
    if let Some(IncrementError { friction_work, friction_work_corrected, work_error, force_error, .. }) =
        report.estimates.increments.filter(|found| found.friction_work > 0.0)
    {
        let [work, corrected] = [friction_work, friction_work_corrected].map(|x| units.of_si(Quantity::Energy, x));
        let unit = units.name(Quantity::Energy);
        say!(
            "friction     work {work:.3e} {unit}, {:.1} % of it due to the increments: corrected {corrected:.3e} \
             {unit}",
            100.0 * work_error
        );
        if let Some(error) = force_error.filter(|error| *error > 0.0) {
            say!("increments   time-step error of the tangential forces about {:.1} %", 100.0 * error);
        }
    }
    if let Some(CompanionEstimate { increments, status, error, .. }) = report.estimates.companion {
        match error {
            Some(error) => say!(
                "increments   time-step error of the tangential forces about {:.1} %, by a run with {increments}",
                100.0 * error
            ),
            None => say!("increments   time-step error unknown: a run with {increments} ended {status}"),
        }
    }
    let (matrices, entries) = (totals.factorizations, totals.nnz_factors);
    let linear = match totals.krylov_iterations {
        Some(krylov) => format!("{matrices} Newton matrices with {entries} entries, {krylov} iterations of GMRES"),
        None => format!(
            "{matrices} factorisations, {} symbolic analysis, {entries} entries in L and U",
            totals.symbolic_analyses
        ),
    };
    say!("work         {} iterations, {linear}", totals.iterations);
    if let Some(WorkingSet { first, last, all, grown }) = report.working_set {
        let then = match grown {
            0 => String::new(),
            1 => format!(" at first, {last} after it grew once"),
            _ => format!(" at first, {last} after it grew {grown} times"),
        };
        say!("held         {first} of {all} contact nodes{then}");
    }
    let memory = totals.peak_rss_bytes.map_or(String::new(), |bytes| format!(", {:.0} MB", bytes as f64 * 1e-6));
    say!("took         {:.2} s ({:.2} s CPU){memory}", totals.wall_seconds, totals.cpu_seconds);
    for RankRecord { rank, cpu_seconds, peak_rss_bytes } in &totals.ranks {
        say!("rank {rank:<8}{cpu_seconds:.2} s CPU, {:.0} MB", *peak_rss_bytes as f64 * 1e-6);
    }
    if let Some(faster) = &report.faster_solver {
        say!("faster       {faster}");
    }
}
