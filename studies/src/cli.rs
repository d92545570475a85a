//! The command line: the only place that prints. A command computes, writes the files it is told to write, and hands
//! back what there is to say.

mod elements;
mod estimates;
mod extremes;
mod figures;
mod gaps;
mod jobs;
mod tables;
mod told;
mod warnings;

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use miette::{IntoDiagnostic, WrapErr};
use stickslip::algebra::linear::process;
use stickslip_output::write_file;

/// The paper's tables and figures, computed again, a suite of scenes at the limits, and what estimates are worth
#[derive(Parser)]
#[command(version)]
struct Cli {
    #[command(subcommand)]
    study: Study,
}

#[derive(Subcommand)]
enum Study {
    /// Compute a table of the paper and set it beside the published one
    Tables(tables::TablesArgs),
    /// Draw the figures of the paper
    Figures(figures::FiguresArgs),
    /// Set kinds of elements beside each other on problems whose answers are known
    Elements(elements::ElementsArgs),
    /// Run the suite of extreme scenes
    Extremes(extremes::ExtremesArgs),
    /// Compare forces and pressures of curved bodies on meshes that do not match with what is true
    Gaps(gaps::GapsArgs),
    /// Compare the estimates of a run with what is true
    Estimates(estimates::EstimatesArgs),
    /// Compare the errors that a run tells with the true ones
    Told(told::ToldArgs),
    /// Compare the warnings of random scenes with what is true
    Warnings(warnings::WarningsArgs),
}

/// What a study ends with.
struct Answer {
    /// What there is to say.
    lines: Vec<String>,
    /// Whether everything came out as it should.
    has_passed: bool,
}

pub(crate) fn main() -> ExitCode {
    let cli = Cli::parse();
    // Studies are parallel from case to case.
    #[cfg(feature = "umfpack")]
    let _ = process::set_blas_threads(1);
    process::keep_freed_memory();
    let answer = match &cli.study {
        Study::Tables(args) => tables::tables(args),
        Study::Figures(args) => figures::figures(args),
        Study::Elements(args) => elements::elements(args),
        Study::Extremes(args) => extremes::extremes(args),
        Study::Gaps(args) => gaps::gaps(args),
        Study::Estimates(args) => estimates::estimates(args),
        Study::Told(args) => told::told(args),
        Study::Warnings(args) => warnings::warnings(args),
    };
    match answer.and_then(|answer| print(&answer.lines).map(|()| answer.has_passed)) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(report) => {
            // Where standard error cannot be written either, the exit status has to do.
            let _ = writeln!(io::stderr(), "{report:?}");
            ExitCode::from(2)
        }
    }
}

/// A reader who has gone, as in `... | head`, is no failure.
fn print(lines: &[String]) -> miette::Result<()> {
    let mut out = io::stdout().lock();
    match lines.iter().try_for_each(|line| writeln!(out, "{line}")) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).into_diagnostic().wrap_err("standard output cannot be written")
        }
        _ => Ok(()),
    }
}

/// Writes the named texts into `folder`, which is made if need be.
fn write(folder: &Path, files: &[(String, String)]) -> miette::Result<()> {
    let mut written = fs::create_dir_all(folder);
    for (name, text) in files {
        written = written.and_then(|()| write_file(folder, name, text));
    }
    written
        .into_diagnostic()
        .wrap_err_with(|| format!("{} cannot be written; --out names the folder", folder.display()))
}
