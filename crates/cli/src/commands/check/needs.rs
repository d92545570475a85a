//! Tells the linear solver of a run, and the memory that it needs.

use stickslip::algebra::linear::rank_count;
use stickslip::base::{Budget, in_words};
use stickslip::body::Model;
use stickslip::run::{AvailableSolvers, Choice, MemoryEstimate, RunError, unsuited};
use stickslip::scene::Scene;
use stickslip::solver::InitialWorkingSet;
use stickslip::solver::history::LinearAlgebra;

/// Returns lines with the linear solver that `scene` leaves open, and the memory of its run.
pub(super) fn needs(scene: &Scene, model: &Model, budget: Option<Budget>) -> Result<Vec<String>, RunError> {
    let unsuited = unsuited(model, scene.solver.method);
    let ranks = rank_count();
    let has = AvailableSolvers { available: budget.map(|budget| budget.bytes), multigrid: unsuited.is_none(), ranks };
    let choice = match scene.solver.linear {
        Some(linear) => Choice::named(linear),
        None => Choice::by_size(&model.problem, &InitialWorkingSet::default(), has)?,
    };
    let need = MemoryEstimate::of(model, choice.linear, 0)?.bytes();
    let of = budget.map_or(String::new(), |Budget { bytes, source }| {
        let enough = if need > bytes { "; this is hardly enough" } else { "" };
        format!(" of {} that {source} leaves{enough}", in_words(bytes))
    });
    let by = if ranks > 1 { format!(" for the first of {ranks} processes") } else { String::new() };
    let mut lines: Vec<String> = choice.reason.iter().map(|reason| format!("             {reason}")).collect();
    lines.push(format!("memory       about {}{by}{of}", in_words(need)));
    if let (Some(why), LinearAlgebra::Multigrid) = (unsuited, choice.linear) {
        lines.push(format!("             multigrid may give way to a direct solver, which needs more: {why}"));
    }
    Ok(lines)
}
