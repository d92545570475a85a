//! The Cholesky factors of K with the contact displacements last: CHOLMOD and faer side by side.
//!
//! `cargo bench --bench cholesky [-- N ...]`: the block with n × n elements. Ordering, analysis and
//! factorisation together, because K is factored once a run; then the two substitutions of a right-hand
//! side. Both in turn, on one thread.
#![allow(missing_docs, clippy::unwrap_used, clippy::print_stdout)]

mod common;

use common::block;
use std::time::Instant;
use stickslip::algebra::Symmetric;
use stickslip::algebra::linear::{self, Cholesky, FactorInfo, LinearError};
use stickslip_output::Table;

const ROUNDS: usize = 5;

type Factor = fn(&Symmetric, &[usize]) -> Result<Cholesky, LinearError>;

const BACKENDS: [(&str, Factor); 2] = [("cholmod", Cholesky::cholmod), ("faer", Cholesky::faer)];

fn main() {
    linear::process::set_blas_threads(1);
    linear::process::keep_freed_memory();
    let sizes: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![50, 100, 200] } else { sizes };
    let mut table =
        Table::new(&["n", "backend", "unknowns", "border", "entries of L", "Gflop", "factor s", "reduce, expand s"]);
    for n in sizes {
        let (_, model) = block(n, 2);
        let k = model.problem.stiffness().assembled().unwrap();
        let last = contact_displacements(&model.problem);
        let mut seconds = [const { [Vec::new(), Vec::new()] }; 2];
        let mut infos = [FactorInfo::default(); 2];
        for _ in 0..ROUNDS {
            for (backend, (_, factor)) in BACKENDS.iter().enumerate() {
                let start = Instant::now();
                let cholesky = factor(&k, &last).unwrap();
                seconds[backend][0].push(start.elapsed().as_secs_f64());
                infos[backend] = cholesky.info();
                let (b, mut x) = (vec![1.0; k.order()], vec![0.0; k.order()]);
                let start = Instant::now();
                let reduced = cholesky.reduce(&b).unwrap();
                cholesky.expand(&reduced, &vec![0.0; last.len()], &mut x).unwrap();
                seconds[backend][1].push(start.elapsed().as_secs_f64());
            }
        }
        for (((name, _), info), [factor, solve]) in BACKENDS.iter().zip(infos).zip(seconds) {
            table.push(vec![
                n.to_string(),
                (*name).to_string(),
                k.order().to_string(),
                last.len().to_string(),
                format!("{:.3e}", info.entries as f64),
                format!("{:.3}", info.flops * 1e-9),
                format!("{:.4}", median(factor)),
                format!("{:.4}", median(solve)),
            ]);
        }
    }
    println!("\nmedian of {ROUNDS}; Gflop: the sum of squares of the columns of L; {}\n\n{table}", common::blas());
}

/// The displacements that a row of `C_n` or `C_t` reaches.
fn contact_displacements(problem: &stickslip::solver::ContactProblem) -> Vec<usize> {
    let rows = (0..problem.contacts()).flat_map(|i| problem.c_n().row(i).iter().chain(problem.c_t().row(i)));
    let mut last: Vec<usize> = rows.map(|&(unknown, _)| unknown).collect();
    last.sort_unstable();
    last.dedup();
    last
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
