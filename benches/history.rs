//! A whole load history: where the time of an increment goes, and CPU per iteration against the
//! naive caller.
//!
//! `cargo bench --bench history [-- N ...]`. Block, mu = 0.4, 20 + 20 increments, no files written.
//! The naive caller runs the same Newton iterations up to n = 100; it, too, keeps its factors while
//! no contact status changes.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{Naive, block, sizes};
use stickslip::history::{self, HistoryOutcome, HistorySettings};
use stickslip::linear::{self, Direct, LinearSolver, Umfpack};
use stickslip::report::{Table, cpu_seconds};
use stickslip::units::Scaling;

/// Above this the naive caller takes minutes.
const NAIVE_UP_TO: usize = 100;

fn main() {
    linear::process::set_blas_threads(1);
    let mut table = Table::new(&[
        "n",
        "iterations",
        "factored",
        "ms/increment",
        "assembly %",
        "factor %",
        "solve %",
        "rest %",
        "all but f+s %",
        "CPU ms/iteration",
        "naive",
        "ratio",
    ]);
    for n in sizes(&[25, 50, 100, 200]) {
        let (outcome, cpu) = run(n, None, Box::new(Umfpack::default()));
        let naive = (n <= NAIVE_UP_TO).then(|| run(n, Some(Scaling::SI), Box::new(Naive::default())));
        let sum =
            |part: &dyn Fn(&history::Seconds) -> f64| outcome.records.iter().map(|r| part(&r.seconds)).sum::<f64>();
        let parts = [sum(&|s| s.assembly), sum(&|s| s.factorization), sum(&|s| s.solve), sum(&|s| s.rest)];
        let total: f64 = parts.iter().sum();
        let iterations = iterations(&outcome);
        let per_iteration = 1e3 * cpu / iterations as f64;
        let mut row = vec![
            n.to_string(),
            iterations.to_string(),
            outcome.linear.factorizations.to_string(),
            format!("{:.2}", 1e3 * total / outcome.records.len() as f64),
        ];
        row.extend(parts.map(|part| format!("{:.1}", 100.0 * part / total)));
        row.push(format!("{:.1}", 100.0 * (parts[0] + parts[3]) / total));
        row.push(format!("{per_iteration:.2}"));
        if let Some((outcome, cpu)) = naive {
            let naive = 1e3 * cpu / self::iterations(&outcome) as f64;
            row.extend([format!("{naive:.2}"), format!("{:.2}", per_iteration / naive)]);
        } else {
            row.extend(["".into(), "".into()]);
        }
        table.push(row);
    }
    println!("\nblock, mu = 0.4, 20 + 20 increments, one BLAS thread\n\n{table}");
}

fn iterations(outcome: &HistoryOutcome) -> usize {
    outcome.records.iter().map(|record| record.iterations).sum()
}

/// Runs the history from the scene on; returns the CPU time of everything.
fn run(n: usize, scaling: Option<Scaling>, backend: Box<dyn LinearSolver>) -> (HistoryOutcome, f64) {
    let start = cpu_seconds();
    let (scene, model) = block(n, 40);
    let scaling = scaling.unwrap_or_else(|| model.scaling());
    // The naive caller in newtons and metres does not reach the tolerance: what it reaches is
    // taken, the comparison is of time.
    let tolerance = if scaling == Scaling::SI { 1e-3 } else { scene.solver.tolerance };
    let settings = HistorySettings::paper(&model.problem, scaling, scene.solver.max_iterations, tolerance);
    let mut linear = Direct::new(backend);
    let outcome =
        history::run(&model.problem, &model.loading, &scene.time.all(), &settings, &mut linear, &mut ()).unwrap();
    (outcome, cpu_seconds() - start)
}
