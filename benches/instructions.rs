//! Instructions of each kernel, counted by callgrind: the same to four digits on any load of the machine.
//!
//! `make instructions` runs this under valgrind once a kernel and prints the counts. The block with 50 × 50
//! elements, the contact nodes open, slipping and sticking by thirds.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::block;
use stickslip::algebra::linear::{self, Dense, RefinedSolver, SparseCholesky};
use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::solver::formulation::{Bdiff, FormulationScaling};
use stickslip::solver::{Condensed, ContactProblem, Increment, State};

/// What callgrind counts: everything called from here, see the Makefile.
#[inline(never)]
fn measured_kernel(work: &mut dyn FnMut()) {
    std::hint::black_box(work)();
}

fn main() {
    let Some(kernel) = std::env::args().nth(1) else { return };
    linear::process::set_blas_threads(1);
    let (scene, model) = block(50, 2);
    let condensed = Condensed::new(&model.problem, &model.loading, SparseCholesky::default()).unwrap();
    let small = &condensed.problem;
    let scaling = model.scaling();
    let mut formulation = Bdiff::new(small, scaling, &FormulationScaling::paper(small.weight().unwrap()));
    let force = condensed.loading.force_at(1.0, small).unwrap();
    let w_t_last = vec![0.0; small.contacts()];
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
    let [first, second] =
        [0, 1].map(|shift| formulation.layout().pack(&mixed(small, &model, shift), &scaling).unwrap());
    formulation.linearize(&first);
    let (mut h, mut dz) = (vec![0.0; first.len()], vec![0.0; first.len()]);
    formulation.residual(&first, &mut h).unwrap();
    let mut direct = RefinedSolver::new(Box::new(Dense::default()));
    direct.analyze(formulation.jacobian()).unwrap();
    match kernel.as_str() {
        "assembly" => measured_kernel(&mut || drop(discretise(&scene).unwrap())),
        "condensation" => measured_kernel(&mut || {
            drop(Condensed::new(&model.problem, &model.loading, SparseCholesky::default()).unwrap());
        }),
        "jacobian" => measured_kernel(&mut || assert!(formulation.linearize(&second))),
        "residual" => measured_kernel(&mut || formulation.residual(&second, &mut h).unwrap()),
        "dense-factor" => measured_kernel(&mut || {
            direct.factorize(formulation.jacobian()).unwrap();
        }),
        "substitution" => {
            let whole = model.loading.force_at(1.0, &model.problem).unwrap();
            let border = vec![0.0; small.displacements()];
            measured_kernel(&mut || {
                let reduced = condensed.reduce(&whole).unwrap();
                drop(condensed.displacements(&reduced, &border).unwrap());
            });
        }
        "bn-iteration" => measured_kernel(&mut || {
            formulation.linearize(&second);
            direct.factorize(formulation.jacobian()).unwrap();
            direct.solve(formulation.jacobian(), &h, &mut dz).unwrap();
            formulation.residual(&second, &mut h).unwrap();
        }),
        // What `cargo bench` adds, and nothing else.
        other => assert!(other.starts_with("--"), "no kernel `{other}`"),
    }
}

/// A third of the contact nodes each open, sticking and slipping.
fn mixed(problem: &ContactProblem, model: &Model, shift: usize) -> State {
    let mut state = State::zero(problem);
    let n_c = problem.contacts();
    for i in 0..n_c {
        let third = 3 * (i + shift) / n_c % 3;
        if third > 0 {
            // Above r g, so that the node counts as closed.
            state.p_n[i] = 1.5e12 * problem.weight().unwrap()[i] * model.loading.gap()[i];
            state.p_t[i] = if third == 1 { 0.1 } else { 1.5 } * problem.mu()[i] * state.p_n[i];
        }
    }
    state
}
