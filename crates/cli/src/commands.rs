//! The command line, for the program and for the Python package. Only this module prints.

/// Prints a line on standard output.
macro_rules! say {
    ($($arg:tt)*) => { super::output::line(format_args!($($arg)*)) };
}

/// Prints a line with a label on standard output, broken to fit a screen.
macro_rules! row {
    ($($arg:tt)*) => { $crate::commands::output::labelled(&format!($($arg)*)) };
}

mod bug;
mod capacity;
mod check;
mod collection;
mod compare;
mod converge;
mod export;
mod init;
mod interrupt;
mod memory;
mod output;
mod page;
mod progress;
#[cfg(feature = "petsc")]
mod ranks;
mod run;
mod schema;
mod shell;
mod solve;
mod study;
mod sweep;
mod threads;
mod uniqueness;

use clap::error::{ContextKind, ContextValue};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use std::ffi::{OsStr, OsString};
use std::fmt::Display;
use std::iter;
#[cfg(feature = "blas")]
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process;
#[cfg(feature = "blas")]
use stickslip::algebra::linear::process::{Blas, KERNEL_VARIABLE};
use stickslip::run::RunError;
use stickslip::scene::{Override, Provenance, Scene, SceneError};
use stickslip_exchange::ExchangeError;

/// Quasi-static elastic contact with Coulomb friction.
#[derive(Parser)]
#[command(name = "stickslip", subcommand_required = true, arg_required_else_help = true)]
struct Cli {
    #[command(subcommand)]
    command: Command,
    /// Number of threads [default: OMP_NUM_THREADS if set, otherwise the number of processors]
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(threads::MOST)))]
    threads: Option<u32>,
    #[arg(skip)]
    invocation: Invocation,
}

/// The command line as it was given.
#[derive(Debug, Clone, Default)]
pub struct Invocation {
    /// The command that starts this program again: its path, or an interpreter with a module.
    pub program: Vec<OsString>,
    /// The arguments after the program.
    pub arguments: Vec<OsString>,
}

impl Invocation {
    /// Returns the command line as it can be typed in a shell.
    fn command_line(&self) -> String {
        // Brackets are special to a shell, too.
        let plain = |c: char| c.is_alphanumeric() || "-_./,:=+".contains(c);
        let quoted = |argument: &OsString| match argument.to_string_lossy() {
            argument if argument.chars().all(plain) => argument.into_owned(),
            argument => format!("'{}'", argument.replace('\'', r"'\''")),
        };
        let arguments = self.arguments.iter().map(quoted);
        iter::once("stickslip".to_string()).chain(arguments).collect::<Vec<_>>().join(" ")
    }

    /// Returns a process that runs this program again, with no argument yet.
    fn again(&self) -> process::Command {
        let (program, first) = self
            .program
            .split_first()
            .map_or((OsStr::new("stickslip"), &[][..]), |(program, first)| (program.as_os_str(), first));
        let mut command = process::Command::new(program);
        command.args(first);
        command
    }
}

/// The exit status of the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum ExitStatus {
    /// Converged, or done.
    Success = 0,
    /// Not converged; the results reached so far are written.
    NotConverged = 1,
    /// An error of the input.
    BadInput = 2,
    /// A failure of the machine (memory, disk), or a bug of this program.
    MachineFailure = 3,
}

#[derive(Subcommand)]
enum Command {
    /// Solve a scene over its load history
    Run(run::RunArgs),
    /// Read a scene and explain how it was understood, without solving it
    Check(check::CheckArgs),
    /// Make the page report.html of a result folder again
    Report(page::ReportArgs),
    /// Print the JSON Schema of scenes or of reports
    Schema(schema::SchemaArgs),
    /// Compare methods, linear solvers, increments and meshes on one scene: error against time
    Compare(compare::CompareArgs),
    /// Refine mesh and increments of a scene until a quantity is known to an asked share
    Converge(converge::ConvergeArgs),
    /// Find the factor by which a load may grow until the joint slips as a whole
    Capacity(capacity::CapacityArgs),
    /// Run a scene for all combinations of several values of its keys, in parallel
    Sweep(sweep::SweepArgs),
    /// Solve a problem from an exchange file: FCLIB (HDF5) or Siconos text
    Solve(solve::SolveArgs),
    /// Measure how well a solution of an exchange file satisfies the laws
    Judge(solve::JudgeArgs),
    /// Solve all exchange files of a folder
    Collection(collection::CollectionArgs),
    /// Write one increment of a scene as a problem for other programs
    Export(export::ExportArgs),
    /// Print a commented example scene to start from
    Init(init::InitArgs),
    /// Print a script for command completion in a shell
    Completions(shell::CompletionsArgs),
    /// Print a manual page, for man(1)
    Man(shell::ManArgs),
}

/// A scene file and the changes to it.
#[derive(Args)]
struct SceneArgs {
    /// The scene file (TOML)
    scene: PathBuf,
    /// Replace a value of the scene, e.g. 'mesh.elements=[50,50]' or 'contact[0].friction=0.3'
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<Override>,
    /// Solution method, replaces solver.method: bn, ip or events; ip and events use the setting default
    #[arg(long)]
    method: Option<String>,
    /// Named set of method constants, replaces solver.setting
    #[arg(long)]
    setting: Option<String>,
    /// Linear solver, replaces solver.linear
    #[arg(long)]
    solver: Option<String>,
}

impl SceneArgs {
    fn read(&self) -> Result<Scene, SceneError> {
        Scene::read(&self.scene, &self.overrides())
    }

    /// Returns all changes, in the order in which they are applied.
    fn overrides(&self) -> Vec<Override> {
        // The setting in the scene belongs to the method in the scene.
        let other_method = self.method.as_deref().is_some_and(|method| method != "bn");
        let setting = self.setting.as_deref().or(other_method.then_some("default"));
        let options = [
            ("solver.method", self.method.as_deref()),
            ("solver.setting", setting),
            ("solver.linear", self.solver.as_deref()),
        ];
        let options = options.iter().filter_map(|(key, value)| Some(Override::value(key, (*value)?)));
        self.overrides.iter().cloned().chain(options).collect()
    }
}

/// Returns the identification that is stored with the results of `scene`.
fn origin(scene: &Scene) -> Result<Provenance, Failure> {
    Ok(Provenance::new(scene, &version()).map_err(|(file, error)| {
        let message = format!("{}: the file cannot be read: {error}", file.display());
        scene.error_of_file(&file, message, "name an existing file, relative to the scene file")
    })?)
}

/// The reason why a command ended without a result.
enum Failure {
    /// An error of the input: exit status 2.
    Input(miette::Report),
    /// A failure of the machine: exit status 3.
    Machine(miette::Report),
}

impl Failure {
    /// An error of the input, with its cure.
    fn input(message: impl Display, cure: impl Display) -> Self {
        Failure::Input(miette::miette!(help = cure.to_string(), "{message}"))
    }

    /// A failure of the machine, with its cure.
    fn machine(message: impl Display, cure: impl Display) -> Self {
        Failure::Machine(miette::miette!(help = cure.to_string(), "{message}"))
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Failure::Input(error.into())
    }
}

impl From<ExchangeError> for Failure {
    fn from(error: ExchangeError) -> Self {
        Failure::input(&error, error.help())
    }
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        let of_the_input = error.is_of_the_input();
        let report = miette::Report::from(error);
        if of_the_input { Failure::Input(report) } else { Failure::Machine(report) }
    }
}

impl Cli {
    fn run(&self) -> Result<ExitStatus, Failure> {
        let threads = threads::count(self.threads);
        threads::start(threads);
        #[cfg(feature = "petsc")]
        match (&self.command, ranks::lead()?) {
            (Command::Compare(_), count) => ranks::refuse("compare", count)?,
            (Command::Converge(_), count) => ranks::refuse("converge", count)?,
            (Command::Capacity(_), count) => ranks::refuse("capacity", count)?,
            (Command::Sweep(_), count) => ranks::refuse("sweep", count)?,
            _ => {}
        }
        match &self.command {
            Command::Run(args) => run::run(args, threads),
            Command::Check(args) => check::check(args).map(|()| ExitStatus::Success),
            Command::Compare(args) => compare::compare(args, threads, &self.invocation),
            Command::Converge(args) => converge::converge(args, &self.invocation),
            Command::Capacity(args) => capacity::capacity(args, &self.invocation),
            Command::Sweep(args) => sweep::sweep(args, self),
            Command::Solve(args) => solve::solve_file(args),
            Command::Judge(args) => solve::judge_file(args),
            Command::Collection(args) => collection::collection(args, threads),
            Command::Export(args) => export::export_scene(args),
            Command::Report(args) => page::report(args).map(|()| ExitStatus::Success),
            Command::Schema(args) => {
                schema::schema(args);
                Ok(ExitStatus::Success)
            }
            Command::Init(args) => init::init(args).map(|()| ExitStatus::Success),
            Command::Completions(args) => {
                shell::completions(args, program());
                Ok(ExitStatus::Success)
            }
            Command::Man(args) => shell::man(args, program()).map(|()| ExitStatus::Success),
        }
    }
}

/// Returns the version of the program and of the C libraries in this build.
#[cfg(feature = "umfpack")]
fn version() -> String {
    let version = |[major, minor, patch]: [i32; 3]| format!("{major}.{minor}.{patch}");
    format!(
        "{} (SuiteSparse {}, UMFPACK {})",
        env!("CARGO_PKG_VERSION"),
        version(stickslip::algebra::linear::suitesparse_version()),
        version(stickslip::algebra::linear::umfpack_version())
    )
}

#[cfg(not(feature = "umfpack"))]
fn version() -> String {
    concat!(env!("CARGO_PKG_VERSION"), " (without UMFPACK)").to_string()
}

/// Returns the description of the program for help, completions and manual.
fn program() -> clap::Command {
    Cli::command().version(version()).max_term_width(100)
}

/// Adds the missing command to the error if a file name was given in place of a command, and what answers the same as an
/// option of earlier versions.
fn with_command(mut error: clap::Error) -> clap::Error {
    if error.get(ContextKind::InvalidArg) == Some(&ContextValue::String("--companion".to_string())) {
        let tip = "stickslip sweep SCENE --vary time.increments=10,40, or stickslip converge";
        error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    }
    let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) else { return error };
    let command = match Path::new(name).extension().and_then(|end| end.to_str()) {
        Some("toml") => "run",
        Some("hdf5" | "h5" | "dat") => "solve",
        _ => return error,
    };
    let tip = format!("did you mean: stickslip {command} {name}");
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// Starts the program again in this process, if OpenBLAS has chosen a slower kernel than the fastest for this processor
/// and the user has named none. OpenBLAS reads the name when it is loaded.
#[cfg(feature = "blas")]
fn take_better_kernel(invocation: &Invocation) {
    let blas = Blas::loaded().filter(|blas| blas.selectable && blas.kernel_asked.is_none());
    if let Some(better) = blas.and_then(|blas| blas.better_kernel) {
        // Returns only if it fails. The program then goes on, and warns of the kernel.
        let _ = invocation.again().args(&invocation.arguments).env(KERNEL_VARIABLE, better).exec();
    }
}

/// Does what `invocation` says, and prints what came out.
pub fn main(invocation: Invocation) -> ExitStatus {
    #[cfg(feature = "blas")]
    take_better_kernel(&invocation);
    #[cfg(feature = "petsc")]
    stickslip_distributed::add();
    #[cfg(feature = "petsc")]
    if ranks::may_help()
        && let Some(code) = ranks::help()
    {
        return code;
    }
    let json = invocation.arguments.iter().any(|argument| argument == "--json");
    memory::end_in_order(json);
    let name = OsStr::new("stickslip");
    let matches =
        program().try_get_matches_from(iter::once(name).chain(invocation.arguments.iter().map(OsString::as_os_str)));
    let mut cli = match matches.and_then(|matches| Cli::from_arg_matches(&matches)) {
        Ok(cli) => cli,
        Err(error) => {
            let error = with_command(error);
            // The other processes of the launcher wait until rank 0 has started and ended MPI.
            #[cfg(feature = "petsc")]
            if ranks::lead().is_ok() {
                stickslip_distributed::end();
            }
            if json && error.use_stderr() {
                output::failure_as_json("bad-input", &error.render().to_string());
            }
            // A closed standard output is no reason for another message.
            let _ = error.print();
            return if error.use_stderr() { ExitStatus::BadInput } else { ExitStatus::Success };
        }
    };
    cli.invocation = invocation;
    let code = match bug::caught(|| cli.run()) {
        // The input was read only in part because memory ran out, so the input is not the cause.
        Ok(Err(Failure::Input(report))) if memory::is_short() => output::failure(&Failure::Machine(report), json),
        Ok(Ok(code)) => code,
        Ok(Err(failure)) => output::failure(&failure, json),
        // Some failures for lack of memory do not mention memory.
        Err(_) if memory::is_short() => output::failure(&Failure::machine(memory::MESSAGE, memory::HELP), json),
        Err(bug) => {
            output::note(&bug);
            if json {
                output::failure_as_json("bug", &bug);
            }
            ExitStatus::MachineFailure
        }
    };
    #[cfg(feature = "petsc")]
    stickslip_distributed::end();
    // If standard output failed, the reader has not received the result, whatever it was.
    if output::failed() { ExitStatus::MachineFailure } else { code }
}
