//! `stickslip figures`.

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Args;
use stickslip::figures::PaperFigure;
use stickslip::linear;
use stickslip::report::write_file;
use stickslip::tables::PaperError;

use super::Failure;
use super::progress::bar;
use super::run::write_failure;

#[derive(Args)]
pub(super) struct FiguresArgs {
    /// Write the pictures (SVG) and their numbers (CSV) into this folder
    #[arg(long, value_name = "DIR", default_value = "results/figures")]
    out: PathBuf,
    /// Only the figures with these numbers, 4 to 7
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = clap::value_parser!(u8).range(4..=7))]
    only: Vec<u8>,
}

pub(super) fn figures(args: &FiguresArgs) -> Result<ExitCode, Failure> {
    let wanted = |figure: &PaperFigure| args.only.is_empty() || args.only.contains(&figure.number());
    let figures: Vec<PaperFigure> = PaperFigure::ALL.into_iter().filter(wanted).collect();
    fs::create_dir_all(&args.out).map_err(|error| write_failure(&args.out, &error))?;
    linear::process::keep_freed_memory();

    let bar = bar(figures.iter().map(|figure| figure.increments()).sum(), "increments");
    let mut converged = true;
    for figure in figures {
        let name = format!("figure{}", figure.number());
        bar.set_message(name.clone());
        let data = figure.compute(&mut || bar.inc(1)).map_err(|error| match error {
            PaperError::Model(error) => Failure::from(error),
            PaperError::Linear(error) => Failure::linear(&error),
        })?;
        let svg = data.chart().to_svg().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        for (file, text) in [(format!("{name}.csv"), data.to_csv()), (format!("{name}.svg"), svg)] {
            write_file(&args.out, &file, &text).map_err(|error| write_failure(&args.out, &error))?;
        }
        bar.suspend(|| {
            say!("{}", args.out.join(name).with_extension("svg").display());
            data.summary().iter().for_each(|line| say!("  {line}"));
        });
        converged &= data.converged();
    }
    bar.finish_and_clear();
    Ok(if converged { ExitCode::SUCCESS } else { ExitCode::from(1) })
}
