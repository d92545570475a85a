//! `stickslip-studies figures`.

use std::path::PathBuf;

use clap::Args;
use miette::IntoDiagnostic;
use stickslip_studies::figures::PaperFigure;

use super::{Answer, jobs, write};

#[derive(Args)]
pub(super) struct FiguresArgs {
    /// Write the pictures (SVG) and their numbers (CSV) into this folder
    #[arg(long, value_name = "DIR", default_value = "results/figures")]
    out: PathBuf,
    /// Only the figures with these numbers, 4 to 7
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = clap::value_parser!(u8).range(4..=7))]
    only: Vec<u8>,
}

pub(super) fn figures(args: &FiguresArgs) -> miette::Result<Answer> {
    let wanted = |figure: &PaperFigure| args.only.is_empty() || args.only.contains(&figure.number());
    let figures: Vec<PaperFigure> = PaperFigure::ALL.into_iter().filter(wanted).collect();
    // Before the work: a folder that cannot be made should not cost minutes.
    write(&args.out, &[])?;

    let bar = jobs::bar(figures.iter().map(|figure| figure.increments()).sum());
    let mut answer = Answer { lines: Vec::new(), has_passed: true };
    for figure in figures {
        let name = format!("figure{}", figure.number());
        bar.set_message(name.clone());
        let data = figure.compute(&mut || bar.inc(1))?;
        let svg = data.chart().to_svg().into_diagnostic()?;
        write(&args.out, &[(format!("{name}.csv"), data.to_csv()), (format!("{name}.svg"), svg)])?;
        answer.lines.push(args.out.join(name).with_extension("svg").display().to_string());
        answer.lines.extend(data.summary().iter().map(|line| format!("  {line}")));
        answer.has_passed &= data.converged();
    }
    bar.finish_and_clear();
    Ok(answer)
}
