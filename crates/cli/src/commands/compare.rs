//! `stickslip compare`.

use super::run::write_failure;
use super::study::{StudyFolder, counted, print_results};
use super::{ExitStatus, Failure, Invocation, interrupt, origin};
use crate::compare::{self, CellFolder, Cells, Comparison, Plan, SolverPath};
use crate::study::{ElementChoice, MeshChoice, MeshSize};
use clap::Args;
use std::path::PathBuf;
use stickslip::algebra::linear::{self, SparseLu};
use stickslip::scene::{Override, Scene};
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Method, Start, Status};
use stickslip_output::paragraph;

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
    /// Linear solvers; auto suits the sizes of each mesh [default: umfpack, condensed and faer, as far as built in]
    #[arg(long, value_delimiter = ',', value_parser = solver)]
    solvers: Vec<Option<LinearAlgebra>>,
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

/// The files of a comparison. Not all comparisons have all pictures.
const FILES: [&str; 7] =
    ["compare.csv", "iterations.csv", "meshes.csv", "compare.md", "forces.svg", "mesh-size.svg", "mesh-time.svg"];

/// The first columns of every `compare.csv`.
const COLUMNS: &str = "method,setting,solver,elements,mesh,increments,";

/// Returns the method of these names. The paper's interior point method starts from the safe point.
fn method(name: &str, setting: &str) -> HistoryMethod {
    match (name, setting) {
        ("ip", "paper") => Method::paper_ip(Start::Safe).into(),
        ("ip", _) => Method::Ip.into(),
        ("events", _) => HistoryMethod::ExactPath,
        (_, "paper") => Method::PaperBn.into(),
        _ => Method::BN.into(),
    }
}

/// Exit status 1: a history in a default setting, or a reference, did not converge. The settings of the paper may fail,
/// which the table shows.
pub(super) fn compare(args: &CompareArgs, threads: usize, invocation: &Invocation) -> Result<ExitStatus, Failure> {
    interrupt::listen();
    let scene = Scene::read(&args.scene, &args.overrides)?;
    let solvers = solvers(&args.solvers)?;
    let plan = plan(args, threads, &solvers, &scene);
    let folder = StudyFolder::open(args.out.as_deref(), &FILES, COLUMNS)?;
    let open = |StudyFolder { path, .. }: &StudyFolder<'_>| {
        CellFolder::open(path, origin(&scene)?, args.resume).map_err(|error| write_failure(path, &error))
    };
    let store = folder.as_ref().map(open).transpose()?;
    let cells = store.as_ref().map_or(&() as &dyn Cells, |kept| kept);
    linear::process::keep_freed_memory();
    let (bar, mut progress) = counted(plan.histories(), "histories");
    let comparison = compare::compute(&scene, &plan, cells, &mut progress, interrupt::requested)?;
    bar.finish_and_clear();

    let labels = ["answers"].into_iter().chain(std::iter::repeat(""));
    let answers: String = labels.zip(comparison.answers()).map(|(label, answer)| paragraph(label, &answer)).collect();
    let blas = comparison.blas.as_ref().map_or(String::new(), |blas| format!("{}\n\n", blas.with_threads()));
    let mut text = format!("{}\n\n{answers}\n{blas}{}", comparison.title, comparison.to_text(&comparison.meshes));
    let done = comparison.meshes.len() + comparison.runs.len();
    if interrupt::requested() {
        let cure = if folder.is_some() {
            "repeat the command with --resume to continue"
        } else {
            "with --out it can be continued"
        };
        let line = format!("\ninterrupted  {done} of {} histories are complete; {cure}", plan.histories());
        text += &line;
    }
    let runs = comparison.runs_csv();
    print_results(folder.as_ref(), args.csv.then_some(&runs), &text, || files(&comparison, invocation))?;
    if interrupt::requested() {
        return Ok(ExitStatus::NotConverged);
    }
    if let (Some(folder), Some(cells)) = (&folder, &store) {
        cells.remove().map_err(|error| write_failure(folder.path, &error))?;
    }
    let runs =
        comparison.runs.iter().filter(|run| !run.path.method.increments().is_of_paper()).map(|run| run.course.status);
    let mut statuses = runs.chain(comparison.meshes.iter().map(|result| result.status));
    let all_converged = statuses.all(|status| status == Status::Converged);
    Ok(if all_converged { ExitStatus::Success } else { ExitStatus::NotConverged })
}

/// Parses a linear solver; `auto` is none in particular.
fn solver(word: &str) -> Result<Option<LinearAlgebra>, String> {
    if word == "auto" { Ok(None) } else { word.parse().map(Some) }
}

/// Returns the linear solvers to compare.
fn solvers(given: &[Option<LinearAlgebra>]) -> Result<Vec<Option<LinearAlgebra>>, Failure> {
    if let Some(absent) = given.iter().flatten().find(|linear| !linear.is_built_in()) {
        let help = format!("remove it, or use \"{}\" or \"condensed\"", LinearAlgebra::default());
        return Err(Failure::input(format!("--solvers: {absent} is not in this build"), help));
    }
    if !given.is_empty() {
        return Ok(given.to_vec());
    }
    let [umfpack, faer] = [SparseLu::Umfpack, SparseLu::Faer].map(LinearAlgebra::Whole);
    let all = [umfpack, LinearAlgebra::condensed(), faer].into_iter().filter(|linear| linear.is_built_in());
    Ok(all.map(Some).collect())
}

fn plan(args: &CompareArgs, threads: usize, solvers: &[Option<LinearAlgebra>], scene: &Scene) -> Plan {
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

/// Returns the files of a comparison, names and contents.
fn files(comparison: &Comparison, invocation: &Invocation) -> Result<Vec<(String, String)>, Failure> {
    let mut page = format!("## {}\n\n```sh\n{}\n```\n\n", comparison.title, invocation.command_line());
    page.extend(comparison.blas.as_ref().map(|blas| format!("{}.\n\n", blas.with_threads())));
    page.extend(comparison.answers().iter().map(|answer| format!("- {answer}\n")));
    let mut charts = Vec::new();
    for (stem, what, chart) in compare::charts(comparison) {
        let file = format!("{stem}.svg");
        page.extend(["\n![", what, "](", &file, ")\n"]);
        charts.push((file, chart.to_svg()?));
    }
    // The other meshes are in compare.csv.
    let finest = comparison.meshes.len().saturating_sub(1);
    page.extend(["\n```text\n", &comparison.to_text(&comparison.meshes[finest..]), "```\n"]);
    let tables = [comparison.runs_csv(), comparison.iterations_csv(), comparison.meshes_csv(), page];
    Ok(FILES.map(String::from).into_iter().zip(tables).chain(charts).collect())
}
