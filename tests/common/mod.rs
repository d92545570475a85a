//! What several tests need: the block of the paper, built and run.
#![allow(dead_code, clippy::unwrap_used)]

pub mod hertz;
pub mod random;

use stickslip::history::{self, HistoryOutcome, HistorySettings, Observer};
use stickslip::linear::Direct;
use stickslip::model::Model;
use stickslip::problem::{Increment, State};
use stickslip::scene::Scene;

/// The paper's block with overrides.
pub fn block(overrides: &[&str]) -> Scene {
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::parse("block.toml", include_str!("../../data/scenes/block.toml"), &overrides).unwrap()
}

/// Runs a scene as the command line does.
pub fn run(scene: &Scene, model: &Model, observer: &mut dyn Observer) -> HistoryOutcome {
    let solver = &scene.solver;
    let settings = HistorySettings::paper_bn(&model.problem, model.scaling(), solver.max_iterations, solver.tolerance);
    let mut linear = Direct::default();
    history::run(&model.problem, &model.loading, &scene.time.all(), &settings, &mut linear, observer).unwrap()
}

/// A scene of data/scenes with overrides.
pub fn scene(name: &str, overrides: &[&str]) -> Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes").join(name);
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::read(&path, &overrides).unwrap()
}

/// Runs a scene with BN in its default setting on condensed matrices.
pub fn run_default(scene: &Scene, model: &Model, observer: &mut dyn Observer) -> HistoryOutcome {
    let solver = &scene.solver;
    let settings = HistorySettings::bn(&model.problem, model.scaling(), solver.max_iterations, solver.tolerance);
    let mut linear = model.linear(stickslip::scene::LinearBackend::Condensed);
    history::run(&model.problem, &model.loading, &scene.time.all(), &settings, &mut linear, observer).unwrap()
}

/// Keeps the state and the data of every increment.
#[derive(Default)]
pub struct Keep {
    pub states: Vec<State>,
    pub forces: Vec<Vec<f64>>,
    pub w_t_last: Vec<Vec<f64>>,
    pub w_o_last: Vec<Vec<f64>>,
}

impl Keep {
    /// The data of increment `k`, from 0.
    pub fn increment<'a>(&'a self, k: usize, gap: &'a [f64]) -> Increment<'a> {
        Increment { force: &self.forces[k], gap, w_t_last: &self.w_t_last[k], w_o_last: &self.w_o_last[k] }
    }
}

impl Observer for Keep {
    fn increment(&mut self, step: &stickslip::history::Step<'_>) -> stickslip::nonlinear::Flow {
        self.states.push(step.state.clone());
        self.forces.push(step.increment.force.to_vec());
        self.w_t_last.push(step.increment.w_t_last.to_vec());
        self.w_o_last.push(step.increment.w_o_last.to_vec());
        stickslip::nonlinear::Flow::Continue
    }
}
