//! A scene to its model, if the machine has room for it and the method knows such a problem.

use std::borrow::Cow;

use super::RunError;
use super::need::has_room;
use super::sharing::share;
use crate::algebra::linear::built_in::ranks;
use crate::base::memory::Budget;
use crate::base::timeline::equal_increments;
use crate::body::model::{Model, ModelError, Share};
use crate::run::report::ProbeTable;
use crate::scene::Scene;
use crate::solver::formulation::Layout;
use crate::solver::history::{LinearAlgebra, Method, SolverChoice};

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
    has_room(scene.description.mesh.nodes(), Budget::of_process())?;
    suitable(scene, model_of(scene, None)?)
}

/// The same with the stiffness that the solver of `scene` wants.
pub(super) fn for_run(scene: &Scene) -> Result<Model, RunError> {
    match share(&scene.solver) {
        Some(share) => shared(scene, share),
        None => discretise(scene),
    }
}

/// The `model` of `scene` with the stiffness that the `chosen` linear algebra wants, where `solver` names none. The choice has looked at
/// the whole stiffness, which goes before its rows come.
pub(super) fn as_chosen<'a>(
    scene: Option<&Scene>,
    model: Cow<'a, Model>,
    solver: SolverChoice,
    chosen: LinearAlgebra,
) -> Result<Cow<'a, Model>, RunError> {
    match (scene, share(&SolverChoice { linear: Some(chosen), ..solver })) {
        (Some(scene), Some(share)) if solver.linear.is_none() => {
            drop(model);
            Ok(Cow::Owned(shared(scene, share)?))
        }
        _ => Ok(model),
    }
}

/// The same with a stiffness that is shared as `share` does it, where that can be: each process has its part of the nodes.
pub(super) fn shared(scene: &Scene, share: Share<'_>) -> Result<Model, RunError> {
    let part = |(nodes, dimension): (usize, usize)| (nodes / ranks(), dimension);
    has_room(scene.description.mesh.nodes().map(part), Budget::of_process())?;
    suitable(scene, model_of(scene, Some(share))?)
}

/// The model of `scene`; errors of its description name file and line.
fn model_of(scene: &Scene, share: Option<Share<'_>>) -> Result<Model, RunError> {
    Model::shared(&scene.description, share).map_err(|error| match error {
        ModelError::Description(fault) => RunError::Scene(scene.located(fault)),
        other => other.into(),
    })
}

/// The model of `scene`, if the scene and its method know such a problem.
fn suitable(scene: &Scene, mut model: Model) -> Result<Model, RunError> {
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
            model = model_of(&scene, None)?;
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
