//! A scene to its model, if the machine has room for it and the method knows such a problem.

use super::RunError;
use crate::formulation::Layout;
use crate::history::Method;
use crate::model::Model;
use crate::report::{ProbeTable, available_bytes};
use crate::scene::Scene;
use crate::timeline::equal_increments;

/// A history in which gaps are curved in time has so many equal parts, in each of which they are followed along a chord.
const CHORDS: usize = 512;

/// The ends of increments, what lies between them where rates change, and equal parts of the history.
fn chords(ends: &[f64], kinks: &[f64]) -> Vec<f64> {
    let end = ends.last().copied().unwrap_or(0.0);
    let inner = kinks.iter().copied().filter(|t| *t > 0.0 && *t < end);
    let mut times: Vec<f64> =
        equal_increments(end, CHORDS).into_iter().chain(ends.iter().copied()).chain(inner).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// Discretises `scene`.
///
/// # Errors
/// When the scene contradicts its mesh, as a probe outside of the body does, when its method does not know such a problem, and when the
/// matrices would not fit into the memory that is free.
pub fn discretise(scene: &Scene) -> Result<Model, RunError> {
    has_room(scene.description.mesh.nodes(), available_bytes())?;
    let mut model = Model::new(scene)?;
    if let Method::Events { .. } = scene.solver.method {
        let layout = Layout::new(&model.problem);
        let help = "use the method \"bn\"";
        if (0..layout.contacts()).any(|i| layout.slides_in_a_plane(i)) {
            let message =
                "the exact path is followed where nodes slide along lines, but nodes of this scene slide in a plane";
            return Err(scene.error_at("solver.method", message, help).into());
        }
        if model.loading.friction().is_some() {
            let message = "the exact path is followed where friction stays, but that of this scene changes in time";
            return Err(scene.error_at("solver.method", message, help).into());
        }
        if !model.loading.bends().is_empty() {
            let mut scene = scene.clone();
            scene.description.times = chords(&scene.description.times, &model.loading.kinks());
            model = Model::new(&scene)?;
        }
    }
    if let Some(key) = scene.one_tangent_key
        && Layout::new(&model.problem).has_second_tangent()
    {
        let message = "this interior point method knows one tangent a node, but nodes of this scene slide in a plane";
        let help = "leave solver.setting and solver.newton out, or use the method \"bn\"";
        return Err(scene.error_at(key, message, help).into());
    }
    ProbeTable::all(&model, &scene.output.probes).map_err(|fault| scene.located(fault))?;
    Ok(model)
}

/// Whether so many nodes in so many dimensions, where that is known beforehand, fit into the `available` bytes. Asking
/// first is kinder than being killed half-way.
fn has_room(nodes: Option<(usize, usize)>, available: Option<u64>) -> Result<(), RunError> {
    let (Some((nodes, d)), Some(available)) = (nodes, available) else { return Ok(()) };
    // The matrices alone, 16 bytes an entry, and for each unknown 27 of them in two dimensions and 81 in three; the
    // factors take more.
    let needed = (nodes * d * 3_usize.pow(d as u32 + 1) * 16) as u64;
    if needed > available { Err(RunError::NoRoom { needed, available }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused() {
        // Two displacements a node, 27 entries each.
        let needed = 1_000_000 * 2 * 27 * 16;
        assert!(has_room(Some((1_000_000, 2)), Some(needed)).is_ok());
        let refused = has_room(Some((1_000_000, 2)), Some(needed - 1)).err().map(|error| error.to_string());
        let words = "the matrices of this mesh need 0.9 GB and the factors more, but 0.9 GB are free";
        assert_eq!(refused.as_deref(), Some(words));
        assert!(has_room(None, Some(0)).is_ok() && has_room(Some((1, 3)), None).is_ok());
    }
}
