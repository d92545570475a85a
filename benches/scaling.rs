//! How time, fill, operations and memory grow with the mesh, on the whole system and on the condensed one.
//!
//! `cargo bench --bench scaling [-- N ... --increments N --csv]`: the block with n × n elements, BN in the default
//! setting, mu = 0.4, CPU. The exponents are least-squares fits of log against log n. Nested dissection of a plane
//! grid takes O(n³) operations and O(n² log n) entries, an exponent of about 2.3 in this range.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::run::{Case, Measured, is_child, measure};
use common::{Rows, option};
use stickslip::history::HistorySettings;

const PATHS: [&str; 3] = ["umfpack", "faer", "condensed"];

/// What grows, and how it is written.
type Column = (&'static str, fn(&Measured) -> f64, fn(f64) -> String);

const COLUMNS: [Column; 6] = [
    ("CPU s", |run| run.cpu, |value| format!("{value:.3}")),
    ("history s", |run| run.history, |value| format!("{value:.3}")),
    ("ms/iteration", |run| 1e3 * run.history / run.iterations, |value| format!("{value:.2}")),
    ("entries", |run| run.entries, |value| format!("{value:.2e}")),
    ("flops", |run| run.flops, |value| if value == 0.0 { "-".to_string() } else { format!("{value:.2e}") }),
    ("MB", |run| run.megabytes, |value| format!("{value:.0}")),
];

fn main() {
    if is_child(HistorySettings::bn) {
        return;
    }
    let args: Vec<String> = std::env::args().skip(1).collect();
    let increments = option(&args, "--increments").map_or(4, |n| n.parse().unwrap());
    let mut sizes: Vec<usize> =
        args.iter().take_while(|arg| *arg != "--increments").filter_map(|arg| arg.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![25, 50, 100, 200, 400];
    }
    let heads = ["path", "n", "iterations", "factored"].into_iter().chain(COLUMNS.map(|(head, ..)| head));
    let mut rows = Rows::new(&heads.chain(["backward error"]).collect::<Vec<_>>());
    for path in PATHS {
        let runs: Vec<Measured> = sizes.iter().map(|&n| measure(Case { elements: [n, n], increments }, path)).collect();
        for (n, run) in sizes.iter().zip(&runs) {
            let mut row = vec![path.to_string(), n.to_string()];
            row.extend([run.iterations, run.factorizations].map(|count| count.to_string()));
            row.extend(COLUMNS.map(|(_, value, write)| write(value(run))));
            row.push(format!("{:.1e}", run.backward_error));
            rows.push(row);
        }
        let fitted = COLUMNS.map(|(_, value, _)| exponent(&sizes, &runs.iter().map(value).collect::<Vec<_>>()));
        let mut row = vec![path.to_string(), "exponent".to_string(), "-".to_string(), "-".to_string()];
        row.extend(fitted.map(|slope| slope.map_or("-".to_string(), |slope| format!("{slope:.2}"))));
        row.push("-".to_string());
        rows.push(row);
    }
    rows.print("CPU, process by process; flops: of the last factorisation; theory: entries 2.3, flops 3.0", &args);
}

/// The least-squares slope of log `values` over log `sizes`.
fn exponent(sizes: &[usize], values: &[f64]) -> Option<f64> {
    if sizes.len() < 2 || values.iter().any(|&value| value <= 0.0) {
        return None;
    }
    let points: Vec<(f64, f64)> = sizes.iter().zip(values).map(|(&n, value)| ((n as f64).ln(), value.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    let covariance: f64 = points.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    Some(covariance / points.iter().map(|point| (point.0 - x).powi(2)).sum::<f64>())
}
