//! What the benchmarks share: the paper's block, and the naive caller to compare with.
#![allow(dead_code, clippy::unwrap_used, clippy::print_stdout)]

use std::sync::Arc;

use stickslip::linear::{FactorInfo, LinearError, LinearSolver, Strategy, Umfpack};
use stickslip::model::Model;
use stickslip::scene::Scene;
use stickslip::sparse::{Csc, Pattern};

/// The paper's block with n × n elements, mu = 0.4.
pub fn block(n: usize, increments: usize) -> (Scene, Model) {
    let overrides = [format!("mesh.elements=[{n},{n}]"), format!("time.increments={increments}")];
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::parse("block.toml", include_str!("../../data/scenes/block.toml"), &overrides).unwrap();
    let model = Model::new(&scene).unwrap();
    (scene, model)
}

/// The mesh sizes to run: those after `--`, else `all`.
pub fn sizes(all: &[usize]) -> Vec<usize> {
    let given: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    if given.is_empty() { all.to_vec() } else { given }
}

/// UMFPACK as one calls it who has only read its quick start: the pattern without zeros, default
/// strategy with the values in sight, a fresh symbolic analysis for every matrix. Refinement is the
/// same as ours, because [`stickslip::linear::Direct`] does it for every backend.
#[derive(Default)]
pub struct Naive {
    pattern: Option<Arc<Pattern>>,
    umfpack: Option<Umfpack>,
}

impl LinearSolver for Naive {
    fn name(&self) -> &'static str {
        "naive"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.pattern = Some(Arc::clone(pattern));
        Ok(())
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        let pattern = self.pattern.clone().ok_or(LinearError::Order { missing: "analyze" })?;
        let (pruned, values) = prune(&Csc { pattern, values: values.to_vec() });
        self.umfpack = None;
        let mut umfpack = Umfpack::new(Strategy::Automatic);
        umfpack.analyze_with(&pruned, Some(&values))?;
        let info = umfpack.factorize(&values)?;
        self.umfpack = Some(umfpack);
        Ok(info)
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.umfpack.as_mut().ok_or(LinearError::Order { missing: "factorize" })?.solve(b, x)
    }
}

/// The matrix without its explicit zeros.
pub fn prune(a: &Csc) -> (Arc<Pattern>, Vec<f64>) {
    let pattern = Pattern::from_entries(a.pattern.rows(), a.pattern.columns(), |take| {
        a.entries().filter(|&(_, _, value)| value != 0.0).for_each(|(i, j, _)| take(i, j));
    });
    let values = a.values.iter().copied().filter(|&value| value != 0.0).collect();
    (Arc::new(pattern), values)
}
