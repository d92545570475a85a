//! The deformation of the body at the end of a step.

use crate::body::model::Model;
use crate::solver::history::IncrementView;

/// Returns the displacements of all nodes (m) at the end of a step, and the factors of thermal loads, see
/// `Model::thermal_factors`. Increment 0 is the body before anything acts on it, even if loads exist at t = 0.
pub fn deformation(model: &Model, step: &IncrementView<'_>) -> (Vec<[f64; 3]>, Vec<f64>) {
    let time = step.record.time;
    match step.record.index {
        0 => (vec![[0.0; 3]; model.mesh.nodes.len()], Vec::new()),
        _ => (model.displaced(time, &step.state.u), model.thermal_factors(time)),
    }
}
