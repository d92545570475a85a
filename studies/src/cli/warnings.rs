//! `stickslip-studies warnings`.

use clap::Args;
use miette::IntoDiagnostic;
use stickslip::run::report::csv_table;
use stickslip_output::Table;
use stickslip_studies::warnings::{Case, Judged, RIGHT, WRONG, by_kind};

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

const QUANTITIES: [&str; 3] = ["peak", "force", "work"];

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
    Ok(Answer { lines, has_passed: true })
}

fn row(judged: &Judged) -> Vec<String> {
    let Judged { case, status, errors, kinds } = judged;
    let kinds: Vec<&str> = kinds.iter().map(|kind| kind.name).collect();
    let errors = errors.map(|error| error.map_or(String::new(), |error| format!("{:.1} %", 100.0 * error)));
    let silent: Vec<&str> =
        QUANTITIES.into_iter().zip(judged.silent()).filter_map(|(name, silent)| silent.then_some(name)).collect();
    let head = [case.seed.to_string(), format!("{:?}", case.kind), case.cells.to_string(), status.clone()];
    head.into_iter().chain(errors).chain([kinds.join(" "), silent.join(" ")]).collect()
}

fn kinds(judged: &[Judged]) -> Table {
    let mut table = Table::new(&["warning", "scenes", "what it speaks of is wrong", "is right"]);
    for (kind, counts) in by_kind(judged) {
        table.push(std::iter::once(kind.to_string()).chain(counts.map(|count| count.to_string())).collect());
    }
    table
}

fn summary(judged: &[Judged]) -> String {
    let known: Vec<&Judged> = judged.iter().filter(|case| case.worst().is_some()).collect();
    let count = |is: fn(&Judged) -> bool| known.iter().filter(|case| is(case)).count();
    let wrong = count(|case| case.worst().is_some_and(|worst| worst > WRONG));
    let silent = count(|case| case.silent().contains(&true));
    let warnings = known.iter().flat_map(|case| case.kinds.iter().map(|kind| case.is_false(*kind)));
    let (all, false_alarms) = warnings.fold((0, 0), |(all, some), is_false| (all + 1, some + usize::from(is_false)));
    format!(
        "{} of {} scenes converged and can be judged. A quantity is more than {:.0} % wrong in {wrong}; in {silent} of these no \
         warning speaks of it. Of {all} warnings {false_alarms} are false: all that they speak of is right to {:.0} %.",
        known.len(),
        judged.len(),
        100.0 * WRONG,
        100.0 * RIGHT
    )
}
