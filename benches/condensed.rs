//! What condensation saves in a whole history: the naive caller, the whole system, the condensed one.
//!
//! `cargo bench --bench condensed [-- N ... --increments N --csv]`: the block with n × n elements, mu = 0.4, 50 + 50
//! increments unless told otherwise, BN in the setting of the paper, which the naive caller, too, can follow. `history`
//! is everything between the discretised scene and the result: set-up, factorisations, solves, residuals, error measure.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::run::{Case, Elements, is_child, measure};
use common::{Rows, option};
use stickslip::solver::history::Method;

fn main() {
    if is_child(Method::PaperBn) {
        return;
    }
    let args: Vec<String> = std::env::args().skip(1).collect();
    let increments = option(&args, "--increments").map_or(100, |n| n.parse().unwrap());
    let mut sizes: Vec<usize> =
        args.iter().take_while(|arg| *arg != "--increments").filter_map(|arg| arg.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![100];
    }
    let heads = ["n", "path", "increments", "iterations", "factored", "run s", "history s", "ms/iteration", "ratio"];
    let mut rows = Rows::new(&[&heads[..], &["backward error", "MB"]].concat());
    for n in sizes {
        let case = Case { elements: Elements::Plane([n, n]), increments };
        let runs = ["condensed", "umfpack", "naive"].map(|who| (who, measure(case, who)));
        let per_iteration = |run: &common::run::Measured| 1e3 * run.history / run.iterations as f64;
        let best = per_iteration(&runs[0].1);
        for (who, run) in runs {
            let mut row = vec![n.to_string(), who.to_string(), format!("{} of {increments}", run.converged)];
            row.extend([run.iterations, run.factorizations].map(|count| count.to_string()));
            row.extend([run.cpu, run.history].map(|seconds| format!("{seconds:.3}")));
            row.extend([per_iteration(&run), per_iteration(&run) / best].map(|value| format!("{value:.2}")));
            row.push(format!("{:.1e}", run.backward_error));
            row.push(format!("{:.0}", run.megabytes));
            rows.push(row);
        }
    }
    rows.print("CPU seconds; ratio: of the history's time per iteration to that of the condensed run", &args);
}
