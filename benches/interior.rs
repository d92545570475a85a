//! The Newton system of the interior point methods: all unknowns (extended) against slacks and
//! multipliers eliminated row by row (reduced).
//!
//! `cargo bench --bench interior [-- N ...]`. The block with a third of the contact nodes each open,
//! sticking and slipping, at points nearer and nearer to the border: every pair has the product
//! 1, 1e-4 and 1e-8 of force times length. Both forms factor in turn. Forward error: the largest
//! relative error of any block of dz (u, forces, slacks, multipliers), against a solution refined
//! with residuals in twice the precision.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::block;
use std::time::Instant;
use stickslip::algebra::linear::{
    self, FactorInfo, LinearSolver, RefinedSolver, SystemMatrix, Umfpack, backward_error,
};
use stickslip::body::Model;
use stickslip::solver::Increment;
use stickslip::solver::formulation::{Constrained, FormulationScaling, InteriorPoint, NewtonSystem, Partition};
use stickslip_output::Table;

const PRODUCTS: [f64; 3] = [1.0, 1e-4, 1e-8];
const ROUNDS: usize = 3;
const FORMS: [(NewtonSystem, &str); 2] = [(NewtonSystem::Reduced, "reduced"), (NewtonSystem::Extended, "extended")];

fn main() {
    linear::process::set_blas_threads(1);
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![50, 100, 200] } else { sizes };
    let mut table = Table::new(&[
        "n", "form", "unknowns", "L+U", "Gflop", "factor s", "solve s", "ratio", "backward", "refined", "forward",
        "refined",
    ]);
    for n in sizes {
        let forms = measure(n);
        let seconds = |form: &Form| form.factor_seconds + form.solve_seconds;
        let fastest = seconds(&forms[0]);
        for form in &forms {
            table.push(vec![
                n.to_string(),
                form.name.to_string(),
                form.unknowns.to_string(),
                format!("{:.2e}", form.info.entries as f64),
                format!("{:.3}", form.info.flops * 1e-9),
                format!("{:.4}", form.factor_seconds),
                format!("{:.4}", form.solve_seconds),
                format!("{:.2}", seconds(form) / fastest),
                format!("{:.0e}", form.backward[0]),
                format!("{:.0e}", form.backward[1]),
                format!("{:.0e}", form.forward[0]),
                format!("{:.0e}", form.forward[1]),
            ]);
        }
    }
    println!("\nmedian seconds of a factorisation and of a refined solve; errors: the largest, without and with");
    println!(
        "refinement; backward: of the system that is factored; forward: of all of dz; {}\n\n{table}",
        common::blas()
    );
}

/// What is measured of one form.
struct Form {
    name: &'static str,
    unknowns: usize,
    info: FactorInfo,
    factor_seconds: f64,
    solve_seconds: f64,
    /// Without and with refinement.
    backward: [f64; 2],
    forward: [f64; 2],
}

fn measure(n: usize) -> [Form; 2] {
    let (_, model) = block(n, 2);
    let problem = &model.problem;
    let force = model.loading.force_at(1.0, problem).unwrap();
    let w_t_last = vec![0.0; problem.contacts()];
    let increment = Increment {
        force: &force,
        gap: model.loading.gap(),
        mu: model.problem.mu(),
        w_t_last: &w_t_last,
        w_o_last: &w_t_last,
    };
    let conventions = FormulationScaling::paper(problem.weight().unwrap());
    let mut systems = FORMS.map(|(form, name)| {
        let mut formulation = Constrained::new(problem, model.scaling(), &conventions, Partition::Products, form);
        formulation.begin(&increment);
        let mut bare = Umfpack::default();
        bare.analyze(formulation.matrix().pattern()).unwrap();
        let mut direct = RefinedSolver::new(Box::new(Umfpack::default()));
        direct.analyze(formulation.matrix()).unwrap();
        let unknowns = formulation.matrix().order();
        let info = FactorInfo::default();
        let form = Form {
            name,
            unknowns,
            info,
            factor_seconds: 0.0,
            solve_seconds: 0.0,
            backward: [0.0; 2],
            forward: [0.0; 2],
        };
        (formulation, bare, direct, form, Vec::new(), Vec::new())
    });
    linear::process::keep_freed_memory();
    for product in [PRODUCTS; ROUNDS].concat() {
        let z = point(&systems[0].0, &model, product);
        let mut b = vec![0.0; z.len()];
        systems[0].0.residual(&z, &mut b).unwrap();
        for b in &mut b {
            *b = -*b;
        }

        let (extended, _, direct, ..) = &mut systems[1];
        extended.linearize(&z);
        direct.factorize(extended.matrix()).unwrap();
        let exact = solve_twice_as_precise(extended.matrix(), direct, &b);

        for (formulation, bare, direct, form, factor_seconds, solve_seconds) in &mut systems {
            formulation.linearize(&z);
            let m = form.unknowns;
            let (mut rhs, mut dz) = (vec![0.0; m], vec![0.0; z.len()]);
            formulation.reduce(&z, &b, &mut rhs);

            bare.factorize(formulation.matrix().rest().values()).unwrap();
            bare.solve(&rhs, &mut dz[..m]).unwrap();
            form.backward[0] = form.backward[0].max(backward_error(formulation.matrix(), &rhs, &dz[..m]).unwrap());
            formulation.recover(&z, &b, &mut dz);
            form.forward[0] = form.forward[0].max(forward_error(formulation, &dz, &exact));

            let start = Instant::now();
            form.info = direct.factorize(formulation.matrix()).unwrap();
            factor_seconds.push(start.elapsed().as_secs_f64());
            let start = Instant::now();
            let solved = direct.solve(formulation.matrix(), &rhs, &mut dz[..m]).unwrap();
            solve_seconds.push(start.elapsed().as_secs_f64());
            form.backward[1] = form.backward[1].max(solved.backward_error);
            formulation.recover(&z, &b, &mut dz);
            form.forward[1] = form.forward[1].max(forward_error(formulation, &dz, &exact));
        }
    }
    systems.map(|(_, _, _, mut form, factor_seconds, solve_seconds)| {
        form.factor_seconds = median(factor_seconds);
        form.solve_seconds = median(solve_seconds);
        form
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// A point whose pairs all have the same product, each member that the status makes large being 1:
/// a third of the contact nodes open, sticking, slipping.
fn point(formulation: &Constrained, model: &Model, product: f64) -> Vec<f64> {
    let layout = formulation.layout();
    let n_c = layout.forces().contacts();
    let mut z: Vec<f64> = (0..layout.unknowns()).map(|k| 0.1 * (k as f64).sin()).collect();
    for i in 0..n_c {
        let third = 3 * i / n_c;
        let p_n = layout.forces().p_n(i);
        z[p_n] = if third == 0 { product } else { 1.0 };
        z[layout.v_n(i)] = product / z[p_n];
        if let Some(p_t) = layout.forces().p_t(i) {
            let (s, lambda) = (layout.s(p_t), layout.lambda(p_t));
            z[p_t] = if third == 2 { model.problem.mu()[i] } else { 0.0 };
            z[s[0]] = if third == 1 { 0.4 } else { product };
            z[s[1]] = if third == 0 { product } else { 0.4 };
            (z[lambda[0]], z[lambda[1]]) = (product / z[s[0]], product / z[s[1]]);
        }
    }
    z
}

/// The largest relative error over the blocks of dz.
fn forward_error(formulation: &Constrained, dz: &[f64], exact: &[f64]) -> f64 {
    let layout = formulation.layout();
    let (forces, all) = (layout.forces(), layout.unknowns());
    let cone = layout.cone_rows();
    let ends = [0, forces.displacements(), forces.unknowns(), cone.start, cone.end, all];
    let block = |from: usize, to: usize| {
        let largest = exact[from..to].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let error = dz[from..to].iter().zip(&exact[from..to]).fold(0.0_f64, |m, (x, y)| m.max((x - y).abs()));
        error / largest
    };
    ends.windows(2).map(|pair| block(pair[0], pair[1])).fold(0.0, f64::max)
}

/// `x` with `A x = b`, refined with residuals and sums in twice the precision.
fn solve_twice_as_precise(a: &SystemMatrix, direct: &mut RefinedSolver, b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut x = vec![(0.0, 0.0); n];
    let (mut correction, mut r) = (vec![0.0; n], b.to_vec());
    for _ in 0..8 {
        direct.solve(a, &r, &mut correction).unwrap();
        x.iter_mut().zip(&correction).for_each(|(x, c)| *x = add(*x, (*c, 0.0)));
        let mut residual: Vec<(f64, f64)> = b.iter().map(|b| (*b, 0.0)).collect();
        for (row, column, value) in a.to_csc().unwrap().entries() {
            residual[row] = add(residual[row], times(-value, x[column]));
        }
        r = residual.iter().map(|r| r.0 + r.1).collect();
    }
    x.iter().map(|x| x.0 + x.1).collect()
}

/// The sum of two numbers that are each an unevaluated sum.
fn add(a: (f64, f64), b: (f64, f64)) -> (f64, f64) {
    let sum = a.0 + b.0;
    let back = sum - a.0;
    let low = (a.0 - (sum - back)) + (b.0 - back) + a.1 + b.1;
    (sum + low, low - ((sum + low) - sum))
}

fn times(a: f64, b: (f64, f64)) -> (f64, f64) {
    let product = a * b.0;
    (product, a.mul_add(b.0, -product) + a * b.1)
}
