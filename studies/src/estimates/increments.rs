//! What increments leave in the work of friction and in the tangential forces, beside a run with many times as many.

use std::sync::Arc;

use stickslip::history::{IncrementError, Status};
use stickslip::mesh::CellKind;
use stickslip::run::{Recording, Run};
use stickslip::scene::Scene;

use super::{EstimateError, Row, Subject, Task};

/// A history, its name and what is changed in its scene.
struct History {
    name: &'static str,
    text: &'static str,
    set: &'static [&'static str],
}

const fn history(name: &'static str, text: &'static str, set: &'static [&'static str]) -> History {
    History { name, text, set }
}

const PUNCH: &str = include_str!("../../../data/scenes/punch.toml");
const LINE: &str = include_str!("../../../data/scenes/hertz_line.toml");
const BLOCK: &str = include_str!("../../../data/scenes/block.toml");
const CONFINED: &str = include_str!("../../../data/scenes/confined.toml");
const SEAL: &str = include_str!("../../../data/scenes/seal.toml");
const BOXED: &str = include_str!("../../../data/scenes/boxed.toml");
const CATTANEO: &str = include_str!("../../../data/scenes/cattaneo_mindlin.toml");

const HISTORIES: [History; 11] = [
    history("punch 0.4", PUNCH, &[]),
    history("punch 0.2", PUNCH, &["contact.friction=0.2"]),
    history("cylinder 0.3", LINE, &["contact.friction=0.3", "mesh.contact_elements=32", "mesh.layers=16"]),
    history("cylinder 0.2", LINE, &["contact.friction=0.2", "mesh.contact_elements=32", "mesh.layers=16"]),
    history("block 0.1", BLOCK, &["contact.friction=0.1", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    history("block 0.4", BLOCK, &["contact.friction=0.4", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    history("block 0.8", BLOCK, &["contact.friction=0.8", "mesh.elements=[20,20]", "solver.setting=\"default\""]),
    history("confined", CONFINED, &[]),
    history("seal", SEAL, &[]),
    history("boxed", BOXED, &[]),
    history("cattaneo", CATTANEO, &["mesh.contact_elements=24"]),
];

/// One task for each history: with so many `increments`, beside a run with `reference` of them, a multiple of each.
pub fn increments(increments: &[usize], reference: usize) -> Vec<Task> {
    let counts: Arc<[usize]> = increments.into();
    let of = |history: &'static History| {
        let counts = Arc::clone(&counts);
        Task {
            name: format!("increments, {}", history.name),
            work: Box::new(move || {
                let truth = Solved::new(history, reference)?;
                let rows = counts.iter().map(|&n| Ok(rows(n, &Solved::new(history, n)?, &truth)));
                Ok(rows.collect::<Result<Vec<_>, EstimateError>>()?.concat())
            }),
        }
    };
    HISTORIES.iter().map(of).collect()
}

/// What a run found.
struct Solved {
    found: IncrementError,
    /// The tangential forces of each increment, N, over the root of the node's weight.
    friction: Vec<Vec<f64>>,
}

impl Solved {
    fn new(history: &History, increments: usize) -> Result<Self, EstimateError> {
        let increments = format!("time.increments={increments}");
        let set = history.set.iter().copied().chain([increments.as_str(), "solver.linear=\"condensed\""]);
        let set = set.map(str::parse).collect::<Result<Vec<_>, _>>()?;
        let scene = Scene::parse(history.name, history.text, &set)?;
        let run = Run::new(&scene)?;
        let mut recording = Recording::all();
        let report = run.solve(&mut recording)?;
        if report.status != Status::Converged {
            return Err(EstimateError::Verdict(report.status.to_string()));
        }
        let weight = run.model().problem.weight().unwrap_or_default();
        let friction = |p_t: &[f64]| p_t.iter().zip(weight).map(|(p, l)| p / l.sqrt()).collect();
        let found = report.estimates.increments.ok_or_else(|| EstimateError::Verdict("no estimate".to_string()))?;
        Ok(Solved { found, friction: recording.increments.iter().map(|at| friction(&at.state.p_t)).collect() })
    }
}

/// The work and the tangential forces of a run beside the truth.
fn rows(across: usize, solved: &Solved, truth: &Solved) -> Vec<Row> {
    let row = |subject, error, estimate| Row {
        subject,
        kind: CellKind::Quadrilateral,
        poisson: 0.3,
        across,
        error,
        estimate,
    };
    let Solved { found, friction } = solved;
    let work = (found.friction_work - truth.found.friction_work_corrected) / found.friction_work;
    let size = |p: &[f64]| p.iter().map(|p| p * p).sum::<f64>().sqrt();
    let stride = truth.friction.len() / friction.len();
    let apart = |(k, p): (usize, &Vec<f64>)| {
        let exact = &truth.friction[(k + 1) * stride - 1];
        size(&p.iter().zip(exact).map(|(p, exact)| p - exact).collect::<Vec<_>>())
    };
    let error = friction.iter().enumerate().map(apart).fold(0.0, f64::max);
    let largest = truth.friction.iter().map(|p| size(p)).fold(0.0, f64::max);
    let mut rows = vec![row(Subject::Work, work, found.work_error)];
    rows.extend(found.force_error.map(|estimate| row(Subject::Friction, error / largest, estimate)));
    rows
}
