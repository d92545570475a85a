//! One iteration's linear algebra: UMFPACK as used here against a naive caller.
//!
//! `cargo bench --bench factor [-- N ...]`. The Jacobian of the block with a third of the contact
//! nodes each open, sticking and slipping; a few of them change between iterations. Ours: scaled
//! unknowns, union pattern, symmetric strategy, one symbolic analysis. Naive: newtons and metres,
//! pruned pattern, default strategy, a symbolic analysis an iteration.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use std::time::Instant;

use common::{Naive, block, sizes};
use stickslip::formulation::{Bdiff, Conventions, Formulation};
use stickslip::linear::{self, Direct, LinearSolver, Umfpack};
use stickslip::model::Model;
use stickslip::problem::{Increment, State};
use stickslip::report::{Table, peak_rss_bytes};
use stickslip::units::Scaling;

const ITERATIONS: usize = 5;

struct Measured {
    seconds: f64,
    backward_error: f64,
    entries: usize,
    gflop: f64,
}

fn main() {
    linear::process::set_blas_threads(1);
    let sizes = sizes(&[50, 100, 200, 400]);
    let models: Vec<(usize, Model)> = sizes.iter().map(|&n| (n, block(n, 2).1)).collect();
    // Ours first: the peak memory of the process is then ours.
    let mut ours = Vec::new();
    for (_, model) in &models {
        let measured = measure(model, model.scaling(), Box::new(Umfpack::default()));
        ours.push((measured, peak_rss_bytes().unwrap_or(0)));
    }
    let mut table = Table::new(&[
        "n",
        "unknowns",
        "ours s",
        "naive s",
        "ratio",
        "ours error",
        "naive error",
        "L+U ours",
        "naive",
        "Gflop ours",
        "naive",
        "peak MB",
    ]);
    for ((n, model), (ours, peak)) in models.iter().zip(&ours) {
        let naive = measure(model, Scaling::SI, Box::new(Naive::default()));
        table.push(vec![
            n.to_string(),
            (model.problem.displacements() + 2 * model.problem.contacts()).to_string(),
            format!("{:.4}", ours.seconds),
            format!("{:.4}", naive.seconds),
            format!("{:.2}", naive.seconds / ours.seconds),
            format!("{:.1e}", ours.backward_error),
            format!("{:.1e}", naive.backward_error),
            format!("{:.2e}", ours.entries as f64),
            format!("{:.2e}", naive.entries as f64),
            format!("{:.2}", ours.gflop),
            format!("{:.2}", naive.gflop),
            format!("{:.0}", *peak as f64 * 1e-6),
        ]);
    }
    println!("\nfactor and solve, median of {ITERATIONS} iterations, one BLAS thread\n\n{table}");
}

/// The median time of factorisation and refined solve, and the largest backward error.
fn measure(model: &Model, scaling: Scaling, backend: Box<dyn LinearSolver>) -> Measured {
    let problem = &model.problem;
    let mut formulation = Bdiff::new(problem, scaling, &Conventions::paper(problem));
    let mut force = vec![0.0; problem.displacements()];
    model.loading.force(1.0, &mut force);
    let n_c = problem.contacts();
    let w_t_last = vec![0.0; n_c];
    let gap = &model.loading.gap;
    formulation.begin(&Increment { force: &force, gap, w_t_last: &w_t_last });
    let mut direct = Direct::new(backend);
    direct.analyze(&formulation.jacobian().pattern).unwrap();
    let n = formulation.unknowns();
    let (mut h, mut dz) = (vec![0.0; n], vec![0.0; n]);
    let mut seconds = Vec::new();
    for iteration in 0..ITERATIONS {
        let z = formulation.layout().pack(&mixed_state(model, iteration), &scaling);
        formulation.linearize(&z);
        formulation.residual(&z, &mut h);
        h.iter_mut().for_each(|h| *h = -*h);
        let start = Instant::now();
        direct.factorize(formulation.jacobian()).unwrap();
        direct.solve(formulation.jacobian(), &h, &mut dz).unwrap();
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let statistics = direct.statistics();
    Measured {
        seconds: seconds[ITERATIONS / 2],
        backward_error: statistics.worst_backward_error,
        entries: statistics.factor.entries,
        gflop: statistics.factor.flops * 1e-9,
    }
}

/// A third of the contact nodes each open, sticking and slipping, the borders moving from one
/// iteration to the next.
fn mixed_state(model: &Model, iteration: usize) -> State {
    let problem = &model.problem;
    let mut state = State::zero(problem);
    let n_c = problem.contacts();
    let pressure = 5e6;
    for i in 0..n_c {
        let third = 3 * (i + iteration) / n_c % 3;
        if third > 0 {
            state.p_n[i] = pressure * problem.weight[i] + 1e12 * problem.weight[i] * model.loading.gap[i];
            state.p_t[i] = if third == 1 { 0.1 } else { 0.5 } * problem.mu[i] * state.p_n[i] * third as f64;
        }
    }
    state
}
