//! Refines mesh and increments of a scene until a quantity is known to an asked share, its relative tolerance.
//!
//! Each run refines either the mesh or the increments, whichever error is larger. The change of the value by a run
//! counts for what was refined. The errors of mesh and increments follow from these changes ([`limit`]), and their sum
//! is the error of the last run.
//!
//! Meshes of triangles or tetrahedra refine themselves where the errors of the stresses are large ([`Refinement`]); all
//! elements of others become smaller.

mod extrapolation;
mod format;
mod ladder;
mod picture;
mod quantity;
mod steps;

use std::ops::ControlFlow;
use std::time::Instant;

use serde::Serialize;

use crate::study::{MeshSize, Places, StudyError, TableQuantity};
use stickslip::body::ModelError;
use stickslip::body::mesh::{Mesh, MeshSource};
use stickslip::run::report::RunReport;
use stickslip::run::{Refinement, Run, RunError};
use stickslip::scene::Scene;
use stickslip::solver::IterationRecord;
use stickslip::solver::history::{Observer, Status};

pub use extrapolation::{Behaviour, Limit, is_singular, limit};
pub use ladder::Ladder;
pub use steps::{Errors, Limits, Step, StudyResult};

/// The number of meshes finer than the scene's on which contact or slip may be seen first.
const FINER: usize = 2;

/// A plan of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The quantity.
    pub sought: TableQuantity,
    /// The meshes, from coarse to fine; empty for those of the scene, refined by `ratio`.
    pub meshes: Vec<MeshSize>,
    /// The factor of the numbers of elements along each axis from mesh to mesh; a mesh that refines itself grows as if
    /// all its elements became smaller by it.
    pub ratio: f64,
    /// The share to which the quantity is to be known, and the limits.
    pub limits: Limits,
}

/// The end of a study.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The quantity is known to the asked share.
    Known,
    /// It would be known, but the last run has a warning that is never to be ignored.
    Warned,
    /// The pressure grows without a limit.
    Singular,
    /// A run did not converge.
    NotConverged,
    /// The user stopped the study.
    Interrupted,
    /// The limit of runs was reached.
    RunLimit,
    /// The last run exceeded the limit of time, or the next run would.
    TimeLimit,
    /// There is no finer mesh.
    NoFinerMesh,
    /// The next mesh needs more memory than there is.
    MemoryLimit,
}

/// The result of a study. Numbers are SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Convergence {
    /// The quantity.
    pub sought: TableQuantity,
    /// The share to which it was to be known.
    pub to: f64,
    /// The number of increments of the scene.
    pub own_increments: usize,
    /// The steps of the study and its end.
    pub result: StudyResult,
    /// The report of the last run.
    pub last: RunReport,
    /// The last mesh, if meshes refined themselves.
    pub mesh: Option<MeshSource>,
}

/// Refines `scene` as planned, and reports each run to `progress` before it starts. `observer` sees all runs, and may
/// stop them.
///
/// # Errors
/// When the scene has no such quantity or no finer meshes, or the first run ends without a report.
pub fn compute(
    scene: &Scene,
    plan: &Plan,
    progress: &mut dyn FnMut(String),
    observer: &mut dyn Observer,
) -> Result<Convergence, StudyError> {
    let ladder = Ladder::new(scene, &plan.meshes, plan.ratio)?;
    read_named(&ladder, scene)?;
    let mut places = Places::default();
    places.add(&scene.description);
    let sought = plan.sought.at(&places, true).map_err(StudyError::Quantity)?;
    let mut last = None;
    let mut meshes = Meshes::new(scene, &ladder)?;
    let mut deadline = Deadline { observer, start: Instant::now(), within: plan.limits.within, is_over: false };
    let mut result = steps::refine(&ladder, plan.limits, sought.is_peak(), &mut |steps, mesh, increments| {
        let (run, report) = solve(&mut meshes, &sought, (mesh, increments), steps, progress, &mut deadline)?;
        if report.status != Status::Interrupted || last.is_none() {
            last = Some(report);
        }
        Ok(run)
    })?;
    if deadline.is_over && result.verdict == Verdict::Interrupted {
        result.verdict = Verdict::TimeLimit;
    }
    let last = last.ok_or(StudyError::NoFinerMesh)?;
    let mesh = meshes.refined.map(|(refinement, ..)| refinement.scene().description.mesh.clone());
    Ok(Convergence { sought, to: plan.limits.to, own_increments: scene.time.increments, result, last, mesh })
}

/// An observer that stops a run when the time of the study is over.
struct Deadline<'a> {
    observer: &'a mut dyn Observer,
    start: Instant,
    within: f64,
    is_over: bool,
}

impl Observer for Deadline<'_> {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.is_over |= self.start.elapsed().as_secs_f64() > self.within;
        if self.is_over { ControlFlow::Break(()) } else { self.observer.iteration(index, record) }
    }
}

/// Reads the meshes that are named, so that none is found to be wrong after the runs with the coarser ones.
fn read_named(ladder: &Ladder, own: &Scene) -> Result<(), StudyError> {
    let mut before = f64::INFINITY;
    for level in 0..ladder.meshes().unwrap_or(0) {
        let scene = own.with(&ladder.mesh(own, level)).map_err(RunError::from)?;
        let source = &scene.description.mesh;
        let mesh = source.build().map_err(|error| RunError::from(ModelError::from(error)))?;
        let size = size(&mesh);
        if size >= before {
            return Err(StudyError::NotFiner { mesh: ladder::name(source), elements: mesh.cells.len() });
        }
        before = size;
    }
    Ok(())
}

/// Returns the size of elements that are all equal, relative to the body, where one of second order counts as those of
/// first order with its nodes.
fn size(mesh: &Mesh) -> f64 {
    let quadratic = mesh.cells.iter().any(|cell| cell.kind.is_quadratic());
    (mesh.cells.len() as f64).powf(-1.0 / mesh.dimension as f64) * if quadratic { 0.5 } else { 1.0 }
}

/// The scene of a study on its meshes.
struct Meshes<'a> {
    own: &'a Scene,
    ladder: &'a Ladder,
    /// The meshes that refine themselves, if they do: the last one, its level, and the value of `mesh.refine` that
    /// leads to it.
    refined: Option<(Refinement, usize, f64)>,
}

impl<'a> Meshes<'a> {
    fn new(own: &'a Scene, ladder: &'a Ladder) -> Result<Self, StudyError> {
        let mut first = ladder.mesh(own, 0);
        first.push(ladder.time(0));
        let first = own.with(&first).map_err(RunError::from)?;
        let refinement = ladder.refines_itself.then(|| Refinement::new(&first)).transpose()?;
        Ok(Meshes { own, ladder, refined: refinement.map(|refinement| (refinement, 0, 0.0)) })
    }

    /// Returns the scene on these levels of mesh and increments, and the name of the mesh.
    fn scene(
        &mut self,
        mesh: usize,
        increments: usize,
        observer: &mut dyn Observer,
    ) -> Result<(Scene, String), StudyError> {
        let mut overrides = self.ladder.mesh(self.own, mesh);
        overrides.push(self.ladder.time(increments));
        let mut scene = self.own.with(&overrides).map_err(RunError::from)?;
        // The study alone refines: `mesh.refine` would give all its meshes one error.
        scene.refine = None;
        let mut name = ladder::name(&scene.description.mesh);
        if let Some((refinement, level, error)) = &mut self.refined {
            while *level < mesh {
                let finer = refinement.finer(self.ladder.gain, observer)?;
                *error = finer.ok_or_else(|| StudyError::NotRefined(refinement.status()))?;
                *level += 1;
            }
            scene.description.mesh = refinement.scene().description.mesh.clone();
            if mesh > 0 {
                let first = if self.ladder.is_own(0, &self.own.description.mesh) { String::new() } else { name + ", " };
                name = if *error > 0.0 { format!("{first}refine = {error}") } else { format!("{first}divided") };
            }
        }
        Ok((scene, name))
    }
}

/// Solves the scene on these levels of mesh and increments, after the `steps`.
fn solve(
    meshes: &mut Meshes<'_>,
    sought: &TableQuantity,
    (mesh, increments): (usize, usize),
    steps: &[Step],
    progress: &mut dyn FnMut(String),
    observer: &mut dyn Observer,
) -> Result<(Step, RunReport), StudyError> {
    let start = Instant::now();
    let (scene, name) = meshes.scene(mesh, increments, observer)?;
    let Meshes { own, ladder, .. } = *meshes;
    let number = ladder.increments(increments);
    progress(format!("mesh {name}, {number} increments"));
    let run = Run::new(&scene)?;
    let model = run.model();
    let (elements, dimension) = (model.mesh.cells.len(), model.mesh.dimension);
    // In the plane a mesh that refines itself needs few elements for an error, which is that of smaller ones; in space it
    // needs many along edges and rims.
    let size =
        if ladder.refines_itself && dimension == 2 { ladder.gain.powi(-(mesh as i32)) } else { size(&model.mesh) };
    if steps.last().is_some_and(|step| step.level < mesh && step.size <= size) {
        return Err(StudyError::NotFiner { mesh: name, elements });
    }
    let follows_path = model.problem.mu().iter().any(|mu| *mu > 0.0) && !scene.solver.method.is_exact_path();
    let report = run.solve(observer)?;
    // Serialising never fails with these types.
    let json = serde_json::to_value(&report).unwrap_or_default();
    let value = sought.of(&json).as_f64();
    let reason = Some(&report.explanation.reason).filter(|reason| !reason.is_empty());
    let reason = reason.cloned().unwrap_or_else(|| report.status.to_string());
    let failure = match report.status {
        Status::Converged => None,
        // The capacity of a joint is known by the run in which it slips.
        Status::Slips if value.is_some() && ["slip", "friction_use"].contains(&sought.root()) => None,
        Status::Interrupted => Some((Verdict::Interrupted, reason)),
        _ => Some((Verdict::NotConverged, reason)),
    };
    // Narrow zones of tetrahedra have no peak, and on coarse meshes all nodes may stick.
    let may_slip = follows_path && sought.word() == "friction_work";
    let finer = if may_slip || report.largest_force.is_none() { FINER } else { 0 };
    let may_come =
        ladder.is_coarse(mesh.saturating_sub(finer)) || (sought.is_peak() && report.largest_pressure.is_some());
    if failure.is_none() && value.is_none() && !may_come {
        return Err(StudyError::NoValue { sought: sought.name(), known: quantity::words_of(&json) });
    }
    let rounding = value.map_or([0.0; 2], |value| sought.rounding(value, &report, &json));
    let solved = Step {
        level: mesh,
        mesh: name,
        is_own_mesh: ladder.is_own(mesh, &own.description.mesh),
        elements,
        size,
        dimension,
        increments: number,
        value: value.filter(|_| failure.is_none()),
        rounding,
        is_resolved: sought.is_resolved(&report),
        doubt: if sought.is_peak() && report.largest_pressure.as_ref().is_some_and(|largest| largest.singular) {
            Some(Verdict::Singular)
        } else {
            report.warnings.iter().any(|warning| warning.kind.is_grave()).then_some(Verdict::Warned)
        },
        follows_path: follows_path || rounding[1] > 0.0,
        failure,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((solved, report))
}
