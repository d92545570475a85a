//! Which models have a stiffness that the ranks of MPI share: those that multigrid solves.

use super::RunError;
use super::need::Need;
use crate::history::LinearAlgebra;
use crate::memory::Budget;
use crate::model::Model;
#[cfg(feature = "petsc")]
use crate::model::ModelError;
use crate::scene::Scene;

/// How many processes share the stiffness of `scene`.
#[cfg(feature = "petsc")]
pub(super) fn ranks(scene: &Scene) -> usize {
    use crate::history::Method;
    use crate::linear::ranks;

    match (scene.solver.linear, scene.solver.method) {
        (_, Method::Events { .. }) => 1,
        (Some(LinearAlgebra::Multigrid), _) => ranks::count(),
        _ => 1,
    }
}

#[cfg(not(feature = "petsc"))]
pub(super) fn ranks(_scene: &Scene) -> usize {
    1
}

/// The model of `scene`, whose stiffness so many `ranks` share, if it is of a kind that they can.
#[cfg(feature = "petsc")]
pub(super) fn model(scene: &Scene, ranks: usize) -> Result<Model, RunError> {
    use crate::linear::share;

    let model = if ranks == 1 { Model::new(scene) } else { Model::shared(scene, &share) };
    model.map_err(|error| match error {
        ModelError::Linear(error) => error.into(),
        other => other.into(),
    })
}

#[cfg(not(feature = "petsc"))]
pub(super) fn model(scene: &Scene, _ranks: usize) -> Result<Model, RunError> {
    Ok(Model::new(scene)?)
}

/// [`Need::check`] of a model whose stiffness nobody shares; what a rank takes of a shared one is known when it is there.
pub(super) fn check(model: &Model, linear: LinearAlgebra, budget: Option<Budget>) -> Result<(), RunError> {
    match model.problem.stiffness().shared() {
        Some(_) => Ok(()),
        None => Need::check(model, linear, budget),
    }
}
