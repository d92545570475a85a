//! Lists the time and the memory of a run by each linear solver.

use stickslip::algebra::linear::rank_count;
use stickslip::base::{Budget, in_words};
use stickslip::body::Model;
use stickslip::run::{AvailableSolvers, Choice, MemoryEstimate, RunError, unsuited};
use stickslip::scene::Scene;
use stickslip::solver::InitialWorkingSet;
use stickslip::solver::history::LinearAlgebra;

/// Lists the memory of the run of `scene`, the estimates of all linear solvers, and the size above which each needs too
/// much memory.
pub(super) fn paths(scene: &Scene, model: &Model, budget: Option<Budget>) -> Result<Vec<String>, RunError> {
    let (method, increments) = (scene.solver.method, model.times().len());
    let unsuited = unsuited(model, method);
    let ranks = rank_count();
    let has = AvailableSolvers { available: budget.map(|budget| budget.bytes), multigrid: unsuited.is_none(), ranks };
    let choice = Choice::cheapest(&model.problem, &InitialWorkingSet::default(), method, increments, has)?;
    let linear = scene.solver.linear.unwrap_or(choice.linear);
    let need = match choice.paths().iter().find(|path| path.linear == linear) {
        Some(path) => MemoryEstimate::of_path(model, path),
        None => MemoryEstimate::of(model, linear, 0)?,
    };
    let need = need.bytes();
    let of = budget.map_or(String::new(), |Budget { bytes, source }| {
        let enough = if need > bytes { "; this is hardly enough" } else { "" };
        format!(" of {} that {source} leaves{enough}", in_words(bytes))
    });
    let assumed = format!("{:.0} factorisations", choice.paths().first().map_or(0.0, |path| path.factorizations));
    let of_memory = budget.map_or("", |_| "  out of memory from");
    let mut lines = vec![
        format!("memory       about {}{of}", in_words(need)),
        format!("estimated    {assumed:<18} {:>9} {:>9}{of_memory}", "time", "memory"),
    ];
    for path in choice.paths() {
        let need = MemoryEstimate::of_path(model, path);
        let out = budget.map_or(String::new(), |Budget { bytes, .. }| {
            format!("  {:.1e} displacements on", need.most_displacements(model, path.linear, bytes))
        });
        let chosen = if path.linear == choice.linear { ", \"auto\"" } else { "" };
        let name = format!("{}{chosen}", path.linear);
        lines.push(format!("             {name:<18} {:>7.2} s {:>9}{out}", path.cost.seconds, in_words(need.bytes())));
    }
    if ranks > 1 {
        lines.push(format!(
            "             by {ranks} processes; the memory is that of the first one, and each needs its own"
        ));
    }
    if let (Some(why), true) = (unsuited, LinearAlgebra::Multigrid.is_built_in()) {
        lines.push(format!("             \"auto\" does not consider multigrid: {why}"));
        if scene.solver.linear == Some(LinearAlgebra::Multigrid) {
            lines.push("             a direct solver may have to take over, with its own time and memory".to_string());
        }
    }
    Ok(lines)
}
