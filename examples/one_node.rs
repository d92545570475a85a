//! A contact problem without a mesh: one node, two displacements, worked out by hand beside.
//!
//! `cargo run --release --example one_node`
//!
//! K = [[2, 1.5], [1.5, 2]] N/m for (u_t, u_n), no gap, mu = 0.3, force (1, 1) N. If the node slides,
//! u_n = 0, p_t = 0.3 p_n and the rows of K give 2 u_t = 1 - p_t and 1.5 u_t = 1 - p_n: p_n = 0.25 / 0.775.

#![allow(clippy::print_stdout)]

use stickslip::algebra::{Csr, Symmetric};
use stickslip::solver::history::{self, HistorySettings, Method, SystemSolver};
use stickslip::solver::{ContactProblem, LoadCase, Loading, Parts};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let entries = [(0, 0, 2.0), (1, 0, 1.5), (1, 1, 2.0)];
    let stiffness = Symmetric::from_triplets(2, &entries)?;
    let c_t = Csr::from_rows(2, [[(0, 1.0)]])?;
    let c_n = Csr::from_rows(2, [[(1, 1.0)]])?;
    let problem = ContactProblem::new(Parts { c_t, mu: vec![0.3], ..Parts::new(stiffness, c_n) })?;
    let load = LoadCase::new(vec![1.0, 1.0], vec![[0.0, 0.0], [1.0, 1.0]])?;
    let loading = Loading::new(vec![load], vec![0.0])?;

    let settings = HistorySettings::new(&problem, &loading, Method::BN)?;
    let outcome = history::run(&problem, &loading, &[1.0], &settings, SystemSolver::default(), &mut ())?;
    println!(
        "{}: u = {:?} m, p_n = {:?} N, p_t = {:?} N",
        outcome.status, outcome.state.u, outcome.state.p_n, outcome.state.p_t
    );
    println!("by hand: p_n = {}", 0.25 / 0.775);
    Ok(())
}
