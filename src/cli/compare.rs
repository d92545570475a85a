//! `stickslip compare`.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use stickslip::compare::{
    self, CompareError, Comparison, End, MeshChoice, MeshResult, Phases, Plan, SolverPath, Trial,
};
use stickslip::history::{LinearAlgebra, Method, Start, Status};
use stickslip::linear::{self, SparseLu};
use stickslip::report::{Table, csv_table, write_file};
use stickslip::scene::{Override, Scene};
use stickslip::units::{Quantity, UnitSystem};

use super::Failure;
use super::progress::bar;
use super::run::write_failure;

#[derive(Args)]
pub(super) struct CompareArgs {
    /// The scene file (TOML)
    scene: PathBuf,
    /// Put VALUE in place of what the scene says, e.g. contact.friction=0
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<Override>,
    /// The algorithms
    #[arg(long, value_delimiter = ',', value_parser = ["bn", "ip"], default_value = "bn,ip")]
    methods: Vec<String>,
    /// Their settings
    #[arg(long, value_delimiter = ',', value_parser = ["default", "paper"], default_value = "default")]
    settings: Vec<String>,
    /// The linear algebra; umfpack, condensed and faer, as far as they are built in, unless given
    #[arg(long, value_delimiter = ',')]
    solvers: Vec<LinearAlgebra>,
    /// The first number of elements of each mesh, the others in the proportions of the scene, an eighth, a
    /// quarter and half of the scene's unless given; or mesh files, where the scene has one: a.msh,b.msh
    #[arg(long, value_delimiter = ',')]
    meshes: Vec<MeshChoice>,
    /// Increments of the whole history; a quarter, half and all of the scene's unless given
    #[arg(long, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..))]
    increments: Vec<u32>,
    /// Increments of the reference, in those of the finest history
    #[arg(long, value_name = "TIMES", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..))]
    reference: u32,
    /// Write the tables as compare.csv, iterations.csv and meshes.csv, the charts, and all of it as
    /// compare.md into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print the runs as comma-separated values and nothing else
    #[arg(long)]
    csv: bool,
}

/// The method of these names; that of the paper's interior point method starts from the safe point.
fn method(name: &str, setting: &str) -> Method {
    match (name, setting) {
        ("ip", "paper") => Method::paper_ip(Start::Safe),
        ("ip", _) => Method::IP,
        (_, "paper") => Method::PaperBn,
        _ => Method::BN,
    }
}

/// Exit status 1: a history in a default setting, or a reference, did not converge. The settings of the paper may
/// fail; the table tells.
pub(super) fn compare(args: &CompareArgs) -> Result<ExitCode, Failure> {
    let scene = Scene::read(&args.scene, &args.overrides)?;
    let solvers = solvers(&args.solvers)?;
    let plan = plan(args, &solvers, &scene);
    if let Some(file) = args.out.as_ref().filter(|out| out.exists() && !out.is_dir()) {
        return Err(write_failure(file, &std::io::ErrorKind::NotADirectory.into()));
    }
    linear::process::keep_freed_memory();
    let bar = bar(plan.histories(), "histories");
    let mut started = false;
    let mut progress = |what: String| {
        bar.inc(u64::from(started));
        started = true;
        bar.set_message(what);
    };
    let comparison = compare::compute(&scene, &plan, &mut progress).map_err(|error| match error {
        CompareError::Run(error) => Failure::from(error),
        of_the_plan => Failure::Input(of_the_plan.into()),
    })?;
    bar.finish_and_clear();

    if args.csv {
        runs_csv(&comparison).lines().for_each(|line| say!("{line}"));
    } else {
        say!("{}\n\n{}", comparison.title, tables(&comparison, &comparison.meshes));
        comparison.answers().iter().for_each(|answer| say!("{answer}"));
    }
    if let Some(folder) = &args.out {
        write(folder, &comparison)?;
        if !args.csv {
            say!("written to   {}", folder.display());
        }
    }
    let runs = comparison.runs.iter().filter(|run| !run.path.method.is_of_paper()).map(|run| run.status);
    let mut statuses = runs.chain(comparison.meshes.iter().map(|result| result.status));
    let sound = statuses.all(|status| status == Status::Converged);
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The linear algebras that are compared.
fn solvers(given: &[LinearAlgebra]) -> Result<Vec<LinearAlgebra>, Failure> {
    if let Some(absent) = given.iter().find(|linear| !linear.is_built_in()) {
        let help = format!("leave it out, or use \"{}\" or \"condensed\"", LinearAlgebra::default());
        return Err(Failure::Input(miette::miette!(help = help, "--solvers: {absent} is not in this build")));
    }
    if !given.is_empty() {
        return Ok(given.to_vec());
    }
    let [umfpack, faer] = [SparseLu::Umfpack, SparseLu::Faer].map(LinearAlgebra::Whole);
    Ok([umfpack, LinearAlgebra::condensed(), faer].into_iter().filter(|linear| linear.is_built_in()).collect())
}

fn plan(args: &CompareArgs, solvers: &[LinearAlgebra], scene: &Scene) -> Plan {
    let mut paths = Vec::new();
    for &linear in solvers {
        for name in &args.methods {
            paths.extend(args.settings.iter().map(|setting| SolverPath { method: method(name, setting), linear }));
        }
    }
    let mut plan = Plan { reference: args.reference as usize, ..Plan::modest(scene, paths) };
    if !args.meshes.is_empty() {
        plan.meshes.clone_from(&args.meshes);
    }
    if !args.increments.is_empty() {
        plan.increments = args.increments.iter().map(|&number| number as usize).collect();
    }
    plan
}

/// What a person reads, but for the answers; runs on some of the `meshes` only.
fn tables(comparison: &Comparison, meshes: &[MeshResult]) -> String {
    let mut text = String::new();
    for result in meshes {
        let MeshResult { mesh, displacements, contacts, increments, status, seconds, .. } = result;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{mesh}: {displacements} displacements, {contacts} contact nodes; reference: {increments} increments, \
             {status}, {seconds:.2} s\n{}",
            runs_table(comparison, mesh)
        );
    }
    text + "* no other run is better in time and in the error of the forces; times but CPU are wall times, s\n\n"
        + &meshes_table(comparison).to_string()
}

const RUN_HEADS: [&str; 18] = [
    "path", "inc", "iter", "fact", "CPU, s", "wall", "set-up", "assembly", "factor", "solve", "rest", "entries", "MB",
    "p_n", "p_t", "forces", "work", "",
];

fn runs_table(comparison: &Comparison, mesh: &MeshChoice) -> Table {
    let mut table = Table::new(&RUN_HEADS);
    let front = comparison.front(mesh);
    for run in comparison.on(mesh) {
        let Phases { model, analysis, assembly, factorization, solve, rest, wall, cpu } = run.seconds;
        let mut row = vec![run.path.to_string(), run.increments.to_string(), run.iterations.to_string()];
        row.push(run.factorizations.to_string());
        row.extend([cpu, wall, model + analysis, assembly, factorization, solve, rest].map(|s| format!("{s:.3}")));
        row.push(run.factor_entries.to_string());
        let megabytes = run.factor_peak_bytes * 1e-6;
        row.push(if megabytes > 0.0 { format!("{megabytes:.1}") } else { "-".into() });
        let errors = run.errors.map(|errors| [errors.p_n, errors.p_t, errors.forces, errors.work]);
        row.extend(errors.unwrap_or([f64::NAN; 4]).map(|error| shown(error, comparison.tolerance)));
        row.push(match run.status {
            Status::Converged if front.contains(&run) => "*".into(),
            Status::Converged => String::new(),
            status => format!("{status} in increment {}", run.converged + 1),
        });
        table.push(row);
    }
    table
}

/// An error with two digits; what is below the tolerance is no more than that.
fn shown(error: f64, tolerance: f64) -> String {
    match error {
        _ if error.is_nan() => "-".into(),
        _ if error < tolerance => format!("<{tolerance:.0e}"),
        _ => format!("{error:.1e}"),
    }
}

fn meshes_table(comparison: &Comparison) -> Table {
    // In two dimensions there is no p_o.
    let in_space = comparison.meshes.iter().any(|result| result.end.p_o.iter().any(|p_o| *p_o != 0.0));
    let sums = ["sum p_n", "sum p_t", "sum p_o"].map(|sum| (sum, Quantity::Force));
    let energies = ["energy", "friction work"].map(|energy| (energy, Quantity::Energy));
    let resultants_told = sums.into_iter().take(if in_space { 3 } else { 2 }).chain(energies);
    let with_units = resultants_told.map(|(head, quantity)| format!("{head}, {}", comparison.units.name(quantity)));
    let counts = ["mesh", "n_u", "n_c"].map(String::from).into_iter();
    let errors = ["d sum p_n", "d sum p_t", "d energy", "d tractions"].map(String::from);
    let heads: Vec<String> = counts.chain(with_units).chain(errors).collect();
    let mut table = Table::new(&heads.iter().map(String::as_str).collect::<Vec<_>>());
    for result in &comparison.meshes {
        let [p_n, p_t, p_o, energy, work] = resultants(result, &comparison.units);
        let mut row = vec![short(&result.mesh)];
        row.extend([result.displacements, result.contacts].map(|count| count.to_string()));
        let numbers = [p_n, p_t].into_iter().chain(in_space.then_some(p_o)).chain([energy, work]);
        row.extend(numbers.map(|number| format!("{number:.6e}")));
        let errors = result.errors.map(|errors| [errors.sum_p_n, errors.sum_p_t, errors.energy, errors.tractions]);
        row.extend(errors.unwrap_or([f64::NAN; 4]).map(|error| shown(error, comparison.tolerance)));
        table.push(row);
    }
    table
}

/// A mesh as a field of a table: the number of elements alone.
fn short(mesh: &MeshChoice) -> String {
    match mesh {
        MeshChoice::Elements(n) => n.to_string(),
        MeshChoice::Own | MeshChoice::File(_) => mesh.to_string(),
    }
}

/// The sums of the contact forces, the energy and the friction work, in `units`.
fn resultants(result: &MeshResult, units: &UnitSystem) -> [f64; 5] {
    // + 0.0: the sum of no forces is -0.
    let sum = |forces: &[f64]| units.of_si(Quantity::Force, forces.iter().sum::<f64>() + 0.0);
    let End { p_n, p_t, p_o, energy, work, .. } = &result.end;
    let [energy, work] = [energy, work].map(|energy| units.of_si(Quantity::Energy, *energy));
    [sum(p_n), sum(p_t), sum(p_o), energy, work]
}

const RUN_COLUMNS: [&str; 25] = [
    "method",
    "setting",
    "solver",
    "mesh",
    "increments",
    "status",
    "converged",
    "iterations",
    "factorizations",
    "cpu_seconds",
    "wall_seconds",
    "model_seconds",
    "analysis_seconds",
    "assembly_seconds",
    "factor_seconds",
    "solve_seconds",
    "rest_seconds",
    "factor_entries",
    "factor_peak_bytes",
    "kkt_error",
    "error_p_n",
    "error_p_t",
    "error_forces",
    "error_work",
    "front",
];

fn runs_csv(comparison: &Comparison) -> String {
    let row = |run: &Trial| {
        let mut row = named_path(run);
        row.extend([run.status.to_string(), run.converged.to_string()]);
        row.extend([run.iterations, run.factorizations].map(|count| count.to_string()));
        let Phases { model, analysis, assembly, factorization, solve, rest, wall, cpu } = run.seconds;
        row.extend([cpu, wall, model, analysis, assembly, factorization, solve, rest].map(|s| format!("{s:.6}")));
        row.extend([
            run.factor_entries.to_string(),
            format!("{:.0}", run.factor_peak_bytes),
            format!("{:.2e}", run.kkt),
        ]);
        let errors = run.errors.map(|errors| [errors.p_n, errors.p_t, errors.forces, errors.work]);
        row.extend(numbers(errors));
        row.push(comparison.front(&run.mesh).contains(&run).to_string());
        row
    };
    csv_table(&RUN_COLUMNS, comparison.runs.iter().map(row))
}

fn named_path(run: &Trial) -> Vec<String> {
    let SolverPath { method, linear } = run.path;
    let names = [method.name().to_string(), method.setting().to_string(), linear.to_string()];
    names.into_iter().chain([short(&run.mesh), run.increments.to_string()]).collect()
}

/// Empty fields for what is not known.
fn numbers<const N: usize>(numbers: Option<[f64; N]>) -> [String; N] {
    numbers.unwrap_or([f64::NAN; N]).map(|number| if number.is_nan() { String::new() } else { format!("{number:.4e}") })
}

fn iterations_csv(comparison: &Comparison) -> String {
    let header =
        ["method", "setting", "solver", "mesh", "increments", "increment", "iteration", "seconds", "theta", "error"];
    let rows = comparison.runs.iter().flat_map(|run| {
        run.iterates.iter().map(|iterate| {
            let mut row = named_path(run);
            row.extend([iterate.increment, iterate.iteration].map(|number| number.to_string()));
            row.extend([format!("{:.6}", iterate.seconds), format!("{:.4e}", iterate.theta)]);
            row.extend(numbers(iterate.error.map(|error| [error])));
            row
        })
    });
    csv_table(&header, rows)
}

fn meshes_csv(comparison: &Comparison) -> String {
    let header = [
        "mesh",
        "displacements",
        "contacts",
        "increments",
        "status",
        "sum_p_n",
        "sum_p_t",
        "sum_p_o",
        "energy",
        "friction_work",
        "error_sum_p_n",
        "error_sum_p_t",
        "error_energy",
        "error_tractions",
    ];
    let row = |result: &MeshResult| {
        let counts = [result.displacements, result.contacts, result.increments];
        let mut row = vec![short(&result.mesh)];
        row.extend(counts.map(|count| count.to_string()));
        row.push(result.status.to_string());
        row.extend(resultants(result, &comparison.units).map(|number| number.to_string()));
        let errors = result.errors.map(|errors| [errors.sum_p_n, errors.sum_p_t, errors.energy, errors.tractions]);
        row.extend(numbers(errors));
        row
    };
    csv_table(&header, comparison.meshes.iter().map(row))
}

/// An argument as a shell takes it: brackets mean something there, too.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+".contains(c);
    if argument.chars().all(plain) { argument.to_string() } else { format!("'{}'", argument.replace('\'', r"'\''")) }
}

fn write(folder: &Path, comparison: &Comparison) -> Result<(), Failure> {
    let written = |result: std::io::Result<()>| result.map_err(|error| write_failure(folder, &error));
    written(fs::create_dir_all(folder))?;
    written(write_file(folder, "compare.csv", &runs_csv(comparison)))?;
    written(write_file(folder, "iterations.csv", &iterations_csv(comparison)))?;
    written(write_file(folder, "meshes.csv", &meshes_csv(comparison)))?;
    let command = std::env::args().skip(1).map(|argument| quoted(&argument)).collect::<Vec<_>>().join(" ");
    let mut page = format!("## {}\n\n```sh\nstickslip {command}\n```\n\n", comparison.title);
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
