//! Everything one's own: matrices from arrays, a linear solver, an observer; and a scene that is run without files.
//!
//! `cargo run --example outside`

#![allow(clippy::print_stdout)]

use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::algebra::linear::{FactorInfo, LinearError, LinearSolver};
use stickslip::algebra::{Csc, Csr, Pattern, Symmetric};
use stickslip::run::Run;
use stickslip::scene::Scene;
use stickslip::solver::history::{self, HistorySettings, Method, Observer, SystemSolver};
use stickslip::solver::{ContactProblem, LinearSystem, LoadCase, Loading, Parts};

/// Gauss and Jordan, in a dense matrix.
#[derive(Default)]
struct Dense(Option<Arc<Pattern>>, Vec<Vec<f64>>);

impl LinearSolver for Dense {
    fn name(&self) -> &'static str {
        "Gauss and Jordan"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.0 = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let pattern = self.0.clone().ok_or(LinearError::Order { missing: "analyze" })?;
        let matrix = Csc::new(pattern, values.to_vec()).map_err(|_| LinearError::PatternChanged)?;
        self.1 = vec![vec![0.0; matrix.pattern().columns()]; matrix.pattern().rows()];
        matrix.entries().for_each(|(row, column, value)| self.1[row][column] = value);
        Ok(FactorInfo::default())
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        let mut rows: Vec<Vec<f64>> = self.1.iter().zip(b).map(|(row, b)| [&row[..], &[*b]].concat()).collect();
        for k in 0..rows.len() {
            let size = |i: &usize| rows[*i][k].abs();
            let pivot = (k..rows.len()).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
            rows.swap(k, pivot);
            let row = rows[k].clone();
            for other in rows.iter_mut().enumerate().filter(|(i, _)| *i != k).map(|(_, row)| row) {
                let factor = other[k] / row[k];
                other.iter_mut().zip(&row).for_each(|(a, b)| *a -= factor * b);
            }
        }
        rows.iter().enumerate().for_each(|(k, row)| x[k] = row[rows.len()] / row[k]);
        Ok(())
    }
}

/// Counts the linear systems that it is shown, and keeps the largest direction.
#[derive(Default)]
struct Systems(usize, f64);

impl Observer for Systems {
    fn linear_system(&mut self, _index: usize, system: &LinearSystem<'_>) -> ControlFlow<()> {
        assert_eq!(system.solution.len(), system.layout.unknowns());
        (self.0, self.1) = (self.0 + 1, system.solution.iter().fold(self.1, |m, dz| m.max(dz.abs())));
        ControlFlow::Continue(())
    }
}

/// Two nodes on springs above a floor; the sum of the contact forces along the normal, N.
fn arrays() -> Result<f64, Box<dyn std::error::Error>> {
    let k = Csc::from_parts(4, &[0, 2, 4, 6, 8], &[0, 2, 1, 3, 0, 2, 1, 3], &[3., -1., 3., -1., -1., 3., -1., 3.])?;
    let [c_n, c_t] = [1, 0].map(|c| Csr::from_rows(4, [[(c, -1.0)], [(2 + c, -1.0)]]));
    let parts = Parts { c_t: c_t?, mu: vec![0.4; 2], ..Parts::new(Symmetric::from_csc(&k)?, c_n?) };
    let problem = ContactProblem::new(parts)?;
    let push = LoadCase::new(vec![0.3, -1.0, 0.3, -2.0], vec![[0.0, 0.0], [1.0, 1.0]])?;
    let loading = Loading::new(vec![push], vec![0.0; 2])?;
    let settings = HistorySettings::new(&problem, &loading, Method::BN)?;
    let (mine, mut systems): (Box<dyn LinearSolver>, _) = (Box::new(Dense::default()), Systems::default());
    let outcome = history::run(&problem, &loading, &[0.5, 1.0], &settings, SystemSolver::from(mine), &mut systems)?;
    println!("{}: p_n = {:?} N, {} linear systems", outcome.status, outcome.state.p_n, systems.0);
    Ok(outcome.state.p_n.iter().sum())
}

/// The paper's block on 10 × 10 elements; the same sum at the end, N.
fn scene() -> Result<f64, Box<dyn std::error::Error>> {
    let scene =
        Scene::parse("block.toml", include_str!("../data/scenes/block.toml"), &["mesh.elements=[10,10]".parse()?])?;
    let report = Run::new(&scene)?.solve(&mut ())?;
    println!("{}: {} increments", report.status, report.increments.len());
    Ok(report.end.sum_p_n)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("sums {} N and {:.6e} N", arrays()?, scene()?);
    Ok(())
}

#[test]
fn both_run() {
    assert!((arrays().expect("arrays") - 3.0).abs() < 1e-12);
    assert!(scene().expect("scene") > 1e6);
}
