//! Builds the model of a scene, if it fits into memory and the method can solve it.

use std::borrow::Cow;

use super::RunError;
use super::lock::locked;
use super::need::has_room;
use super::refinement::{CoarserMesh, Refinement};
use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::{Engine, engine};
use crate::base::memory::Budget;
use crate::base::timeline::equal_increments;
use crate::body::model::{Model, ModelError, Share};
use crate::run::report::ProbeTable;
use crate::scene::Scene;
use crate::solver::formulation::Layout;
use crate::solver::history::{HistoryMethod, LinearAlgebra, Method, Observer, SolverChoice};

/// The number of equal parts of a history whose gaps are curved in time. Within each part the gaps follow a chord.
const CHORDS: usize = 512;

/// Returns the ends of increments, the kinks between them, and the ends of equal parts of the history.
fn chords(ends: &[f64], kinks: &[f64]) -> Vec<f64> {
    let end = ends.last().copied().unwrap_or(0.0);
    let inner = kinks.iter().copied().filter(|t| *t > 0.0 && *t < end);
    let mut times: Vec<f64> =
        equal_increments(end, CHORDS).into_iter().chain(ends.iter().copied()).chain(inner).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// Discretises `scene`. The history until pretensions lock is solved first, which gives their shortenings.
///
/// # Errors
/// When the scene contradicts its mesh, e.g. by a probe outside the body, when the method cannot solve such a problem,
/// and when the matrices would not fit into free memory.
pub fn discretise(scene: &Scene) -> Result<Model, RunError> {
    tightening(&*locked(scene, tightening)?)
}

/// Discretises `scene` as it is before pretensions lock; no history is solved.
///
/// # Errors
/// As [`discretise`].
pub fn tightening(scene: &Scene) -> Result<Model, RunError> {
    has_room(scene.description.mesh.nodes(), Budget::of_process())?;
    if scene.refine.is_some() {
        Refinement::new(scene)?;
    }
    suitable(scene, model_of(scene, None)?)
}

/// Discretises `scene` with the stiffness that its solver needs, on the mesh that it asks for; returns the coarser
/// meshes, too. `prepare` sees their models and `observer` the iterations on them.
pub(super) fn for_run(
    scene: &Scene,
    prepare: &mut dyn FnMut(&Model),
    observer: &mut dyn Observer,
) -> Result<(Model, Vec<CoarserMesh>), RunError> {
    let (mut scene, mut meshes) = (Cow::Borrowed(scene), Vec::new());
    if let Some(wanted) = scene.refine {
        let mut refinement = Refinement::new(&scene)?;
        refinement.until(wanted, prepare, observer)?;
        let (refined, coarser) = refinement.into_scene();
        (scene, meshes) = (Cow::Owned(refined), coarser);
    }
    let model = match share(&scene.solver) {
        Some(engine) => shared(&*locked(&scene, tightening)?, engine)?,
        None => discretise(&scene)?,
    };
    Ok((model, meshes))
}

/// If the solver was chosen automatically and needs a distributed stiffness, rebuilds the model of `scene` with one.
/// The assembled matrix is dropped first.
pub(super) fn as_chosen<'a>(
    scene: Option<&Scene>,
    model: Cow<'a, Model>,
    solver: SolverChoice,
    chosen: LinearAlgebra,
) -> Result<Cow<'a, Model>, RunError> {
    match (scene, share(&SolverChoice { linear: Some(chosen), ..solver })) {
        (Some(scene), Some(engine)) if solver.linear.is_none() => {
            // The model may have prescribed shortenings in place of locks.
            let mut scene = scene.clone();
            scene.description = model.description().clone();
            drop(model);
            Ok(Cow::Owned(shared(&scene, engine)?))
        }
        _ => Ok(model),
    }
}

/// Discretises `scene` with a stiffness distributed by `engine` if possible, so that each process has a part of the
/// nodes.
pub(super) fn shared(scene: &Scene, engine: &dyn Engine) -> Result<Model, RunError> {
    let per_rank = |(nodes, dimension): (usize, usize)| (nodes / ranks(), dimension);
    has_room(scene.description.mesh.nodes().map(per_rank), Budget::of_process())?;
    suitable(scene, model_of(scene, Some(&|body, near, contacts| engine.share(body, near, contacts)))?)
}

/// Returns the engine that distributes the stiffness of a model solved by `solver`; `None` if it needs no rows.
fn share(solver: &SolverChoice) -> Option<&'static dyn Engine> {
    let wants_rows = solver.linear.is_some_and(LinearAlgebra::iterates) && !solver.method.is_exact_path();
    engine().filter(|_| wants_rows)
}

/// Builds the model of `scene`. Errors of its description name file and line.
fn model_of(scene: &Scene, share: Option<Share<'_>>) -> Result<Model, RunError> {
    Model::shared(&scene.description, share).map_err(|error| match error {
        ModelError::Description(fault) => RunError::Scene(scene.located(fault)),
        other => other.into(),
    })
}

/// Returns an error if the method `events` cannot follow the exact path of `model`, the model of `scene`.
///
/// # Errors
/// [`RunError::Scene`] if nodes slide in a plane, or friction changes in time.
pub fn expect_exact_path(scene: &Scene, model: &Model) -> Result<(), RunError> {
    let layout = Layout::new(&model.problem);
    let help = "use the method \"bn\"";
    if (0..layout.contacts()).any(|i| layout.slides_in_a_plane(i)) {
        let message = "the exact path requires nodes that slide along lines, as in two dimensions, but nodes of this \
                       scene slide in a plane";
        return Err(scene.error_at("solver.method", message, help).into());
    }
    if model.loading.friction().is_some() {
        let message = "the exact path requires constant friction, but that of this scene changes in time";
        return Err(scene.error_at("solver.method", message, help).into());
    }
    Ok(())
}

/// Returns the model of `scene`, or an error if the method cannot solve such a problem.
fn suitable(scene: &Scene, mut model: Model) -> Result<Model, RunError> {
    if scene.solver.method.is_exact_path() {
        expect_exact_path(scene, &model)?;
        if !model.loading.gap_corrections().is_empty() {
            let mut scene = scene.clone();
            scene.description.times = chords(&scene.description.times, &model.loading.kinks());
            model = model_of(&scene, None)?;
        }
    }
    if matches!(scene.solver.method, HistoryMethod::Increments(Method::PaperIp { .. }))
        && Layout::new(&model.problem).has_second_tangent()
    {
        let message = "this interior point method has only one tangent per node, but nodes of this scene slide in a \
         plane";
        let help = "remove solver.setting, or use the method \"bn\"";
        return Err(scene.error_at("solver.setting", message, help).into());
    }
    ProbeTable::all(&model, &scene.output.probes).map_err(|fault| scene.located(fault))?;
    Ok(model)
}
