//! Where the whole system is faster and where the condensed one, and what `auto` makes of it.
//!
//! `cargo bench --bench crossover [-- MESH ... --increments N,... --csv]`, where a mesh is `100` for a square of
//! 100 × 100 elements, `1000x4` for a strip, `16x16x16` for a cube and `16x16x4` for a plate. CPU of whole runs, BN in the default setting, mu = 0.4.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::run::{Case, Elements, is_child, measure};
use common::{Rows, option};
use stickslip::solver::history::Method;

const MESHES: [&str; 18] = [
    "25", "50", "100", "200", "400", "1000x4", "2000x4", "4000x4", "1000x16", "2000x16", "2000x50", "8x8x8",
    "12x12x12", "16x16x16", "24x24x24", "16x16x4", "24x24x6", "32x32x2",
];

fn main() {
    if is_child(Method::BN) {
        return;
    }
    let args: Vec<String> = std::env::args().skip(1).collect();
    let increments = option(&args, "--increments").unwrap_or("2,40".to_string());
    let increments: Vec<usize> = increments.split(',').map(|n| n.parse().unwrap()).collect();
    let given: Vec<Elements> =
        args.iter().take_while(|arg| *arg != "--increments").filter_map(|arg| arg.parse().ok()).collect();
    let all = || MESHES.iter().map(|mesh| mesh.parse().unwrap()).collect();
    let mut rows = Rows::new(&[
        "mesh",
        "unknowns",
        "increments",
        "factored",
        "umfpack s",
        "condensed s",
        "auto s",
        "auto took",
        "auto / better",
        "error umfpack",
        "condensed",
        "auto",
    ]);
    for elements in if given.is_empty() { all() } else { given } {
        for &increments in &increments {
            let case = Case { elements, increments };
            let [umfpack, condensed, auto] = ["umfpack", "condensed", "auto"].map(|who| measure(case, who));
            let mut row = vec![elements.to_string(), umfpack.unknowns.to_string()];
            row.extend([increments.to_string(), umfpack.factorizations.to_string()]);
            row.extend([umfpack, condensed, auto].map(|run| format!("{:.3}", run.cpu)));
            row.push(if auto.condensed { "condensed" } else { "umfpack" }.to_string());
            row.push(format!("{:.2}", auto.cpu / umfpack.cpu.min(condensed.cpu)));
            row.extend([umfpack, condensed, auto].map(|run| format!("{:.1e}", run.backward_error)));
            rows.push(row);
        }
    }
    rows.print("CPU seconds of whole runs; error: the largest componentwise backward error", &args);
}
