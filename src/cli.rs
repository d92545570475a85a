//! The command line: the only place that prints.
//!
//! Exit status: 0 converged, 1 not converged (what was reached is written), 2 bad input,
//! 3 the machine failed (memory, disk).

#![allow(clippy::print_stderr)]

/// Prints a line on standard output. A reader who has gone, as in `stickslip ... | head`, is no
/// reason to stop a run.
macro_rules! say {
    ($($arg:tt)*) => { super::print_line(format_args!($($arg)*)) };
}

mod check;
mod compare;
mod extremes;
mod figures;
mod interrupt;
mod jobs;
mod progress;
mod run;
mod tables;
mod uniqueness;
mod verdict;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use stickslip::formulation::Layout;
use stickslip::linear::LinearError;
use stickslip::model::Model;
use stickslip::report::available_bytes;
use stickslip::scene::{Override, Scene, SceneError};

/// Quasi-static elastic contact with Coulomb friction.
#[derive(Parser)]
#[command(name = "stickslip", subcommand_required = true, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Threads for the BLAS behind the factorisation
    #[cfg(feature = "umfpack")]
    #[arg(long, global = true, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: u32,
}

#[derive(Subcommand)]
enum Command {
    /// Solve a scene over its load history
    Run(run::RunArgs),
    /// Read and explain a scene without solving it
    Check(check::CheckArgs),
    /// Compute a table of the paper and set it beside the published one
    Tables(tables::TablesArgs),
    /// Draw the figures of the paper
    Figures(figures::FiguresArgs),
    /// Run the suite of extreme scenes, data/extremes.toml
    Extremes(extremes::ExtremesArgs),
    /// Compare methods, linear algebra, increments and meshes on a scene: error against time
    Compare(compare::CompareArgs),
}

/// A scene and what to change in it.
#[derive(Args)]
struct SceneArgs {
    /// The scene file (TOML)
    scene: PathBuf,
    /// Put VALUE in place of what the scene says, e.g. mesh.elements=[50,50] or contact[0].friction=0.3
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<Override>,
    /// The algorithm, as solver.method; ip comes with its own default setting
    #[arg(long)]
    method: Option<String>,
    /// The named set of constants, as solver.setting
    #[arg(long)]
    setting: Option<String>,
    /// The linear algebra, as solver.linear
    #[arg(long)]
    solver: Option<String>,
}

impl SceneArgs {
    fn read(&self) -> Result<Scene, SceneError> {
        // The setting in the scene is that of its own method.
        let other_method = self.method.as_deref().is_some_and(|method| method != "bn");
        let setting = self.setting.as_deref().or(other_method.then_some("default"));
        let options = [
            ("solver.method", self.method.as_deref()),
            ("solver.setting", setting),
            ("solver.linear", self.solver.as_deref()),
        ];
        let options = options.iter().filter_map(|(key, value)| Some(Override::value(key, (*value)?)));
        let overrides: Vec<Override> = self.overrides.iter().cloned().chain(options).collect();
        Scene::read(&self.scene, &overrides)
    }
}

/// Discretises a scene, unless the machine has no room for it or its method does not know such a problem.
fn discretise(scene: &Scene) -> Result<Model, Failure> {
    // The matrices alone, 16 bytes an entry, and for each unknown 27 of them in two dimensions and 81 in
    // three; the factors take more. Asking first is kinder than being killed half-way.
    let bytes = |(nodes, d): (usize, usize)| (nodes * d * 3_usize.pow(d as u32 + 1) * 16) as u64;
    let needed = scene.description.mesh.nodes().map_or(0, bytes);
    if let Some(available) = available_bytes().filter(|&available| available < needed) {
        let gigabytes = |bytes: u64| bytes as f64 * 1e-9;
        return Err(Failure::Machine(miette::miette!(
            help = "use a coarser mesh or a machine with more memory",
            "the matrices of this mesh need {:.1} GB and the factors more, but {:.1} GB are free",
            gigabytes(needed),
            gigabytes(available)
        )));
    }
    let model = Model::new(scene)?;
    if let Some(key) = scene.one_tangent_key
        && Layout::new(&model.problem).has_second_tangent()
    {
        let message = "this interior point method knows one tangent a node, but nodes of this scene slide in a plane";
        let help = "leave solver.setting and solver.newton out, or use the method \"bn\"";
        return Err(scene.error_at(key, message, help).into());
    }
    Ok(model)
}

/// Why a command ended without a result.
enum Failure {
    /// The input is to blame: exit status 2.
    Input(miette::Report),
    /// The machine is: exit status 3.
    Machine(miette::Report),
}

impl<E: miette::Diagnostic + Send + Sync + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Input(error.into())
    }
}

impl Failure {
    fn linear(error: &LinearError) -> Self {
        let report = match error {
            LinearError::OutOfMemory { .. } => {
                miette::miette!(help = "use a coarser mesh or a machine with more memory", "{error}")
            }
            error => miette::miette!(help = "this is not the scene's fault; please report it", "{error}"),
        };
        Failure::Machine(report)
    }
}

fn print_line(line: std::fmt::Arguments<'_>) {
    match writeln!(std::io::stdout(), "{line}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            eprintln!("standard output cannot be written: {error}");
            std::process::exit(3);
        }
        _ => {}
    }
}

/// The version of the program, and of the C libraries if there are any.
#[cfg(feature = "umfpack")]
fn version() -> String {
    let version = |[major, minor, patch]: [i32; 3]| format!("{major}.{minor}.{patch}");
    format!(
        "{} (SuiteSparse {}, UMFPACK {})",
        env!("CARGO_PKG_VERSION"),
        version(stickslip::linear::suitesparse_version()),
        version(stickslip::linear::umfpack_version())
    )
}

#[cfg(not(feature = "umfpack"))]
fn version() -> &'static str {
    concat!(env!("CARGO_PKG_VERSION"), " (without UMFPACK)")
}

pub(crate) fn main() -> ExitCode {
    let matches = Cli::command().version(version()).get_matches();
    let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    #[cfg(feature = "umfpack")]
    if stickslip::linear::process::set_blas_threads(cli.threads as usize).is_none() {
        eprintln!("note: the BLAS in use is not OpenBLAS, BLIS or MKL; factorisations may take several times longer");
    }
    let result = match &cli.command {
        Command::Run(args) => run::run(args),
        Command::Check(args) => check::check(args).map(|()| ExitCode::SUCCESS),
        Command::Tables(args) => tables::tables(args),
        Command::Figures(args) => figures::figures(args),
        Command::Extremes(args) => extremes::extremes(args),
        Command::Compare(args) => compare::compare(args),
    };
    match result {
        Ok(code) => code,
        Err(Failure::Input(report)) => {
            eprintln!("{report:?}");
            ExitCode::from(2)
        }
        Err(Failure::Machine(report)) => {
            eprintln!("{report:?}");
            ExitCode::from(3)
        }
    }
}
