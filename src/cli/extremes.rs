//! `stickslip extremes`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use stickslip::extremes::{self, Case, ExtremeError, Row, SuiteMethod};
use stickslip::linear;
use stickslip::report::{Table, csv_table, write_file};

use super::run::write_failure;
use super::{Failure, jobs};

#[derive(Args)]
pub(super) struct ExtremesArgs {
    /// Only the sweeps whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Only these methods
    #[arg(long, value_delimiter = ',')]
    methods: Vec<MethodArg>,
    /// The scenes that take minutes or gigabytes, too
    #[arg(long)]
    long: bool,
    /// Scenes computed at the same time; as many as there are processors
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Write extremes.csv and a chart of every sweep that is drawn into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print comma-separated values and nothing else
    #[arg(long)]
    csv: bool,
}

#[derive(Clone, Copy, ValueEnum)]
enum MethodArg {
    BnPaper,
    Bn,
    Ip,
}

pub(super) fn extremes(args: &ExtremesArgs) -> Result<ExitCode, Failure> {
    let methods = methods(&args.methods);
    let cases = extremes::cases().map_err(failure)?;
    let wanted =
        |case: &Case| (args.long || !case.long) && args.only.as_ref().is_none_or(|text| case.sweep.contains(text));
    let cases: Vec<Case> = cases.into_iter().filter(wanted).collect();
    if cases.is_empty() {
        let help = "data/extremes.toml names them";
        return Err(Failure::Input(miette::miette!(help = help, "there is no such sweep")));
    }
    let pairs = cases.iter().flat_map(|case| methods.iter().map(move |&method| (case, method)));
    let tasks: Vec<(&Case, SuiteMethod)> = pairs.filter(|(case, method)| case.methods.contains(method)).collect();
    linear::process::keep_freed_memory();
    let describe =
        |(case, method): &(&Case, SuiteMethod)| format!("{} = {}, {}", case.sweep, case.value, method.title());
    let rows = jobs::run(&tasks, jobs::count(args.jobs), "scenes", describe, |(case, method)| case.run(*method))
        .map_err(failure)?;
    let csv = csv_table(&HEADER, rows.iter().map(fields));
    if args.csv {
        csv.lines().for_each(|line| say!("{line}"));
    } else {
        print(&rows);
    }
    if let Some(folder) = &args.out {
        write(folder, &csv, &rows)?;
    }
    // BN's default has to be right wherever it is known what is right.
    let sound = rows.iter().all(|row| row.method != SuiteMethod::Bn || row.right() != Some(false));
    Ok(if sound { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn methods(wanted: &[MethodArg]) -> Vec<SuiteMethod> {
    let of = |arg: &MethodArg| match arg {
        MethodArg::BnPaper => SuiteMethod::BnPaper,
        MethodArg::Bn => SuiteMethod::Bn,
        MethodArg::Ip => SuiteMethod::Ip,
    };
    let wanted: Vec<SuiteMethod> = wanted.iter().map(of).collect();
    SuiteMethod::ALL.into_iter().filter(|method| wanted.is_empty() || wanted.contains(method)).collect()
}

fn failure(error: ExtremeError) -> Failure {
    match error {
        ExtremeError::Model(error) => Failure::from(error),
        ExtremeError::Linear(error) => Failure::linear(&error),
        error => Failure::Machine(miette::miette!(help = "this is not your fault; please report it", "{error}")),
    }
}

fn print(rows: &[Row]) {
    for sweep in rows.chunk_by(|a, b| a.sweep == b.sweep) {
        say!("{}", sweep[0].sweep);
        let heads = [
            "value",
            "method",
            "verdict",
            "inc",
            "iter",
            "halved",
            "by ip",
            "error",
            "rounding",
            "backward",
            "condition",
            "s",
        ];
        let mut table = Table::new(&heads);
        for row in sweep {
            let [done, all] = row.converged;
            let mark = match row.right() {
                Some(false) => " !",
                None => " ?",
                Some(true) => "",
            };
            table.push(vec![
                row.value.clone(),
                row.method.title().to_string(),
                format!("{}{mark}", row.verdict),
                format!("{done}/{all}"),
                format!("{:.1}", row.iterations),
                row.halved.to_string(),
                row.rescued.to_string(),
                format!("{:.0e}", row.errors.worst().1),
                format!("{:.0e}", row.rounding),
                format!("{:.0e}", row.backward_error),
                format!("{:.0e}", row.condition),
                format!("{:.2}", row.seconds),
            ]);
        }
        say!("{table}");
    }
    for method in SuiteMethod::ALL {
        let of = |right| rows.iter().filter(|row| row.method == method && row.right() == right).count();
        if of(Some(true)) + of(Some(false)) + of(None) > 0 {
            let (right, wrong) = (of(Some(true)), of(Some(false)));
            say!(
                "{:<9} {right} of {} scenes as they should be; {} more of which nobody knows",
                method.title(),
                right + wrong,
                of(None)
            );
        }
    }
    say!("! not what it should be   ? nobody knows");
}

const HEADER: [&str; 21] = [
    "sweep",
    "value",
    "method",
    "expect",
    "verdict",
    "right",
    "converged",
    "increments",
    "iterations",
    "halved",
    "rescued",
    "equilibrium",
    "penetration",
    "tension",
    "complementarity",
    "cone",
    "dissipation",
    "rounding",
    "backward_error",
    "condition",
    "seconds",
];

fn fields(row: &Row) -> Vec<String> {
    let plain = |text: &str| text.replace(',', ";");
    let expect = serde_json::to_string(&row.expect).unwrap_or_default().replace('"', "");
    let right = row.right().map_or("unknown".to_string(), |right| right.to_string());
    let mut fields = vec![plain(&row.sweep), plain(&row.value), row.method.title().to_string(), expect];
    fields.extend([row.verdict.to_string(), right]);
    fields.extend(row.converged.map(|count| count.to_string()));
    fields.extend([format!("{:.3}", row.iterations), row.halved.to_string(), row.rescued.to_string()]);
    fields.extend(row.errors.components().map(|(_, error)| format!("{error:.3e}")));
    fields.extend([row.rounding, row.backward_error, row.condition].map(|number| format!("{number:.2e}")));
    fields.push(format!("{:.3}", row.seconds));
    fields
}

fn write(folder: &Path, csv: &str, rows: &[Row]) -> Result<(), Failure> {
    let written = |result: std::io::Result<()>| result.map_err(|error| write_failure(folder, &error));
    written(fs::create_dir_all(folder))?;
    written(write_file(folder, "extremes.csv", csv))?;
    for (stem, chart) in extremes::charts(rows) {
        let svg = chart.to_svg().map_err(|error| Failure::Machine(miette::miette!("{error}")))?;
        written(write_file(folder, &format!("{stem}.svg"), &svg))?;
    }
    say!("written to   {}", folder.display());
    Ok(())
}
