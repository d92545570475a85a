//! `stickslip-studies extremes`.

use std::path::PathBuf;

use clap::Args;
use miette::IntoDiagnostic;
use stickslip::run::report::csv_table;
use stickslip::solver::history::LinearAlgebra;
use stickslip_output::Table;
use stickslip_studies::extremes::{self, Case, Row, SuiteMethod};

use super::{Answer, jobs, write};

#[derive(Args)]
pub(super) struct ExtremesArgs {
    /// Only the sweeps whose name contains this
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// Only these methods
    #[arg(long, value_delimiter = ',')]
    methods: Vec<SuiteMethod>,
    /// The linear solver
    #[arg(long, value_name = "NAME", default_value_t)]
    solver: LinearAlgebra,
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

pub(super) fn extremes(args: &ExtremesArgs) -> miette::Result<Answer> {
    let wanted =
        |case: &Case| (args.long || !case.long) && args.only.as_ref().is_none_or(|text| case.sweep.contains(text));
    let cases: Vec<Case> = extremes::cases()?.into_iter().filter(wanted).collect();
    if cases.is_empty() {
        let help = "studies/data/extremes.toml names them; some take --long";
        return Err(miette::miette!(help = help, "there is no such sweep"));
    }
    let methods: Vec<SuiteMethod> =
        if args.methods.is_empty() { SuiteMethod::ALL.into() } else { args.methods.clone() };
    let pairs = cases.iter().flat_map(|case| methods.iter().map(move |&method| (case, method)));
    let tasks: Vec<(&Case, SuiteMethod)> = pairs.filter(|(case, method)| case.methods.contains(method)).collect();
    let describe =
        |(case, method): &(&Case, SuiteMethod)| format!("{} = {}, {}", case.sweep, case.value, method.title());
    let rows = jobs::run(&tasks, jobs::count(args.jobs), describe, |(case, method)| case.run(*method, args.solver))?;
    let csv = csv_table(&HEADER, rows.iter().map(fields));
    let mut lines = if args.csv { csv.lines().map(str::to_string).collect() } else { words(&rows) };
    if let Some(folder) = &args.out {
        let mut files = vec![("extremes.csv".to_string(), csv)];
        for (stem, chart) in extremes::charts(&rows) {
            files.push((format!("{stem}.svg"), chart.to_svg().into_diagnostic()?));
        }
        write(folder, &files)?;
        if !args.csv {
            lines.push(format!("written to   {}", folder.display()));
        }
    }
    // BN's default has to be right wherever it is known what is right.
    let has_passed = rows.iter().all(|row| row.method != SuiteMethod::Bn || row.right() != Some(false));
    Ok(Answer { lines, has_passed })
}

/// What a person reads.
fn words(rows: &[Row]) -> Vec<String> {
    let mut lines = Vec::new();
    for sweep in rows.chunk_by(|a, b| a.sweep == b.sweep) {
        lines.push(sweep[0].sweep.clone());
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
        lines.push(table.to_string());
    }
    for method in SuiteMethod::ALL {
        let of = |right| rows.iter().filter(|row| row.method == method && row.right() == right).count();
        if of(Some(true)) + of(Some(false)) + of(None) > 0 {
            let (right, wrong) = (of(Some(true)), of(Some(false)));
            lines.push(format!(
                "{:<9} right verdict in {right} of {} scenes; unknown in {} more",
                method.title(),
                right + wrong,
                of(None)
            ));
        }
    }
    lines.push("! wrong verdict   ? right verdict unknown".into());
    lines
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
