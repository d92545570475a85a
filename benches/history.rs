//! A whole load history: where the time of an increment goes, and CPU per iteration against the
//! naive caller.
//!
//! `cargo bench --bench history [-- N ...]`. Block, mu = 0.4, 20 + 20 increments, no files written.
//! The naive caller runs the same Newton iterations; it, too, keeps its factors while no contact
//! status changes, and its solutions are refined as ours are, on top of UMFPACK's own refinement.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::{Naive, Who, block, compare};
use stickslip::algebra::linear::{self, LinearSolver, Umfpack};
use stickslip::base::Scaling;
use stickslip::run::report::cpu_seconds;
use stickslip::solver::history::{self, HistorySettings, Method, Observer, Status, SystemSolver};
use stickslip_output::Table;

fn main() {
    let mut table = Table::new(&[
        "n",
        "iterations",
        "factored",
        "ms/increment",
        "assembly %",
        "factor %",
        "solve %",
        "rest %",
        "CPU ms/iteration",
        "naive",
        "ratio",
        "naive got to",
    ]);
    compare(&[25, 50, 100, 200], measure, |n, ours, naive| {
        let [iterations, factored, seconds, assembly, factor, solve, rest, cpu, _] = ours;
        let mut row =
            vec![n.to_string(), iterations.to_string(), factored.to_string(), format!("{:.2}", 1e3 * seconds)];
        row.extend([assembly, factor, solve, rest].map(|share| format!("{:.1}", 100.0 * share)));
        row.push(format!("{:.2}", 1e3 * cpu));
        row.push(format!("{:.2}", 1e3 * naive[7]));
        row.push(format!("{:.2}", cpu / naive[7]));
        row.push(format!("{} of 40", naive[8]));
        table.push(row);
    });
    if table.is_empty() {
        return;
    }
    println!(
        "\nblock, mu = 0.4, 20 + 20 increments; CPU: mesh, assembly and analysis included; {}\n\n{table}",
        common::blas()
    );
}

/// Keeps freed memory once the factors have their size, as the command line does.
struct KeepMemory(bool);

impl Observer for KeepMemory {
    fn ready(&mut self) {
        if self.0 {
            linear::process::keep_freed_memory();
        }
    }
}

/// Iterations, factorisations, seconds per increment, shares of assembly, factorisation, solve and
/// rest, CPU seconds per iteration, converged increments.
fn measure(n: usize, who: Who) -> [f64; 9] {
    let start = cpu_seconds();
    let (scene, model) = block(n, 40);
    // In newtons and metres the tolerance of the scene is out of reach at fine meshes: what the
    // naive caller reaches is taken, the comparison is of time.
    let (scaling, backend, tolerance): (_, Box<dyn LinearSolver>, _) = match who {
        Who::Ours => (model.scaling(), Box::new(Umfpack::default()), scene.solver.tolerance),
        Who::Naive => (Scaling::SI, Box::new(Naive::default()), 1e-3),
    };
    let settings = HistorySettings::new(&model.problem, &model.loading, Method::PaperBn).unwrap();
    let settings = HistorySettings { scaling, ..settings.until(scene.solver.max_iterations, tolerance) };
    let system = SystemSolver::from(backend);
    let times = scene.time.all();
    let mut observer = KeepMemory(who == Who::Ours);
    let outcome = history::run(&model.problem, &model.loading, &times, &settings, system, &mut observer).unwrap();
    let cpu = cpu_seconds() - start;
    // The naive caller may give up on the way: its time per iteration counts all the same.
    assert!(who == Who::Naive || outcome.status == Status::Converged, "{:?}", outcome.status);

    let iterations = outcome.records.iter().map(|record| record.iterations).sum::<usize>() as f64;
    let sum = |part: fn(&history::Seconds) -> f64| outcome.records.iter().map(|r| part(&r.seconds)).sum::<f64>();
    let parts = [sum(|s| s.assembly), sum(|s| s.factorization), sum(|s| s.solve), sum(|s| s.rest)];
    let total: f64 = parts.iter().sum();
    let [assembly, factor, solve, rest] = parts.map(|part| part / total);
    let factored = outcome.linear.factorizations as f64;
    let done = outcome.records.iter().filter(|record| record.status == Status::Converged).count() as f64;
    [iterations, factored, total / times.len() as f64, assembly, factor, solve, rest, cpu / iterations, done]
}
