//! `stickslip-studies warnings`.

use clap::Args;
use miette::IntoDiagnostic;
use stickslip::report::{Table, csv_table};
use stickslip_studies::warnings::{Case, Judged, RIGHT, WRONG, by_kind, name};

use super::{Answer, jobs};

#[derive(Args)]
pub(super) struct WarningsArgs {
    /// The first seed
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// How many scenes
    #[arg(long, default_value_t = 200)]
    count: u64,
    /// Scenes computed at the same time; as many as there are processors
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Print comma-separated values and nothing else
    #[arg(long)]
    csv: bool,
}

const HEADER: [&str; 9] =
    ["seed", "contact", "cells", "verdict", "peak error", "force error", "work error", "warnings", "silent"];

pub(super) fn warnings(args: &WarningsArgs) -> miette::Result<Answer> {
    let cases: Vec<Case> = (args.seed..args.seed.saturating_add(args.count)).map(Case::new).collect();
    let describe = |case: &Case| format!("seed {}", case.seed);
    let judged = jobs::run(&cases, jobs::count(args.jobs), describe, Case::judge).into_diagnostic()?;
    let rows = judged.iter().map(row);
    let lines = if args.csv {
        csv_table(&HEADER, rows).lines().map(str::to_string).collect()
    } else {
        let mut table = Table::new(&HEADER);
        rows.for_each(|row| table.push(row));
        vec![table.to_string(), kinds(&judged).to_string(), summary(&judged)]
    };
    Ok(Answer { lines, sound: true })
}

fn row(judged: &Judged) -> Vec<String> {
    let Judged { case, status, errors, kinds } = judged;
    let kinds: Vec<String> = kinds.iter().map(|kind| name(*kind)).collect();
    let errors = errors.map(|error| error.map_or(String::new(), |error| format!("{:.1} %", 100.0 * error)));
    let silent = if judged.is_silent() { "silent" } else { "" };
    let head = [case.seed.to_string(), format!("{:?}", case.kind), case.cells.to_string(), status.clone()];
    head.into_iter().chain(errors).chain([kinds.join(" "), silent.to_string()]).collect()
}

fn kinds(judged: &[Judged]) -> Table {
    let mut table = Table::new(&["warning", "scenes", "a quantity is wrong", "all are right"]);
    for (kind, counts) in by_kind(judged) {
        table.push(std::iter::once(kind).chain(counts.map(|count| count.to_string())).collect());
    }
    table
}

fn summary(judged: &[Judged]) -> String {
    let known: Vec<&Judged> = judged.iter().filter(|case| case.worst().is_some()).collect();
    let count = |is: fn(&Judged) -> bool| known.iter().filter(|case| is(case)).count();
    let wrong = count(|case| case.worst().is_some_and(|worst| worst > WRONG));
    let silent = count(Judged::is_silent);
    let warned = count(|case| !case.kinds.is_empty());
    let false_alarms = count(|case| !case.kinds.is_empty() && case.worst().is_some_and(|worst| worst < RIGHT));
    format!(
        "{} of {} scenes converged and can be judged. A quantity is more than {:.0} % wrong in {wrong}; {silent} of these have no warning. \
         {warned} scenes have a warning; in {false_alarms} of these every quantity is right to {:.0} %.",
        known.len(),
        judged.len(),
        100.0 * WRONG,
        100.0 * RIGHT
    )
}
