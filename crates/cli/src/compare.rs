//! Compares methods, linear solvers, increments and meshes on one scene: error against time.
//!
//! Three errors are distinguished. The *algebraic* error is the error measure, iteration by iteration
//! ([`Course::iterates`]). The error of *time stepping* is the distance to a reference on the same mesh: the exact path
//! in time or many more increments ([`TimeErrors`]). The difference to half the increments is no substitute, because a
//! node that closes and sticks in the first half comes out the same with either. The error of the *mesh* is the
//! distance between such a reference and the one on the finest mesh ([`MeshErrors`]). Time is the CPU time of the one
//! thread that computes a history, which other programs on the machine disturb least. It is complete only if the BLAS
//! uses one thread ([`stickslip::algebra::linear::process`]).

mod answers;
mod cases;
mod cell;
mod convergence;
mod errors;
mod pareto;
mod picture;
mod table;
mod tractions;

use cases::Study;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::sync::{Mutex, PoisonError};
use stickslip::algebra::linear::process::Blas;
use stickslip::algebra::parallel_map;
use stickslip::base::UnitSystem;
use stickslip::run::report::Estimates;
use stickslip::scene::Scene;
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Status};

pub use crate::study::{ElementChoice, MeshChoice, MeshSize};
use crate::study::{StudyError, distinct, each, first_elements};
pub use answers::{Estimate, Lead};
pub(crate) use cell::CellFolder;
pub use cell::Cells;
pub use errors::{End, MeshErrors, TimeErrors};
pub use pareto::front;
pub use picture::charts;
pub use tractions::{Interior, TractionNode, Tractions};

/// A combination of method and linear solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverPath {
    /// The method with its constants.
    pub method: HistoryMethod,
    /// The linear solver; `None` for the one that suits the sizes of each mesh.
    pub linear: Option<LinearAlgebra>,
}

/// A plan of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The combinations of method and linear solver.
    pub paths: Vec<SolverPath>,
    /// The meshes, at least one.
    pub meshes: Vec<MeshChoice>,
    /// The numbers of increments of a whole history.
    pub increments: Vec<usize>,
    /// The increments of the reference, as a multiple of those of the finest history. The reference has a time-stepping
    /// error of its own, so the errors of the finest history may come out too small by up to the reciprocal of this
    /// number.
    pub reference: usize,
    /// The number of histories computed at a time, each in its own thread. Simultaneous histories share memory and
    /// caches: with two on two cores, times changed by 4 % at most.
    pub jobs: usize,
}

/// The times of a run by phase, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Phases {
    /// The CPU time of the whole run.
    pub cpu: f64,
    /// The wall time of the whole run.
    pub wall: f64,
    /// Mesh, `K`, contact maps and loads: wall time, measured once per mesh.
    pub model: f64,
    /// Symbolic analysis: wall time, as for the phases below.
    pub analysis: f64,
    /// Residuals, merits and Jacobian values.
    pub assembly: f64,
    /// Factorisations, including the one of the clamped body.
    pub factor: f64,
    /// Solves with refinement and backward error.
    pub solve: f64,
    /// Everything else.
    pub rest: f64,
}

/// One iteration of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Iterate {
    /// The number of the increment, from 1.
    pub increment: usize,
    /// The number of the iteration in the increment, over all attempts; 0 is the initial state.
    pub iteration: usize,
    /// CPU time since the last increment, s.
    pub seconds: f64,
    /// The merit `Theta`, in the unit of the setting.
    pub theta: f64,
    /// The error measure. The settings `paper` evaluate it at the end only.
    pub error: Option<f64>,
}

/// The course of a solved history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Course {
    /// The verdict.
    pub status: Status,
    /// The number of increments that converged.
    pub converged: usize,
    /// The number of linear systems solved by the method.
    pub iterations: usize,
    /// The number of numerical factorisations, including the one of the clamped body.
    pub factorizations: usize,
    /// The times by phase.
    pub seconds: Phases,
    /// The number of entries stored in the factors, or an upper bound.
    pub factor_entries: usize,
    /// The peak memory of a factorisation, bytes; 0 if the solver does not report it.
    pub factor_peak_bytes: f64,
    /// The largest error measure of any increment.
    pub kkt: f64,
    /// The iterations of the run.
    pub iterates: Vec<Iterate>,
}

/// A solved history.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The method and the linear solver.
    pub path: SolverPath,
    /// The mesh.
    pub mesh: MeshChoice,
    /// The requested number of increments.
    pub increments: usize,
    /// The course of its solution.
    pub course: Course,
    /// The distance to the reference; `None` if either did not converge.
    pub errors: Option<TimeErrors>,
}

/// A mesh and its reference: the exact path in time, or the default BN with many increments if that path is unknown or
/// ends early.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshResult {
    /// The mesh.
    pub mesh: MeshChoice,
    /// The number of displacements, n_u.
    pub displacements: usize,
    /// The number of contact nodes, n_c.
    pub contacts: usize,
    /// The increments of the reference; 0 for the exact path.
    pub increments: usize,
    /// The reason why increments are the reference, if they are.
    pub not_exact: &'static str,
    /// The verdict of the reference.
    pub status: Status,
    /// The CPU time of the reference, s.
    pub seconds: f64,
    /// The final state of the reference.
    pub end: End,
    /// The distance to the finest mesh; `None` for the finest mesh itself, or if either did not converge.
    pub errors: Option<MeshErrors>,
    /// The error estimates of the mesh alone, from the final state of the reference; `None` if it did not converge.
    pub estimates: Option<Estimates>,
}

/// All results of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The title of the scene.
    pub title: String,
    /// The units for output. The numbers here are SI.
    pub units: UnitSystem,
    /// The tolerated error of every law. Smaller differences between errors of runs are meaningless.
    pub tolerance: f64,
    /// The BLAS used for the runs, in a build with a BLAS.
    pub blas: Option<Blas>,
    /// The meshes, from coarse to fine.
    pub meshes: Vec<MeshResult>,
    /// The runs, mesh by mesh.
    pub runs: Vec<Trial>,
}

impl fmt::Display for SolverPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.method.name(), self.method.setting(), self.solver_name())
    }
}

impl SolverPath {
    /// Returns the name of the linear solver as in scenes, such as `auto`.
    pub fn solver_name(&self) -> String {
        self.linear.map_or("auto".to_string(), |linear| linear.to_string())
    }

    /// Returns `true` if the linear solver is named and does not condense.
    fn is_uncondensed(&self) -> bool {
        self.linear.is_some_and(|linear| !linear.condenses())
    }
}

impl Plan {
    /// Returns the number of histories to compute, including the references.
    pub fn histories(&self) -> usize {
        self.meshes.len() * (1 + self.paths.len() * self.increments.len())
    }

    /// Returns a plan for `paths` that takes seconds to minutes: meshes with an eighth, a quarter and half of the
    /// scene's elements in each direction, or the mesh of its file, and histories with a quarter, half and all of its
    /// increments.
    pub fn modest(scene: &Scene, paths: Vec<SolverPath>) -> Self {
        let shares = |whole: usize, parts: [usize; 3], least: usize| {
            let mut counts = parts.map(|part| (whole / part).max(least)).to_vec();
            counts.dedup();
            counts
        };
        Plan {
            paths,
            meshes: first_elements(&scene.description.mesh).map_or(vec![MeshSize::Own.into()], |whole| {
                shares(whole, [8, 4, 2], 2).into_iter().map(|n| MeshSize::Elements(n).into()).collect()
            }),
            increments: shares(scene.time.increments, [4, 2, 1], 1),
            reference: 8,
            jobs: 1,
        }
    }
}

/// Computes every history of `plan`, the references first, and reports each to `progress` before it starts. Results do
/// not depend on the number of histories computed at a time. Histories stored in `cells` are not computed again. Once
/// `stop` returns `true`, no further history is solved, and the comparison has those that are complete.
///
/// # Errors
/// When a mesh of the plan cannot be built or does not belong to this scene, or the linear algebra cannot go on.
pub fn compute(
    scene: &Scene,
    plan: &Plan,
    cells: &dyn Cells,
    progress: &mut (dyn FnMut(String) + Send),
    stop: fn() -> bool,
) -> Result<Comparison, StudyError> {
    let mut increments = plan.increments.clone();
    increments.sort_unstable();
    increments.dedup();
    let meshes = each(&scene.description.mesh, &plan.meshes)?;
    let reference = plan.reference * increments.last().copied().unwrap_or(1);
    let progress = Mutex::new(progress);
    let begins = |what: String| {
        let goes_on = !stop();
        if goes_on {
            progress.lock().unwrap_or_else(PoisonError::into_inner)(what);
        }
        goes_on
    };
    let studies = parallel_map(&meshes, plan.jobs, |mesh| {
        let begins = begins(format!("{mesh}, reference with {reference} increments"));
        begins.then(|| Study::new(scene, mesh.clone(), reference, &plan.paths, cells, stop)).transpose()
    })?;
    let is_complete = |study: &Study| study.result.status != Status::Interrupted;
    let studies: Vec<Study> = studies.into_iter().flatten().filter(is_complete).collect();
    let units = studies.last().map_or(scene.description.system(3), Study::units);
    let mut tasks = Vec::new();
    for study in &studies {
        tasks.extend(plan.paths.iter().flat_map(|&path| increments.iter().map(move |&number| (study, path, number))));
    }
    let runs = parallel_map(&tasks, plan.jobs, |&(study, path, increments)| {
        let begins = begins(format!("{}, {path}, {increments} increments", study.result.mesh));
        begins.then(|| study.run(path, increments, cells)).transpose()
    })?;
    let is_complete = |run: &Trial| run.course.status != Status::Interrupted;
    let mut runs: Vec<Trial> = runs.into_iter().flatten().filter(is_complete).collect();
    let mut results: Vec<MeshResult> = studies.into_iter().map(|study| study.result).collect();
    // The size of meshes from files is known only now. Among meshes with equally many displacements, the one named last
    // counts as the finer one.
    results.sort_by_key(|result| result.displacements);
    runs.sort_by_key(|run| results.iter().position(|result| result.mesh == run.mesh));
    if let Some((finest, coarser)) = results.split_last_mut() {
        let interior = coarser.first().map(|coarsest| coarsest.end.tractions.interior());
        for result in coarser {
            let both = result.status == Status::Converged && finest.status == Status::Converged;
            result.errors =
                interior.as_ref().filter(|_| both).map(|interior| MeshErrors::new(&result.end, &finest.end, interior));
        }
    }
    let tolerance = scene.solver.tolerance;
    Ok(Comparison { title: scene.title.clone(), units, tolerance, blas: Blas::loaded(), meshes: results, runs })
}

impl Comparison {
    /// Returns the runs on a mesh.
    pub fn on<'a>(&'a self, mesh: &'a MeshChoice) -> impl DoubleEndedIterator<Item = &'a Trial> {
        self.runs.iter().filter(move |run| run.mesh == *mesh)
    }

    /// Returns the runs on a mesh that no other run beats in both time and contact force error, the fastest first.
    pub fn front<'a>(&'a self, mesh: &'a MeshChoice) -> Vec<&'a Trial> {
        let points = |run| Some((run, Trial::point(run, |errors| errors.forces, self.tolerance)?));
        let (runs, points): (Vec<&Trial>, Vec<[f64; 2]>) = self.on(mesh).filter_map(points).unzip();
        front(&points).into_iter().map(|k| runs[k]).collect()
    }

    /// Returns the compared elements, in order.
    pub fn elements(&self) -> Vec<Option<ElementChoice>> {
        distinct(self.meshes.iter().map(|result| result.mesh.elements))
    }

    /// Returns the CPU time (s) of the history with most increments on a mesh, by the first combination that completed
    /// it.
    pub fn seconds(&self, mesh: &MeshChoice) -> Option<f64> {
        let solved = self.on(mesh).filter(|run| run.course.status == Status::Converged);
        // `rev` makes the first of the longest runs the last maximum, which `max_by_key` returns.
        let most = solved.rev().max_by_key(|run| run.increments)?;
        Some(most.course.seconds.cpu)
    }

    /// Returns the compared combinations of method and linear solver, in order.
    pub fn paths(&self) -> Vec<SolverPath> {
        distinct(self.runs.iter().map(|run| run.path))
    }
}

impl Trial {
    /// Returns the CPU time (s) and one of the errors, at least `floor`. `None` if the error is unknown.
    pub fn point(&self, error: fn(&TimeErrors) -> f64, floor: f64) -> Option<[f64; 2]> {
        let error = error(self.errors.as_ref()?);
        error.is_finite().then(|| [self.course.seconds.cpu, error.max(floor)])
    }
}
