//! What several tests need: the block of the paper, built and run.
#![allow(dead_code, unused_imports, clippy::unwrap_used)]

pub mod around;
pub mod convergence;
pub mod faults;
pub mod hertz;
pub mod mesh_files;
pub mod nodes;
pub mod pairs;
pub mod prelude;
pub mod random;
pub mod rings;
pub mod round;
pub mod runs;
pub mod scenes;
pub mod scratch;
pub mod vtu;

use scenes::scene;
use std::io::Write;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip::algebra::linear::{RefinedSolver, Stiffness, SystemMatrix};
use stickslip::algebra::{Csc, Symmetric};
use stickslip::body::Model;
use stickslip::run::Run;
use stickslip::scene::Scene;
use stickslip::solver::history::{HistoryOutcome, LinearAlgebra, Method, Observer, SolverChoice};
use stickslip::solver::{ContactProblem, Increment, Parts, State};

/// Says that the running test has tested nothing, and why; standard output would be hidden.
pub fn skipped(why: &str) {
    let thread = std::thread::current();
    let _ = writeln!(std::io::stderr(), "skipped: {}: {why}", thread.name().unwrap_or_default());
}

/// The folder of the repository: the package that is tested is in it, or is it.
pub fn root() -> &'static std::path::Path {
    let package = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().find(|folder| folder.join("data/scenes").is_dir()).unwrap()
}

/// The paper's block with overrides.
pub fn block(overrides: &[&str]) -> Scene {
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::parse("block.toml", scenes::BLOCK, &overrides).unwrap()
}

/// Multiplies the stiffness.
pub fn scale(stiffness: &mut Stiffness, factor: f64) {
    let mut k = Arc::unwrap_or_clone(stiffness.assembled().unwrap());
    k.scale(factor);
    *stiffness = k.into();
}

/// The same problem with other parts.
pub fn changed(problem: &ContactProblem, change: impl FnOnce(&mut Parts)) -> ContactProblem {
    let mut parts = problem.clone().into_parts();
    change(&mut parts);
    ContactProblem::new(parts).unwrap()
}

/// `text` with the first `from` replaced.
pub fn edit(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the scene has no `{from}` to edit");
    text.replacen(from, to, 1)
}

/// Runs a scene on its model as the command line does.
pub fn run(scene: &Scene, model: &Model, observer: &mut dyn Observer) -> HistoryOutcome {
    Run::of(model, scene.time.all(), scene.solver).unwrap().history(observer).unwrap()
}

/// A scene of data/scenes with overrides.
pub fn scene(name: &str, overrides: &[&str]) -> Scene {
    let path = root().join("data/scenes").join(name);
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    Scene::read(&path, &overrides).unwrap()
}

/// The same with BN in its default setting on condensed matrices, whatever the scene says.
pub fn run_default(scene: &Scene, model: &Model, observer: &mut dyn Observer) -> HistoryOutcome {
    let solver = SolverChoice { method: Method::BN.into(), linear: Some(LinearAlgebra::condensed()), ..scene.solver };
    Run::of(model, scene.time.all(), solver).unwrap().history(observer).unwrap()
}

scene! {
/// A block on a plane that pulls it along.
pub static BELT = r#"
title = "A block on a belt"
[mesh] kind = "block", size = [1.0, 0.5], elements = [8, 4]
[material] young = 1e9, poisson = 0.3
[[support]] boundary = "top", fix = ["x"]
[[contact]] boundary = "bottom", friction = 0.3
obstacle = { kind = "plane", motion = { translation = [[0, 0, 0], [1, 0, 0], [2, 0.5, 0]] } }
[[load]] boundary = "top", traction = [0.0, -1e5], history = [[0, 0], [1, 1], [2, 1]]
[time] end = 2.0, increments = 4
"# }

/// Keeps the state and the data of every increment.
#[derive(Default)]
pub struct Keep {
    pub states: Vec<State>,
    pub forces: Vec<Vec<f64>>,
    pub mu: Vec<Vec<f64>>,
    pub w_t_last: Vec<Vec<f64>>,
    pub w_o_last: Vec<Vec<f64>>,
}

impl Keep {
    /// The data of increment `k`, from 0.
    pub fn increment<'a>(&'a self, k: usize, gap: &'a [f64]) -> Increment<'a> {
        let (w_t_last, w_o_last) = (&self.w_t_last[k], &self.w_o_last[k]);
        Increment { force: &self.forces[k], gap, mu: &self.mu[k], w_t_last, w_o_last }
    }
}

impl Observer for Keep {
    fn increment(&mut self, step: &stickslip::solver::history::IncrementView<'_>) -> ControlFlow<()> {
        self.states.push(step.state.clone());
        self.forces.push(step.increment.force.to_vec());
        self.mu.push(step.increment.mu.to_vec());
        self.w_t_last.push(step.increment.w_t_last.to_vec());
        self.w_o_last.push(step.increment.w_o_last.to_vec());
        ControlFlow::Continue(())
    }
}

/// The largest difference of u, and of the contact forces, in any increment, relative to the largest value of the
/// history.
pub fn difference(a: &[State], b: &[State]) -> f64 {
    assert_eq!(a.len(), b.len());
    let relative = |values: fn(&State) -> Vec<f64>| {
        let largest = a.iter().flat_map(values).fold(0.0_f64, |m, x| m.max(x.abs()));
        let pairs = a.iter().flat_map(values).zip(b.iter().flat_map(values));
        pairs.fold(0.0_f64, |m, (x, y)| m.max((x - y).abs())) / largest
    };
    relative(|state| state.u.clone()).max(relative(|state| [&state.p_n[..], &state.p_t, &state.p_o].concat()))
}

/// `K⁻¹ force` of an assembled stiffness.
pub fn solve(stiffness: &Symmetric, force: &[f64]) -> Vec<f64> {
    let n = stiffness.order();
    let k = SystemMatrix::from(Csc::from_triplets(n, n, &stiffness.entries().collect::<Vec<_>>()).unwrap());
    let mut direct = RefinedSolver::default();
    direct.analyze(&k).unwrap();
    direct.factorize(&k).unwrap();
    let mut u = vec![0.0; n];
    direct.solve(&k, force, &mut u).unwrap();
    u
}
