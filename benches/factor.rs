//! One iteration's linear algebra: UMFPACK as used here against a naive caller.
//!
//! `cargo bench --bench factor [-- MESH ...]`, where a mesh is `100` for a square or `16x16x16` for a cube. The Jacobian with a third
//! of the contact nodes each open, sticking and slipping, the borders moving from one iteration to the next. Ours: scaled unknowns,
//! union pattern, symmetric strategy, one symbolic analysis (not in the time, it is made once a run), refinement until the backward
//! error is at rounding; in turn with the order of METIS and with the best of several. Naive: see `Who`; making the pruned matrix is
//! not in its time, the symbolic analysis is.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::run::Elements;
use common::{Who, compare, prune, scene};
use std::time::Instant;
use stickslip::algebra::Csc;
use stickslip::algebra::linear::{self, LinearSolver, RefinedSolver, Strategy, Umfpack, backward_error};
use stickslip::base::Scaling;
use stickslip::body::Model;
use stickslip::run::report::peak_rss_bytes;
use stickslip::solver::formulation::{Bdiff, FormulationScaling};
use stickslip::solver::{Increment, State};
use stickslip_output::Table;

const ITERATIONS: usize = 5;

const MESHES: [&str; 6] = ["50", "100", "200", "400", "16x16x16", "24x24x24"];

/// The naive caller is left alone with more unknowns of a solid body: an hour may not do.
const NAIVE_SOLID: usize = 20_000;

fn main() {
    let mut table = Table::new(&[
        "mesh",
        "unknowns",
        "ours s",
        "best order",
        "naive",
        "naive / ours",
        "ours L+U",
        "best order",
        "naive",
        "ours Gflop",
        "best order",
        "naive",
        "ours GF/s",
        "ours error",
        "naive",
        "ours MB",
        "naive",
        "process MB",
        "naive",
    ]);
    compare(&MESHES.map(|mesh| mesh.parse().unwrap()), measure, |mesh: Elements, ours, naive| {
        let [unknowns, seconds, error, entries, gflop, megabytes, process, best @ ..] = ours;
        let shown = |x: f64, text: String| if x.is_nan() { "-".to_string() } else { text };
        let mut row = vec![mesh.to_string(), unknowns.to_string()];
        row.extend([seconds, best[0], naive[1]].map(|seconds| shown(seconds, format!("{seconds:.4}"))));
        row.push(shown(naive[1], format!("{:.2}", naive[1] / seconds)));
        row.extend([entries, best[1], naive[3]].map(|entries| shown(entries, format!("{entries:.2e}"))));
        row.extend([gflop, best[2], naive[4]].map(|gflop| shown(gflop, format!("{gflop:.2}"))));
        row.push(format!("{:.1}", gflop / seconds));
        row.extend([error, naive[2]].map(|error| shown(error, format!("{error:.1e}"))));
        row.extend([megabytes, naive[5], process, naive[6]].map(|mb| shown(mb, format!("{mb:.0}"))));
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

/// The unknowns; median seconds, worst backward error, entries of L + U, Gflop, UMFPACK's peak memory and the
/// process's, MB; then seconds, entries and Gflop in the best of several orders, if there are any.
fn measure(mesh: Elements, who: Who) -> [f64; 10] {
    let (name, overrides) = mesh.meshed();
    let (_, model) = scene(name, &overrides);
    let problem = &model.problem;
    let solid = matches!(mesh, Elements::Solid(_));
    let scaling = if who == Who::Ours { model.scaling() } else { Scaling::SI };
    let mut formulation = Bdiff::new(problem, scaling, &FormulationScaling::paper(problem.weight().unwrap()));
    let unknowns = formulation.unknowns();
    if who == Who::Naive && solid && unknowns > NAIVE_SOLID {
        return [f64::NAN; 10];
    }
    let force = model.loading.force_at(1.0, problem).unwrap();
    let w_t_last = vec![0.0; problem.contacts()];
    formulation.begin(
        &Increment {
            force: &force,
            gap: model.loading.gap(),
            mu: model.problem.mu(),
            w_t_last: &w_t_last,
            w_o_last: &w_t_last,
        },
        &vec![0.0; formulation.unknowns()],
    );
    // In space there is one good order.
    let strategies = [Strategy::Symmetric, Strategy::SymmetricInBestOrder];
    let strategies = if solid { &strategies[..1] } else { &strategies };
    let ordered = |strategy: &Strategy| {
        let mut direct = RefinedSolver::new(Box::new(Umfpack::new(*strategy)));
        direct.analyze(formulation.jacobian()).unwrap();
        direct
    };
    let mut directs: Vec<RefinedSolver> = strategies.iter().filter(|_| who == Who::Ours).map(ordered).collect();

    let (mut h, mut dz) = (vec![0.0; unknowns], vec![0.0; unknowns]);
    let (mut seconds, mut worst, mut infos) = ([const { Vec::new() }; 2], 0.0_f64, [linear::FactorInfo::default(); 2]);
    for iteration in 0..ITERATIONS {
        let z = formulation.layout().pack(&mixed_state(&model, iteration), &scaling).unwrap();
        formulation.linearize(&z);
        formulation.residual(&z, &mut h).unwrap();
        let jacobian = formulation.jacobian();
        for ((direct, seconds), info) in directs.iter_mut().zip(&mut seconds).zip(&mut infos) {
            let start = Instant::now();
            *info = direct.factorize(jacobian).unwrap();
            let solved = direct.solve(jacobian, &h, &mut dz).unwrap();
            seconds.push(start.elapsed().as_secs_f64());
            worst = worst.max(solved.backward_error);
            linear::process::keep_freed_memory();
        }
        if who == Who::Naive {
            let (pattern, values) = prune(jacobian.rest());
            let start = Instant::now();
            let mut umfpack = Umfpack::new(Strategy::Automatic);
            umfpack.analyze_with(&pattern, Some(&values)).unwrap();
            infos[0] = umfpack.factorize(&values).unwrap();
            umfpack.solve(&h, &mut dz).unwrap();
            seconds[0].push(start.elapsed().as_secs_f64());
            worst = worst.max(backward_error(&Csc::new(pattern, values).unwrap().into(), &h, &dz).unwrap());
        }
    }
    let medians = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds.get(ITERATIONS / 2).copied().unwrap_or(f64::NAN)
    });
    let process = peak_rss_bytes().unwrap_or(0) as f64 * 1e-6;
    let [own, best] = infos.map(|info| [info.entries as f64, info.flops * 1e-9, info.peak_bytes * 1e-6]);
    let best = if medians[1].is_nan() { [f64::NAN; 3] } else { [medians[1], best[0], best[1]] };
    let mut numbers = [unknowns as f64, medians[0], worst, own[0], own[1], own[2], process, 0.0, 0.0, 0.0];
    numbers[7..].copy_from_slice(&best);
    numbers
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
