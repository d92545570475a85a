//! `stickslip compare`.

mod cells;
mod csv;
mod tables;

use super::progress::bar;
use super::run::write_failure;
use super::{ExitStatus, Failure, Invocation, origin};
use crate::compare::{
    self, Cells, CompareError, Comparison, ElementChoice, End, MeshChoice, MeshResult, MeshSize, Plan, SolverPath,
};
use cells::CellFolder;
use clap::Args;
use std::fs;
use std::path::{Path, PathBuf};
use stickslip::algebra::linear::{self, SparseLu};
use stickslip::base::{Quantity, UnitSystem};
use stickslip::run::report::Estimates;
use stickslip::scene::{Override, Scene};
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Method, Start, Status};
use stickslip_output::write_file;
use tables::tables;

#[derive(Args)]
pub(super) struct CompareArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Replace a value of the scene, e.g. contact.friction=0
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<Override>,
    /// Solution methods
    #[arg(long, value_delimiter = ',', value_parser = ["bn", "ip", "events"], default_value = "bn,ip")]
    methods: Vec<String>,
    /// Settings of the methods
    #[arg(long, value_delimiter = ',', value_parser = ["default", "paper"], default_value = "default")]
    settings: Vec<String>,
    /// Linear solvers [default: umfpack, condensed and faer, as far as built in]
    #[arg(long, value_delimiter = ',')]
    solvers: Vec<LinearAlgebra>,
    /// Meshes, each by its first number of elements, the other numbers in the proportions of the scene [default: an
    /// eighth, a quarter and half of the scene's]; for a scene with a mesh file, mesh files, relative to the scene
    /// file: a.msh,b.msh
    #[arg(long, value_delimiter = ',')]
    meshes: Vec<MeshSize>,
    /// Elements of each mesh: cell types as in mesh.cells, strains as in mesh.element, or both:
    /// triangle6,quadrilateral:b-bar
    #[arg(long, value_delimiter = ',')]
    elements: Vec<ElementChoice>,
    /// Numbers of increments of the whole history [default: a quarter, half and all of the scene's]
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    increments: Vec<u32>,
    /// Increments of the reference, as a multiple of those of the finest history; unused if the exact path is the
    /// reference
    #[arg(long, value_name = "TIMES", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..))]
    reference: u32,
    /// Number of histories computed at a time, each on one thread [default: the number of threads]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Write the tables (compare.csv, iterations.csv, meshes.csv), the charts, and a summary of both (compare.md) into
    /// this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Resume an interrupted comparison: completed histories are not computed again
    #[arg(long, requires = "out")]
    resume: bool,
    /// Print only the runs, as comma-separated values
    #[arg(long)]
    csv: bool,
}

/// Returns the method of these names. The paper's interior point method starts from the safe point.
fn method(name: &str, setting: &str) -> HistoryMethod {
    match (name, setting) {
        ("ip", "paper") => Method::paper_ip(Start::Safe).into(),
        ("ip", _) => Method::Ip.into(),
        ("events", _) => HistoryMethod::EVENTS,
        (_, "paper") => Method::PaperBn.into(),
        _ => Method::BN.into(),
    }
}

/// Exit status 1: a history in a default setting, or a reference, did not converge. The settings of the paper may fail,
/// which the table shows.
pub(super) fn compare(args: &CompareArgs, threads: usize, invocation: &Invocation) -> Result<ExitStatus, Failure> {
    let scene = Scene::read(&args.scene, &args.overrides)?;
    let solvers = solvers(&args.solvers)?;
    let plan = plan(args, threads, &solvers, &scene);
    if let Some(file) = args.out.as_ref().filter(|out| out.exists() && !out.is_dir()) {
        return Err(write_failure(file, &std::io::ErrorKind::NotADirectory.into()));
    }
    let kept = match &args.out {
        Some(out) => {
            let cells = CellFolder::open(out, origin(&scene)?, args.resume);
            Some(cells.map_err(|error| write_failure(out, &error))?)
        }
        None => None,
    };
    let cells = kept.as_ref().map_or(&() as &dyn Cells, |kept| kept);
    linear::process::keep_freed_memory();
    let bar = bar(plan.histories(), "histories");
    let mut started = false;
    let mut progress = |what: String| {
        bar.inc(u64::from(started));
        started = true;
        bar.set_message(what);
    };
    let comparison = compare::compute(&scene, &plan, cells, &mut progress).map_err(|error| match error {
        CompareError::Run(error) => Failure::from(error),
        of_the_plan => Failure::Input(of_the_plan.into()),
    })?;
    bar.finish_and_clear();

    if args.csv {
        csv::runs(&comparison).lines().for_each(|line| say!("{line}"));
    } else {
        say!("{}\n", comparison.title);
        if let Some(blas) = &comparison.blas {
            say!("{}\n", blas.with_threads());
        }
        say!("{}", tables(&comparison, &comparison.meshes));
        comparison.answers().iter().for_each(|answer| say!("{answer}"));
    }
    if let Some(folder) = &args.out {
        write(folder, &comparison, invocation)?;
        if let Some(cells) = &kept {
            cells.remove().map_err(|error| write_failure(folder, &error))?;
        }
        if !args.csv {
            say!("results      {}", folder.display());
        }
    }
    let runs = comparison.runs.iter().filter(|run| !run.path.method.increments().is_of_paper()).map(|run| run.status);
    let mut statuses = runs.chain(comparison.meshes.iter().map(|result| result.status));
    let sound = statuses.all(|status| status == Status::Converged);
    Ok(if sound { ExitStatus::Success } else { ExitStatus::NotConverged })
}

/// Returns the linear solvers to compare.
fn solvers(given: &[LinearAlgebra]) -> Result<Vec<LinearAlgebra>, Failure> {
    if let Some(absent) = given.iter().find(|linear| !linear.is_built_in()) {
        let help = format!("remove it, or use \"{}\" or \"condensed\"", LinearAlgebra::default());
        return Err(Failure::Input(miette::miette!(help = help, "--solvers: {absent} is not in this build")));
    }
    if !given.is_empty() {
        return Ok(given.to_vec());
    }
    let [umfpack, faer] = [SparseLu::Umfpack, SparseLu::Faer].map(LinearAlgebra::Whole);
    Ok([umfpack, LinearAlgebra::condensed(), faer].into_iter().filter(|linear| linear.is_built_in()).collect())
}

fn plan(args: &CompareArgs, threads: usize, solvers: &[LinearAlgebra], scene: &Scene) -> Plan {
    let mut paths = Vec::new();
    for &linear in solvers {
        for name in &args.methods {
            paths.extend(args.settings.iter().map(|setting| SolverPath { method: method(name, setting), linear }));
            // The exact path has only one setting.
            paths.dedup();
        }
    }
    let jobs = args.jobs.map_or(threads, usize::from);
    let mut plan = Plan { reference: args.reference as usize, jobs, ..Plan::modest(scene, paths) };
    if !args.meshes.is_empty() {
        plan.meshes = args.meshes.iter().cloned().map(MeshChoice::from).collect();
    }
    if !args.elements.is_empty() {
        let with = |mesh: &MeshChoice, elements| MeshChoice { elements: Some(elements), ..mesh.clone() };
        let each = args.elements.iter().flat_map(|&elements| plan.meshes.iter().map(move |mesh| with(mesh, elements)));
        plan.meshes = each.collect();
    }
    if !args.increments.is_empty() {
        plan.increments = args.increments.iter().map(|&number| number as usize).collect();
    }
    plan
}

/// Returns the table fields of a mesh: its elements if they were chosen, and its size.
fn fields(mesh: &MeshChoice) -> [String; 2] {
    let elements = mesh.elements.map_or(String::new(), |elements| elements.to_string());
    let size = match &mesh.size {
        MeshSize::Elements(n) => n.to_string(),
        size => MeshChoice::from(size.clone()).to_string(),
    };
    [elements, size]
}

/// The cost of a mesh and its error estimates. Values that do not apply are NaN.
struct Told {
    /// CPU time, s.
    seconds: Option<f64>,
    /// The nodes across the contact zone with the largest force.
    across: Option<usize>,
    /// The estimated error of the peak pressure.
    peak: f64,
    /// The estimated error in the energy norm.
    norm: f64,
    /// The share by which locking makes the elements too stiff.
    locking: f64,
}

fn told(comparison: &Comparison, result: &MeshResult) -> Told {
    let estimates = result.estimates.as_ref();
    let share = |of: fn(&Estimates) -> Option<f64>| estimates.and_then(of).unwrap_or(f64::NAN);
    Told {
        seconds: comparison.seconds(&result.mesh),
        across: estimates.and_then(|estimates| estimates.heaviest()?.nodes_across),
        peak: share(|estimates| estimates.peak_error),
        norm: share(|estimates| estimates.discretisation),
        locking: share(|estimates| estimates.locking),
    }
}

/// Returns the sums of the contact forces, the energy and the friction work, in `units`.
fn resultants(result: &MeshResult, units: &UnitSystem) -> [f64; 5] {
    // + 0.0 because the sum of no forces is -0.
    let sum = |forces: &[f64]| units.of_si(Quantity::Force, forces.iter().sum::<f64>() + 0.0);
    let End { p_n, p_t, p_o, energy, work, .. } = &result.end;
    let [energy, work] = [energy, work].map(|energy| units.of_si(Quantity::Energy, *energy));
    [sum(p_n), sum(p_t), sum(p_o), energy, work]
}

/// Quotes an argument for a shell, to which brackets are special, too.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+".contains(c);
    if argument.chars().all(plain) { argument.to_string() } else { format!("'{}'", argument.replace('\'', r"'\''")) }
}

fn write(folder: &Path, comparison: &Comparison, invocation: &Invocation) -> Result<(), Failure> {
    let written = |result: std::io::Result<()>| result.map_err(|error| write_failure(folder, &error));
    written(fs::create_dir_all(folder))?;
    written(write_file(folder, "compare.csv", csv::runs(comparison)))?;
    written(write_file(folder, "iterations.csv", csv::iterations(comparison)))?;
    written(write_file(folder, "meshes.csv", csv::meshes(comparison)))?;
    let command =
        invocation.arguments.iter().map(|argument| quoted(&argument.to_string_lossy())).collect::<Vec<_>>().join(" ");
    let mut page = format!("## {}\n\n```sh\nstickslip {command}\n```\n\n", comparison.title);
    page.extend(comparison.blas.as_ref().map(|blas| format!("{}.\n\n", blas.with_threads())));
    page.extend(comparison.answers().iter().map(|answer| format!("- {answer}\n")));
    for (stem, what, chart) in compare::charts(comparison) {
        let svg = chart.to_svg().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        let file = format!("{stem}.svg");
        written(write_file(folder, &file, &svg))?;
        page.extend(["\n![", what, "](", &file, ")\n"]);
    }
    // The other meshes are in compare.csv.
    let finest = comparison.meshes.len().saturating_sub(1);
    page.extend(["\n```text\n", &tables(comparison, &comparison.meshes[finest..]), "```\n"]);
    written(write_file(folder, "compare.md", &page))
}
