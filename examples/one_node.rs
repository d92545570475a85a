//! A contact problem without a mesh: one node, two displacements, worked out by hand beside.
//!
//! `cargo run --release --example one_node`
//!
//! K = [[2, 1.5], [1.5, 2]] N/m for (u_t, u_n), no gap, mu = 0.3, force (1, 1) N. If the node slides,
//! u_n = 0, p_t = 0.3 p_n and the rows of K give 2 u_t = 1 - p_t and 1.5 u_t = 1 - p_n: p_n = 0.25 / 0.775.

#![allow(clippy::print_stdout)]

use stickslip::history::{self, HistorySettings, Method};
use stickslip::linear::Direct;
use stickslip::loading::{LoadCase, Loading};
use stickslip::problem::ContactProblem;
use stickslip::sparse::{Csr, Symmetric};
use stickslip::units::Scaling;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let entries = [(0, 0, 2.0), (1, 0, 1.5), (1, 1, 2.0)];
    let mut stiffness = Symmetric::from_entries(2, |take| entries.iter().for_each(|&(i, j, _)| take(i, j)));
    for (i, j, value) in entries {
        stiffness.add(i, j, value);
    }
    let [mut c_n, mut c_t, mut c_o] = [(); 3].map(|()| Csr::new(2));
    c_t.push_row([(0, 1.0)]);
    c_n.push_row([(1, 1.0)]);
    c_o.push_row([]);
    let problem = ContactProblem { stiffness, c_n, c_t, c_o, mu: vec![0.3], weight: vec![1.0], free_motions: vec![] };
    let load = LoadCase { force: vec![1.0, 1.0], history: vec![[0.0, 0.0], [1.0, 1.0]] };
    let loading = Loading { cases: vec![load], gap: vec![0.0], ..Loading::default() };

    let settings = HistorySettings::new(&problem, &loading, Method::BN).unwrap().until(50, 1e-12);
    let mut linear = Direct::default();
    let outcome = history::run(&problem, &loading, &[1.0], &settings, linear, &mut ())?;
    println!(
        "{}: u = {:?} m, p_n = {:?} N, p_t = {:?} N",
        outcome.status, outcome.state.u, outcome.state.p_n, outcome.state.p_t
    );
    println!("by hand: p_n = {}", 0.25 / 0.775);
    Ok(())
}
