//! `stickslip-studies estimates`.

use std::collections::BTreeMap;

use clap::Args;
use miette::IntoDiagnostic;
use stickslip::body::mesh::CellKind;
use stickslip::run::report::csv_table;
use stickslip_output::Table;
use stickslip_studies::estimates::{Row, Subject, Task, cantilevers, increments, lines, pressed, spheres};

use super::{Answer, jobs};

#[derive(Args)]
pub(super) struct EstimatesArgs {
    /// Only the states whose name contains this, such as line, sphere, pressed, cantilever, increments or wandering
    #[arg(long, value_name = "TEXT")]
    only: Option<String>,
    /// States computed at the same time; as many as there are processors
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: Option<u16>,
    /// Print comma-separated values and nothing else
    #[arg(long)]
    csv: bool,
}

const PLANE: [CellKind; 2] = [CellKind::Quadrilateral, CellKind::Triangle];
const SPACE: [CellKind; 2] = [CellKind::Hexahedron, CellKind::Tetrahedron];
const RATIOS: [f64; 8] = [0.3, 0.4, 0.45, 0.48, 0.49, 0.495, 0.499, 0.4999];

/// A smaller error is none.
const ROUNDING: f64 = 1e-9;

fn all() -> Vec<Task> {
    let approaches: Vec<f64> = (0..10).map(|k| 1e-6 * 1.55_f64.powi(k)).collect();
    let second = [CellKind::Triangle6, CellKind::Tetrahedron10];
    let some = [0.3, 0.45, 0.49, 0.499];
    [
        lines(&PLANE, &[4, 6, 9, 13, 18], &approaches),
        lines(&second[..1], &[4, 6, 10, 14, 18], &approaches),
        spheres(&SPACE, &[3, 5, 8], &[4e-6, 7e-6, 12e-6, 18e-6, 24e-6]),
        pressed(&PLANE, &RATIOS, &[4, 8, 16, 32], 128),
        pressed(&SPACE, &RATIOS, &[3, 4, 6, 8], 16),
        cantilevers(&PLANE, &some, &[2, 4, 8], 32),
        cantilevers(&SPACE, &some, &[2, 4], 8),
        pressed(&second[..1], &RATIOS, &[1, 2, 4, 8], 128),
        pressed(&second[1..], &RATIOS, &[1, 2, 4], 16),
        increments(&[1, 2, 4, 8, 16, 32, 64], 512),
    ]
    .into_iter()
    .flatten()
    .collect()
}

pub(super) fn estimates(args: &EstimatesArgs) -> miette::Result<Answer> {
    let mut tasks = all();
    tasks.retain(|task| args.only.as_ref().is_none_or(|text| task.name.contains(text)));
    if tasks.is_empty() {
        return Err(miette::miette!(
            "there are no such states: name lines, spheres, blocks that are pressed, cantilevers, increments or wandering loads"
        ));
    }
    let rows = jobs::run(&tasks, jobs::count(args.jobs), |task| task.name.clone(), Task::rows).into_diagnostic()?;
    let rows: Vec<Row> = rows.into_iter().flatten().collect();
    let lines = if args.csv {
        csv_table(&HEADER, rows.iter().map(fields)).lines().map(str::to_string).collect()
    } else {
        words(&rows)
    };
    Ok(Answer { lines, has_passed: true })
}

const HEADER: [&str; 6] = ["subject", "cells", "poisson", "across", "error", "estimate"];

fn fields(row: &Row) -> Vec<String> {
    let numbers = [row.poisson, row.across as f64, row.error, row.estimate].map(|x| format!("{x}"));
    [row.subject.to_string(), row.kind.name().to_string()].into_iter().chain(numbers).collect()
}

/// The rows of each subject and kind of cell.
fn groups(rows: &[Row]) -> Vec<(Subject, CellKind, Vec<&Row>)> {
    let mut groups: Vec<(Subject, CellKind, Vec<&Row>)> = Vec::new();
    for row in rows {
        match groups.iter_mut().find(|(subject, kind, _)| (*subject, *kind) == (row.subject, row.kind)) {
            Some((.., of)) => of.push(row),
            None => groups.push((row.subject, row.kind, vec![row])),
        }
    }
    groups
}

/// What a person reads.
fn words(rows: &[Row]) -> Vec<String> {
    let mut lines = Vec::new();
    for (subject, kind, of) in groups(rows) {
        lines.push(format!("{subject}, {}", kind.name()));
        let tables = match subject {
            Subject::Line | Subject::Sphere => peaks(&of),
            Subject::Work => by_increments(&of, 0.1),
            Subject::Friction => by_increments(&of, 0.05),
            // Cells of second order have no such estimate.
            _ if kind.is_quadratic() => stiffnesses(&of),
            Subject::Pressed | Subject::Cantilever => [stiffnesses(&of), verdicts(&of, 0.05, 0.02)].concat(),
        };
        lines.extend(tables);
    }
    lines
}

/// Errors of peaks by the nodes across.
fn peaks(rows: &[&Row]) -> Vec<String> {
    let mut by_width: BTreeMap<usize, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_width.entry(row.across).or_default().push(row);
    }
    let mut table = Table::new(&["across", "states", "error from, %", "to, %", "estimate, %"]);
    for (across, of) in by_width {
        let errors = || of.iter().map(|row| 100.0 * row.error);
        let least = of.iter().map(|row| 100.0 * row.estimate).fold(f64::INFINITY, f64::min);
        let [from, to] = [errors().fold(f64::INFINITY, f64::min), errors().fold(f64::NEG_INFINITY, f64::max)];
        let numbers = [from, to, least].map(|x| format!("{x:.1}"));
        table.push([across.to_string(), of.len().to_string()].into_iter().chain(numbers).collect());
    }
    let mut factors: Vec<f64> =
        rows.iter().filter(|row| row.across >= 2).map(|row| row.estimate / row.error.abs()).collect();
    factors.sort_by(f64::total_cmp);
    let summary = match factors[..] {
        [] => "no zone is two nodes wide".to_string(),
        [least, ..] => format!(
            "estimate over error in {} states of two nodes and more: least {least:.2}, median {:.1}, below 1 in {}",
            factors.len(),
            factors[factors.len() / 2],
            factors.iter().filter(|factor| **factor < 1.0).count()
        ),
    };
    vec![table.to_string(), summary]
}

/// Errors and estimates of stiffnesses, with the elements across and Poisson's ratio.
fn stiffnesses(rows: &[&Row]) -> Vec<String> {
    let mut ratios: Vec<f64> = rows.iter().map(|row| row.poisson).collect();
    ratios.sort_by(f64::total_cmp);
    ratios.dedup();
    let mut sizes: Vec<usize> = rows.iter().map(|row| row.across).collect();
    sizes.sort_unstable();
    sizes.dedup();
    let heads: Vec<String> =
        std::iter::once("across".to_string()).chain(ratios.iter().map(|nu| format!("{nu}"))).collect();
    let mut table = Table::new(&heads.iter().map(String::as_str).collect::<Vec<_>>());
    for size in sizes {
        let cell = |nu: &f64| {
            let row = rows.iter().find(|row| row.across == size && row.poisson == *nu);
            row.map_or(String::new(), |row| format!("{:.1} [{:.1}]", 100.0 * row.error, 100.0 * row.estimate))
        };
        table.push(std::iter::once(size.to_string()).chain(ratios.iter().map(cell)).collect());
    }
    vec![format!("too stiff by [estimate], %\n{table}")]
}

/// How near estimates are to errors from 1 % on, and what is warned of when an error is above the `limit`, by the increments a stretch and in all.
fn by_increments(rows: &[&Row], limit: f64) -> Vec<String> {
    let mut by_count: BTreeMap<usize, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        by_count.entry(row.across).or_default().push(row);
    }
    let heads =
        ["increments", "states", "from 1 % on", "within 2", "within 3", "median", "hits", "missed", "false", "quiet"];
    let mut table = Table::new(&heads);
    let all = std::iter::once(("all".to_string(), rows));
    for (name, of) in by_count.iter().map(|(count, of)| (count.to_string(), &of[..])).chain(all) {
        let factors = factors(of.iter().copied(), 0.01, f64::INFINITY);
        let counts = [of.len(), factors.len(), within(&factors, 2.0), within(&factors, 3.0)].map(|n| n.to_string());
        let median = factors.get(factors.len() / 2).map_or(String::new(), |factor| format!("{factor:.2}"));
        let counts_of_warnings = warned(of, limit).map(|n| n.to_string());
        table.push([name].into_iter().chain(counts).chain([median]).chain(counts_of_warnings).collect());
    }
    let exact: Vec<&Row> = rows.iter().copied().filter(|row| row.error.abs() < ROUNDING).collect();
    let [.., wrong, quiet] = warned(&exact, limit);
    vec![
        format!("warned of from {:.0} % on\n{table}", 100.0 * limit),
        format!("of states without an error {wrong} are warned of, {quiet} are not"),
    ]
}

/// Estimates over the errors from `least` up to `most`, ascending.
fn factors<'a>(rows: impl Iterator<Item = &'a Row>, least: f64, most: f64) -> Vec<f64> {
    let mut factors: Vec<f64> =
        rows.filter(|row| (least..most).contains(&row.error.abs())).map(|row| row.estimate / row.error).collect();
    factors.sort_by(f64::total_cmp);
    factors
}

/// How many of these are between `1 / most` and `most`.
fn within(factors: &[f64], most: f64) -> usize {
    factors.iter().filter(|factor| (1.0 / most..=most).contains(*factor)).count()
}

/// Hits, missed, false and quiet where errors above the `limit` are to be warned of.
fn warned(rows: &[&Row], limit: f64) -> [usize; 4] {
    let is = |row: &Row| [row.error.abs() > limit, row.warned.unwrap_or(row.estimate.abs() > limit)];
    [[true, true], [true, false], [false, true], [false, false]]
        .map(|wanted| rows.iter().filter(|row| is(row) == wanted).count())
}

/// The rule that warns from `limit` on, and how near estimates are to errors between `least` and 300 %.
fn verdicts(rows: &[&Row], limit: f64, least: f64) -> Vec<String> {
    let factors = factors(rows.iter().copied(), least, 3.0);
    let [hits, missed, wrong, quiet] = warned(rows, limit);
    vec![format!(
        "more than {:.0} %: {hits} hits, {missed} missed, {wrong} false, {quiet} quiet; within 2 in {} of {all}, within 3 in {} of {all}",
        100.0 * limit,
        within(&factors, 2.0),
        within(&factors, 3.0),
        all = factors.len()
    )]
}
