//! Refines mesh and increments of a scene until a quantity is known to an asked share.
//!
//! Each run refines either the mesh or the increments, whichever error is larger. The change of the value by a run counts
//! for what was refined. The errors of mesh and increments follow from these changes ([`limit`]), and their sum is the
//! error of the last run.

mod extrapolation;
mod ladder;
mod picture;
mod quantity;
mod steps;
mod told;

use std::time::Instant;

use serde::Serialize;

use crate::compare::{CompareError, MeshSize};
use ladder::Numbers;
use steps::{Ended, Limits, Own, Solved};
use stickslip::base::UnitSystem;
use stickslip::run::report::{LargestPressure, RunReport, Warning};
use stickslip::run::{Run, RunError};
use stickslip::scene::{Override, Scene};
use stickslip::solver::history::{Observer, Status};

pub use extrapolation::{Behaviour, Limit, is_singular, limit};
pub use ladder::Ladder;
pub use quantity::Sought;
pub use steps::{Errors, Step};
pub use told::Told;

/// A plan of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The quantity.
    pub sought: Sought,
    /// The share to which it is to be known.
    pub to: f64,
    /// The meshes, from coarse to fine; empty for those of the scene, refined by `ratio`.
    pub meshes: Vec<MeshSize>,
    /// The factor of the numbers of elements along each axis from mesh to mesh.
    pub ratio: f64,
    /// The largest number of runs.
    pub most_runs: usize,
    /// The largest time of the whole study, s.
    pub within: f64,
}

/// The end of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
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
    /// The limit of runs was reached.
    RunLimit,
    /// The next run would exceed the limit of time.
    TimeLimit,
    /// There is no finer mesh.
    NoFinerMesh,
    /// The next mesh needs more memory than there is.
    MemoryLimit,
}

/// The result of a study. Numbers are SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Convergence {
    /// The title of the scene.
    pub title: String,
    /// The scene file.
    pub scene: String,
    /// The units for output.
    pub units: UnitSystem,
    /// The quantity.
    pub sought: Sought,
    /// The share to which it was to be known.
    pub to: f64,
    /// The verdict.
    pub verdict: Verdict,
    /// The reason why a run or the study ended early; empty otherwise.
    pub reason: String,
    /// The runs, in order.
    pub steps: Vec<Step>,
    /// The estimated errors of the last run; `None` for fewer than two runs.
    pub errors: Option<Errors>,
    /// The largest pressure of the last run, if the quantity is the peak.
    pub peak: Option<LargestPressure>,
    /// The predicted time of the next run, s, if it is the reason for the end.
    pub predicted: Option<f64>,
    /// The warnings of the last run.
    pub warnings: Vec<Warning>,
}

/// The reason why a study is impossible.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum ConvergeError {
    /// The mesh of the scene comes from a file, and no finer one is named.
    #[error("the mesh of the scene comes from a file, and no finer meshes are named")]
    #[diagnostic(help("name mesh files from coarse to fine (--meshes coarse.msh,fine.msh)"))]
    NoFinerMesh,
    /// The meshes do not become finer.
    #[error("mesh {mesh} has {elements} elements and is no finer than the one before")]
    #[diagnostic(help(
        "name meshes from coarse to fine; an element of second order counts as four, in space as eight"
    ))]
    NotFiner {
        /// The mesh.
        mesh: String,
        /// Its number of elements.
        elements: usize,
    },
    /// The scene has no such quantity.
    #[error("the scene has no {sought}")]
    #[diagnostic(help("{}", if known.is_empty() { "nothing touches: correct the scene".to_string() } else { format!("ask for {}", known.join(", ")) }))]
    NoValue {
        /// The quantity.
        sought: Sought,
        /// The quantities that the scene has.
        known: Vec<&'static str>,
    },
    /// A mesh of the plan cannot be taken for this scene.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Mesh(#[from] CompareError),
    /// A run ended without a report.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

/// Refines `scene` as planned, and reports each run to `progress` before it starts. `observer` sees all runs, and may stop them.
///
/// # Errors
/// When the scene has no such quantity or no finer meshes, or the first run ends without a report.
pub fn compute(
    scene: &Scene,
    plan: &Plan,
    progress: &mut dyn FnMut(String),
    observer: &mut dyn Observer,
) -> Result<Convergence, ConvergeError> {
    let ladder = Ladder::new(scene, &plan.meshes, plan.ratio)?;
    let mut study =
        Study { scene, sought: plan.sought, ladder: &ladder, last: None, fineness: None, progress, observer };
    let limits = Limits { to: plan.to, most_runs: plan.most_runs, within: plan.within };
    let Ended { verdict, reason, steps, errors, predicted } =
        steps::refine(&ladder, limits, plan.sought == Sought::Peak, &mut |mesh, increments| {
            study.run(mesh, increments)
        })?;
    let units = study.last.as_ref().map_or(scene.description.system(3), |report| report.units);
    let warnings = study.last.as_ref().map_or(Vec::new(), |report| report.warnings.clone());
    let peak = study.last.and_then(|report| report.largest_pressure).filter(|_| plan.sought == Sought::Peak);
    Ok(Convergence {
        title: scene.title.clone(),
        scene: scene.file().to_string(),
        units,
        sought: plan.sought,
        to: plan.to,
        verdict,
        reason,
        steps,
        errors,
        peak,
        predicted,
        warnings,
    })
}

/// A study under way.
struct Study<'a> {
    scene: &'a Scene,
    sought: Sought,
    ladder: &'a Ladder,
    /// The report of the last run.
    last: Option<RunReport>,
    /// The mesh level and the fineness of the last run.
    fineness: Option<(usize, f64)>,
    progress: &'a mut dyn FnMut(String),
    observer: &'a mut dyn Observer,
}

impl Study<'_> {
    /// Solves the scene on these levels of mesh and increments.
    fn run(&mut self, mesh: usize, increments: usize) -> Result<Solved, ConvergeError> {
        let Study { scene, sought, ladder, .. } = *self;
        let number = ladder.increments(increments);
        let mut overrides = ladder.mesh(scene, mesh);
        overrides.push(Override::value("time.increments", number as i64));
        let scene = scene.with(&overrides).map_err(RunError::from)?;
        let name = Numbers(&scene.description.mesh).to_string();
        (self.progress)(format!("mesh {name}, {number} increments"));
        let start = Instant::now();
        let run = Run::new(&scene)?;
        let model = run.model();
        let (elements, dimension) = (model.mesh.cells.len(), model.mesh.dimension);
        let quadratic = model.mesh.cells.iter().any(|cell| cell.kind.is_quadratic());
        let fineness = elements as f64 * if quadratic { 2.0_f64.powi(dimension as i32) } else { 1.0 };
        if self.fineness.is_some_and(|(before, last)| before < mesh && last >= fineness) {
            return Err(ConvergeError::NotFiner { mesh: name, elements });
        }
        self.fineness = Some((mesh, fineness));
        let follows_path = model.problem.mu().iter().any(|mu| *mu > 0.0) && !scene.solver.method.is_exact_path();
        let report = run.solve(self.observer)?;
        let failure = (report.status != Status::Converged).then(|| {
            let reason = report.explanation.reason.clone();
            if reason.is_empty() { report.status.to_string() } else { reason }
        });
        let value = sought.value(&report);
        // Narrow zones of tetrahedra have no peak, and on a coarse mesh all nodes may stick.
        let may_come = ladder.is_coarse(mesh) || (sought == Sought::Peak && report.largest_pressure.is_some());
        if failure.is_none() && value.is_none() && !may_come {
            let known = Sought::ALL.into_iter().filter(|other| other.value(&report).is_some());
            return Err(ConvergeError::NoValue { sought, known: known.map(Sought::key).collect() });
        }
        let solved = Solved {
            mesh: name,
            own: match ladder.is_own(mesh, &self.scene.description.mesh) {
                false => Own::No,
                true if number == self.scene.time.increments => Own::Whole,
                true => Own::Mesh,
            },
            elements,
            fineness,
            dimension,
            increments: number,
            value: value.filter(|_| failure.is_none()),
            rounding: sought.rounding(&report),
            is_resolved: sought.is_resolved(&report),
            doubt: if sought == Sought::Peak && report.largest_pressure.as_ref().is_some_and(|largest| largest.singular)
            {
                Some(Verdict::Singular)
            } else {
                report.warnings.iter().any(|warning| warning.kind.is_grave()).then_some(Verdict::Warned)
            },
            follows_path,
            failure,
            seconds: start.elapsed().as_secs_f64(),
        };
        self.last = Some(report);
        Ok(solved)
    }
}
