//! One iteration's linear algebra: UMFPACK as used here against a naive caller.
//!
//! `cargo bench --bench factor [-- N ...]`. The Jacobian of the block with a third of the contact
//! nodes each open, sticking and slipping, the borders moving from one iteration to the next. Ours:
//! scaled unknowns, union pattern, symmetric strategy, one symbolic analysis (not in the time, it is
//! made once a run), refinement until the backward error is at rounding. Naive: see `Who`; making
//! the pruned matrix is not in its time, the symbolic analysis is.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use std::time::Instant;

use common::{Who, block, compare, prune};
use stickslip::formulation::{Bdiff, Conventions};
use stickslip::linear::{self, Direct, LinearSolver, Strategy, Umfpack, backward_error};
use stickslip::model::Model;
use stickslip::problem::{Increment, State};
use stickslip::report::{Table, peak_rss_bytes};
use stickslip::sparse::Csc;
use stickslip::units::Scaling;

const ITERATIONS: usize = 5;

fn main() {
    let mut table = Table::new(&[
        "n",
        "ours s",
        "naive s",
        "ratio",
        "ours error",
        "naive error",
        "ours L+U",
        "naive",
        "ours Gflop",
        "naive",
        "ours MB",
        "naive",
        "process MB",
        "naive",
    ]);
    compare(&[50, 100, 200, 400], measure, |n, ours, naive| {
        let [seconds, error, entries, gflop, megabytes, process] = ours;
        let mut row = vec![n.to_string(), format!("{seconds:.4}"), format!("{:.4}", naive[0])];
        row.push(format!("{:.2}", naive[0] / seconds));
        row.extend([error, naive[1]].map(|error| format!("{error:.1e}")));
        row.extend([entries, naive[2]].map(|entries| format!("{entries:.2e}")));
        row.extend([gflop, naive[3]].map(|gflop| format!("{gflop:.2}")));
        row.extend([megabytes, naive[4], process, naive[5]].map(|megabytes| format!("{megabytes:.0}")));
        table.push(row);
    });
    if table.is_empty() {
        return;
    }
    println!("\nfactor and solve, median of {ITERATIONS} iterations; error: componentwise backward error");
    println!(
        "MB: UMFPACK's peak; process MB: peak resident memory, mesh and matrices included; {}\n\n{table}",
        common::blas()
    );
}

/// Median seconds, worst backward error, entries of L + U, Gflop, UMFPACK's peak memory and the
/// process's, MB.
fn measure(n: usize, who: Who) -> [f64; 6] {
    let (_, model) = block(n, 2);
    let problem = &model.problem;
    let scaling = if who == Who::Ours { model.scaling() } else { Scaling::SI };
    let mut formulation = Bdiff::new(problem, scaling, &Conventions::paper(problem.weight().unwrap()));
    let force = model.loading.force_at(1.0, problem).unwrap();
    let w_t_last = vec![0.0; problem.contacts()];
    formulation.begin(&Increment {
        force: &force,
        gap: model.loading.gap(),
        mu: model.problem.mu(),
        w_t_last: &w_t_last,
        w_o_last: &w_t_last,
    });
    let mut direct = Direct::new(Box::new(Umfpack::default()));
    direct.analyze(formulation.jacobian()).unwrap();

    let n = formulation.unknowns();
    let (mut h, mut dz) = (vec![0.0; n], vec![0.0; n]);
    let (mut seconds, mut worst, mut info) = (Vec::new(), 0.0_f64, linear::FactorInfo::default());
    for iteration in 0..ITERATIONS {
        let z = formulation.layout().pack(&mixed_state(&model, iteration), &scaling).unwrap();
        formulation.linearize(&z);
        formulation.residual(&z, &mut h);
        let jacobian = formulation.jacobian();
        if who == Who::Ours {
            let start = Instant::now();
            info = direct.factorize(jacobian).unwrap();
            let solved = direct.solve(jacobian, &h, &mut dz).unwrap();
            seconds.push(start.elapsed().as_secs_f64());
            worst = worst.max(solved.backward_error);
            linear::process::keep_freed_memory();
        } else {
            let (pattern, values) = prune(jacobian.rest());
            let start = Instant::now();
            let mut umfpack = Umfpack::new(Strategy::Automatic);
            umfpack.analyze_with(&pattern, Some(&values)).unwrap();
            info = umfpack.factorize(&values).unwrap();
            umfpack.solve(&h, &mut dz).unwrap();
            seconds.push(start.elapsed().as_secs_f64());
            worst = worst.max(backward_error(&Csc::new(pattern, values).unwrap().into(), &h, &dz).unwrap());
        }
    }
    seconds.sort_by(f64::total_cmp);
    let process = peak_rss_bytes().unwrap_or(0) as f64 * 1e-6;
    let megabytes = info.peak_bytes * 1e-6;
    [seconds[ITERATIONS / 2], worst, info.entries as f64, info.flops * 1e-9, megabytes, process]
}

/// A third of the contact nodes each open, sticking and slipping.
fn mixed_state(model: &Model, iteration: usize) -> State {
    let problem = &model.problem;
    let mut state = State::zero(problem);
    let n_c = problem.contacts();
    for i in 0..n_c {
        let third = 3 * (i + iteration) / n_c % 3;
        if third > 0 {
            // Above r g, so that the node counts as closed.
            state.p_n[i] = 1.5e12 * problem.weight().unwrap()[i] * model.loading.gap()[i];
            state.p_t[i] = if third == 1 { 0.1 } else { 1.5 } * problem.mu()[i] * state.p_n[i];
        }
    }
    state
}
