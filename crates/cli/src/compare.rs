//! Methods, linear algebra, increments and meshes compared on one scene: how small an error in how
//! much time.
//!
//! Three errors are kept apart. The *algebraic* one is the error measure, iteration by iteration
//! ([`Trial::iterates`]). That of *time stepping* is the distance to a reference on the same mesh, the exact path in time or many
//! more increments ([`TimeErrors`]); the difference to half the increments does not serve, for a node that
//! closes and sticks in the first half comes out the same with either. That of the *mesh* is the
//! distance of such a reference to that on the finest mesh ([`MeshErrors`]). Time is CPU time of the thread that a history
//! has for itself, which the other programs of a machine disturb least; it is whole if the BLAS has been told to take one thread
//! ([`stickslip::algebra::linear::process`]).

mod answers;
mod cases;
mod cell;
mod convergence;
mod errors;
mod mesh;
mod pareto;
mod picture;
mod tractions;

use std::fmt;
use std::sync::{Mutex, PoisonError};

pub use answers::{Estimate, Lead};
pub use cell::Cells;
pub use errors::{End, MeshErrors, TimeErrors};
pub use mesh::{ElementChoice, MeshChoice, MeshSize};
pub use pareto::front;
pub use picture::charts;
pub use tractions::{Interior, TractionNode, Tractions};

use serde::{Deserialize, Serialize};

use cases::Study;
use mesh::first_elements;

use stickslip::algebra::jobs;
use stickslip::algebra::linear::blas::Blas;
use stickslip::base::units::UnitSystem;
use stickslip::run::RunError;
use stickslip::run::report::Estimates;
use stickslip::scene::Scene;
use stickslip::solver::history::{LinearAlgebra, Method, Status};

/// A way to solve a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverPath {
    /// The algorithm with its constants.
    pub method: Method,
    /// The linear algebra.
    pub linear: LinearAlgebra,
}

/// What to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The ways to solve the scene.
    pub paths: Vec<SolverPath>,
    /// The meshes, at least one.
    pub meshes: Vec<MeshChoice>,
    /// Increments of a whole history.
    pub increments: Vec<usize>,
    /// The reference has so many times the increments of the finest history. It carries the error of its
    /// own increments, so that those of the finest history are told up to this share too small.
    pub reference: usize,
    /// How many histories are computed at a time, each in a thread of its own. Those side by side share memory and caches: of two on
    /// two cores times moved by 4 % at most.
    pub jobs: usize,
}

/// Where the time of a run went, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Phases {
    /// Mesh, `K`, contact maps and loads: wall time, measured once a mesh.
    pub model: f64,
    /// Symbolic analysis: wall time, as the following.
    pub analysis: f64,
    /// Residuals, merits and Jacobian values.
    pub assembly: f64,
    /// Factorisations, that of the held body included.
    pub factorization: f64,
    /// Solves with refinement and backward error.
    pub solve: f64,
    /// The time of everything else.
    pub rest: f64,
    /// The wall time of the whole run.
    pub wall: f64,
    /// The CPU time of the whole run.
    pub cpu: f64,
}

/// One iteration of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Iterate {
    /// The increment, from 1.
    pub increment: usize,
    /// The number of the iteration in the increment, over all attempts; 0 is the start.
    pub iteration: usize,
    /// CPU time since the last increment, s.
    pub seconds: f64,
    /// The merit `Theta`, in the unit of the setting.
    pub theta: f64,
    /// The error measure. The settings `paper` do not evaluate it; there it is known at the end only.
    pub error: Option<f64>,
}

/// A history, solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The way it was solved.
    pub path: SolverPath,
    /// The mesh.
    pub mesh: MeshChoice,
    /// The number of increments asked for.
    pub increments: usize,
    /// The verdict.
    pub status: Status,
    /// The increments that converged.
    pub converged: usize,
    /// Linear systems solved by the method.
    pub iterations: usize,
    /// Numerical factorisations, that of the held body included.
    pub factorizations: usize,
    /// Where the time went.
    pub seconds: Phases,
    /// Entries stored in the factors, or a bound of them.
    pub factor_entries: usize,
    /// Peak memory of a factorisation, bytes; 0 if the solver does not tell.
    pub factor_peak_bytes: f64,
    /// The largest error measure of any increment.
    pub kkt: f64,
    /// The distance to the reference; none if either did not converge.
    pub errors: Option<TimeErrors>,
    /// The iterations of the run.
    pub iterates: Vec<Iterate>,
}

/// A mesh and its reference: the exact path in time, or where that is not known, or is lost, the default BN with many increments.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshResult {
    /// Which it is.
    pub mesh: MeshChoice,
    /// n_u.
    pub displacements: usize,
    /// n_c.
    pub contacts: usize,
    /// The increments of the reference; 0 where that is the exact path.
    pub increments: usize,
    /// The verdict of the reference.
    pub status: Status,
    /// The CPU time of the reference, s.
    pub seconds: f64,
    /// The end of the reference.
    pub end: End,
    /// The distance to the finest mesh; none on that itself, or if either did not converge.
    pub errors: Option<MeshErrors>,
    /// What the end of the reference tells of the mesh by itself; none if it did not converge.
    pub estimates: Option<Estimates>,
}

/// Everything about a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The scene's title.
    pub title: String,
    /// The units in which it is told; the numbers here are SI.
    pub units: UnitSystem,
    /// The error that every law may have; no error of a run means anything below it.
    pub tolerance: f64,
    /// The BLAS behind the times, in a build that has one.
    pub blas: Option<Blas>,
    /// The meshes, from coarse to fine.
    pub meshes: Vec<MeshResult>,
    /// The runs, mesh by mesh.
    pub runs: Vec<Trial>,
}

/// Why scenes could not be compared.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum CompareError {
    /// Meshes were asked for that only the scene could make.
    #[error("the mesh of the scene comes from a file, so it has no numbers of elements to change")]
    #[diagnostic(help("name mesh files (--meshes coarse.msh,fine.msh), or leave the meshes out"))]
    FixedMesh,
    /// Cells were asked for that the mesh of the scene does not leave open.
    #[error("the cells of the scene's mesh are what they are")]
    #[diagnostic(help(
        "other cells need a scene with mesh.kind = \"block\"; strains alone (--elements bilinear,b-bar) go with every mesh"
    ))]
    FixedCells,
    /// Mesh files were named for a scene that makes its mesh itself.
    #[error("the scene makes its mesh itself, so it takes no mesh file")]
    #[diagnostic(help("give numbers of elements (--meshes 20,40), or a scene with mesh.kind = \"gmsh\""))]
    NoMeshFile,
    /// There is no mesh to compare on.
    #[error("the plan has no meshes")]
    #[diagnostic(help("name one at least"))]
    NoMesh,
    /// A mesh of the plan could not be built, or a run ended without a report.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

impl fmt::Display for SolverPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}, {}", self.method.name(), self.method.setting(), self.linear)
    }
}

impl Plan {
    /// How many histories are computed, the references included.
    pub fn histories(&self) -> usize {
        self.meshes.len() * (1 + self.paths.len() * self.increments.len())
    }

    /// A plan for `paths` that takes seconds to minutes: meshes with an eighth, a quarter and half of the scene's
    /// elements in each direction, or the one from its file, histories with a quarter, half and all of its increments.
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

/// Computes every history of `plan`, the references first, and tells `progress` before each what it is. Results do not depend on how
/// many are computed at a time. Those that `cells` have are not computed again.
///
/// # Errors
/// When a mesh of the plan cannot be built or is none of this scene's, or the linear algebra cannot go on.
pub fn compute(
    scene: &Scene,
    plan: &Plan,
    cells: &dyn Cells,
    progress: &mut (dyn FnMut(String) + Send),
) -> Result<Comparison, CompareError> {
    let mut increments = plan.increments.clone();
    increments.sort_unstable();
    increments.dedup();
    let meshes = mesh::each(&scene.description.mesh, &plan.meshes)?;
    let reference = plan.reference * increments.last().copied().unwrap_or(1);
    let progress = Mutex::new(progress);
    let tell = |what: String| progress.lock().unwrap_or_else(PoisonError::into_inner)(what);
    let studies = jobs::run(&meshes, plan.jobs, |mesh| {
        tell(format!("{mesh}, reference with {reference} increments"));
        Study::new(scene, mesh.clone(), reference, cells)
    })?;
    let units = studies.last().map_or(scene.description.system(3), Study::units);
    let mut tasks = Vec::new();
    for study in &studies {
        tasks.extend(plan.paths.iter().flat_map(|&path| increments.iter().map(move |&number| (study, path, number))));
    }
    let trials = jobs::run(&tasks, plan.jobs, |&(study, path, increments)| {
        tell(format!("{}, {path}, {increments} increments", study.mesh()));
        study.run(path, increments, cells)
    })?;
    let each = plan.paths.len() * increments.len();
    let mut trials = trials.into_iter();
    let mut studied: Vec<(MeshResult, Vec<Trial>)> =
        studies.into_iter().map(|study| (study.result(), trials.by_ref().take(each).collect())).collect();
    // Only now it is known how fine those from files are. Of meshes with as many displacements that which is named last counts
    // as the finer one.
    studied.sort_by_key(|(result, _)| result.displacements);
    let (mut results, runs): (Vec<MeshResult>, Vec<Vec<Trial>>) = studied.into_iter().unzip();
    let runs = runs.concat();
    if let Some((finest, coarser)) = results.split_last_mut() {
        let interior = coarser.first().map(|coarsest| coarsest.end.tractions.interior());
        for result in coarser {
            let sound = result.status == Status::Converged && finest.status == Status::Converged;
            result.errors =
                interior.as_ref().filter(|_| sound).map(|interior| MeshErrors::new(&result.end, &finest.end, interior));
        }
    }
    let tolerance = scene.solver.tolerance;
    Ok(Comparison { title: scene.title.clone(), units, tolerance, blas: Blas::loaded(), meshes: results, runs })
}

impl Comparison {
    /// The runs on a mesh.
    pub fn on<'a>(&'a self, mesh: &'a MeshChoice) -> impl DoubleEndedIterator<Item = &'a Trial> {
        self.runs.iter().filter(move |run| run.mesh == *mesh)
    }

    /// The runs on a mesh that no other beats in time and error in the contact forces, the cheapest first.
    pub fn front<'a>(&'a self, mesh: &'a MeshChoice) -> Vec<&'a Trial> {
        let points = |run| Some((run, Trial::point(run, |errors| errors.forces, self.tolerance)?));
        let (runs, points): (Vec<&Trial>, Vec<[f64; 2]>) = self.on(mesh).filter_map(points).unzip();
        front(&points).into_iter().map(|k| runs[k]).collect()
    }

    /// The elements that were compared, in order.
    pub fn elements(&self) -> Vec<Option<ElementChoice>> {
        let mut elements = Vec::new();
        for result in &self.meshes {
            if !elements.contains(&result.mesh.elements) {
                elements.push(result.mesh.elements);
            }
        }
        elements
    }

    /// The CPU time (s) of the history with most increments on a mesh, by the first of the ways that got through.
    pub fn seconds(&self, mesh: &MeshChoice) -> Option<f64> {
        let solved = self.on(mesh).filter(|run| run.status == Status::Converged);
        // Of several the last is taken, which is the first of the runs.
        let most = solved.rev().max_by_key(|run| run.increments)?;
        Some(most.seconds.cpu)
    }

    /// The ways that were compared, in order.
    pub fn paths(&self) -> Vec<SolverPath> {
        let mut paths = Vec::new();
        for run in &self.runs {
            if !paths.contains(&run.path) {
                paths.push(run.path);
            }
        }
        paths
    }
}

impl Trial {
    /// CPU time (s) and one of the errors, at least `floor`; none if the error is not known.
    pub fn point(&self, error: fn(&TimeErrors) -> f64, floor: f64) -> Option<[f64; 2]> {
        let error = error(self.errors.as_ref()?);
        error.is_finite().then(|| [self.seconds.cpu, error.max(floor)])
    }
}
