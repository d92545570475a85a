//! `stickslip run`.

use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use stickslip::formulation::{Layout, NewtonSystem};
use stickslip::history::{Method, Observer, Status, Step};
use stickslip::linear;
use stickslip::model::Model;
use stickslip::nonlinear::{Flow, IterationRecord};
use stickslip::report::{
    Acting, BalanceRecord, ComponentSums, ContactLine, ContactSurface, ForceRecord, LeftOut, ResultFolder, Resultant,
    RunReport, Unknowns, Warning, fields,
};
use stickslip::run::Run;
use stickslip::scene::Scene;
use stickslip::units::Quantity;

use super::progress::Progress;
use super::{Failure, SceneArgs, interrupt, uniqueness};

#[derive(Args)]
pub(super) struct RunArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Write contact lines, records, plots and the report into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the report as one JSON object and nothing else
    #[arg(long)]
    json: bool,
    /// Tell up to how much friction the rates at the end are unique along the statuses there
    #[arg(long)]
    uniqueness: bool,
}

pub(super) fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    interrupt::listen();
    let scene = args.scene.read()?;
    if !args.json {
        say!("{}", scene.title);
        say!("set-up       mesh, stiffness, contact");
    }
    let mut run = Run::new(&scene)?;
    if args.uniqueness {
        run = run.with_uniqueness()?;
    }
    let folder = args.out.as_deref().map(|path| open_folder(path, run.model())).transpose()?;
    if !args.json {
        print_head(&scene, &run);
        say!("set-up       symbolic analysis");
    }
    let mut watcher = Watcher {
        model: run.model(),
        title: &scene.title,
        wanted: wanted_increments(&scene.output.times, run.times()),
        fields: scene.output.fields,
        folder,
        progress: Progress::new(run.times().len(), !args.json),
        failed_write: None,
    };
    let report = run.solve(&mut watcher);
    watcher.progress.finish();
    let Watcher { folder, failed_write, .. } = watcher;
    let report = report?;
    let json = report.to_json().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
    if let Some(folder) = &folder
        && let Err(error) = failed_write.map_or_else(|| folder.write("run.json", &json), Err)
    {
        return Err(disk_failure(folder.path(), &error));
    }
    if args.json {
        say!("{json}");
    } else {
        print_verdict(&report, run.times().len());
        for warning in report.warnings.iter().filter(|warning| warning.kind.needs_the_solution()) {
            say!("warning      {}", warning.message);
        }
        if let Some(critical) = &report.critical_friction {
            say!("uniqueness   {}", uniqueness::explain(critical, run.model().problem.mu()));
        }
        if let Some(folder) = &folder {
            say!("results      {}", folder.path().display());
        }
    }
    Ok(match report.status {
        Status::Converged => ExitCode::SUCCESS,
        Status::OutOfMemory => ExitCode::from(3),
        _ => ExitCode::from(1),
    })
}

/// Feeds the display and the folder of results.
struct Watcher<'a> {
    model: &'a Model,
    title: &'a str,
    /// Increments whose contact lines are written.
    wanted: Vec<usize>,
    /// Whether the fields of the body are written, too.
    fields: bool,
    folder: Option<ResultFolder>,
    progress: Progress,
    failed_write: Option<io::Error>,
}

impl Observer for Watcher<'_> {
    /// Not earlier: what the analysis frees should go back to the system.
    fn ready(&mut self) {
        linear::process::keep_freed_memory();
    }

    fn iteration(&mut self, _index: usize, record: &IterationRecord) -> Flow {
        self.progress.iteration(record.iteration, record.theta);
        if interrupt::requested() { Flow::Stop } else { Flow::Continue }
    }

    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.progress.increment(step.record);
        let Some(folder) = &mut self.folder else { return Flow::Continue };
        let (forces, balance) = (ForceRecord::all(self.model, step), BalanceRecord::new(self.model, step));
        let mut written = folder.add_increment(step.record).and_then(|()| folder.add_forces(&forces, &balance));
        // What a failed increment reached is worth a look, too.
        if self.wanted.contains(&step.record.index) || step.record.status != Status::Converged {
            for line in ContactLine::all(self.model, step) {
                written = written.and_then(|()| folder.add_contact_line(&line, self.title));
            }
            for surface in ContactSurface::all(self.model, step) {
                written = written.and_then(|()| folder.add_contact_surface(&surface, self.title));
            }
            if self.fields {
                let grid = fields(self.model, step);
                written = written.and_then(|()| folder.add_fields(step.record.index, step.record.time, &grid));
            }
        }
        match written {
            Ok(()) => Flow::Continue,
            Err(error) => {
                self.failed_write = Some(error);
                Flow::Stop
            }
        }
    }
}

/// The first increment (from 1) that reaches each of the `wanted` times.
fn wanted_increments(wanted: &[f64], times: &[f64]) -> Vec<usize> {
    // A time computed as end · k / increments may miss the one asked for by a rounding error.
    let slack = times.last().map_or(0.0, |end| 1e-9 * end);
    wanted.iter().filter_map(|t| Some(1 + times.iter().position(|time| *time >= t - slack)?)).collect()
}

fn open_folder(path: &Path, model: &Model) -> Result<ResultFolder, Failure> {
    ResultFolder::create(path, model).map_err(|error| write_failure(path, &error))
}

/// Results cannot be written at all: the folder is to blame, unless the disk is.
pub(super) fn write_failure(path: &Path, error: &io::Error) -> Failure {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => disk_failure(path, error),
        _ => {
            let help = "choose a folder that can be written with --out";
            Failure::Input(miette::miette!(help = help, "{}: results cannot be written: {error}", path.display()))
        }
    }
}

fn disk_failure(path: &Path, error: &io::Error) -> Failure {
    let help = "what was written before is complete; make room and run again";
    Failure::Machine(miette::miette!(help = help, "{}: results cannot be written: {error}", path.display()))
}

fn print_head(scene: &Scene, run: &Run<'_>) {
    let (model, choice, method) = (run.model(), run.choice(), scene.solver.method);
    let Unknowns { u, p_t, p_o, p_n, v_n, s, lambda } = Unknowns::new(&Layout::new(&model.problem), method);
    let blocks = [(u, "u"), (p_t, "p_t"), (p_o, "p_o"), (p_n, "p_n"), (v_n, "v_n"), (s, "s"), (lambda, "lambda")];
    let present = blocks.iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count} {name}"));
    let reduced = match method {
        Method::PaperIp { newton, .. } | Method::Ip { newton } if newton == NewtonSystem::Reduced => {
            format!(", reduced to {} in the matrix", u + p_t + p_o + p_n)
        }
        _ => String::new(),
    };
    say!("method       {}, setting {}", method.name(), method.setting());
    if let Some(reason) = choice.reason() {
        say!("solver       auto: {reason}");
    }
    let total: usize = blocks.iter().map(|(count, _)| count).sum();
    say!("unknowns     {total} = {}{reduced}", present.collect::<Vec<_>>().join(" + "));
    let left_out = LeftOut::all(model, choice.linear.condenses());
    for (k, LeftOut { count, unknown, reason }) in left_out.iter().enumerate() {
        say!("{:<12} {count} {unknown} {reason}", if k == 0 { "left out" } else { "" });
    }
    for warning in Warning::of_model(model) {
        say!("warning      {}", warning.message);
    }
}

fn print_verdict(report: &RunReport, increments: usize) {
    let totals = &report.totals;
    let done = report.increments.iter().filter(|record| record.status == Status::Converged).count();
    let (law, error) = report
        .increments
        .iter()
        .map(|record| record.kkt.worst())
        .fold(("none", 0.0), |a, b| if b.1.is_nan() || b.1 > a.1 { b } else { a });
    say!("\nverdict      {}, {done} of {increments} increments", report.status);
    if !report.explanation.reason.is_empty() {
        say!("             {}", report.explanation.reason);
    }
    if report.increments.is_empty() {
        return;
    }
    say!("error        {error:.1e} at most ({law}); backward error of the solves {:.1e}", totals.backward_error);
    let units = &report.units;
    let unit = units.name(Quantity::Force);
    let told = |x: f64| units.of_si(Quantity::Force, x);
    let components = |force: &[f64]| force.iter().map(|f| format!("{:.6e}", told(*f))).collect::<Vec<_>>().join(", ");
    for Resultant { boundary, force, sums: ComponentSums { sum_p_n, sum_p_t, sum_p_o }, .. } in &report.boundaries {
        let other = sum_p_o.map_or(String::new(), |sum| format!(", sum p_o = {:.6e} {unit}", told(sum)));
        let [normal, tangential] = [sum_p_n, sum_p_t].map(|sum| told(*sum));
        say!("contact      {boundary}: sum p_n = {normal:.6e} {unit}, sum p_t = {tangential:.6e} {unit}{other}");
        say!("             force on the obstacle ({}) {unit}", components(force));
    }
    if let Some(BalanceRecord { supports, springs, balance, .. }) = report.reactions.last() {
        for (kind, Acting { at, force, .. }) in
            supports.iter().map(|support| ("reaction", support)).chain(springs.iter().map(|spring| ("spring", spring)))
        {
            say!("{kind:<12} {at}: ({}) {unit} on the body", components(force));
        }
        say!("balance      all forces on the body leave {balance:.1e} of their sizes");
    }
    if let Some(largest) = &report.largest_displacement {
        let length = units.of_si(Quantity::Length, largest.length);
        say!("displaced    by {length:.3e} {} at most", units.name(Quantity::Length));
    }
    say!(
        "work         {} iterations, {} factorisations, {} symbolic analysis, {} entries in L and U",
        totals.iterations,
        totals.factorizations,
        totals.symbolic_analyses,
        totals.nnz_factors
    );
    let memory = totals.peak_rss_bytes.map_or(String::new(), |bytes| format!(", {:.0} MB", bytes as f64 * 1e-6));
    say!("took         {:.2} s ({:.2} s CPU){memory}", totals.wall_seconds, totals.cpu_seconds);
    if let Some(faster) = &report.faster_solver {
        say!("faster       {faster}");
    }
}
