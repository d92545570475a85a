//! Adaptive mesh refinement: the history is solved, the cells with the largest errors of the stresses are divided,
//! and so on until the error of the mesh is expected to be as small as asked for.
//!
//! The cells with half of the squared error `η²` of [`DiscretisationError`] get half their size (Dörfler, SIAM J. Numer.
//! Anal. 33 (1996) 1106). The error of a cell is its largest at the output times, or at the end, relative to the energy
//! of its body, or of all bodies in contact with it; refinement stops by the largest error of such a part. Errors are
//! largest at the ends of contact zones and at corners, so that most cells are there.
//!
//! New nodes of the surface lie on the curved surfaces of which the edges of the first mesh are chords, so that a polygon
//! becomes a circle. The mean radius of a polygon, whose edges turn by `θ` each, is a share of `θ²/12` too
//! small. The mean of this share over the cells there, weighted with their strain energy, is added to `η²`. The error of a
//! cell into which an obstacle reaches between nodes is 1 if nothing touches.
//!
//! [`DiscretisationError`]: crate::body::DiscretisationError

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Serialize;

use super::{RecordedIncrement, Run, RunError};
use crate::base::input_error::InputError;
use crate::body::contact::RoundSurface;
use crate::body::mesh::{Bisection, Cell, Facet, Mesh, MeshSource, sorted};
use crate::body::model::Model;
use crate::body::{ElementEstimate, ModelError};
use crate::scene::Scene;
use crate::solver::history::{IncrementView, Observer, Status};
use crate::solver::newton::IterationRecord;

/// The share of the squared error in the cells that are divided.
const SHARE: f64 = 0.5;

/// The largest number of meshes.
const MAX_MESHES: usize = 60;

/// The error is out of reach if so many meshes reduce it by less than a tenth, as beside a force at a point, where the
/// energy of finer and finer meshes grows without a limit.
const STAGNANT: (usize, f64) = (6, 0.9);

/// The least ratio of the errors of a mesh and the one before that is expected: dividing cells with half of `η²` once leaves 0.79 of
/// η with linear cells, and 0.73 with quadratic ones.
const LEAST_RATIO: f64 = 0.6;

/// A mesh on which a history was solved before that of the run.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CoarserMesh {
    /// The number of nodes.
    pub nodes: usize,
    /// The number of cells.
    pub cells: usize,
    /// The largest error of the stresses in the energy norm.
    pub error: f64,
}

/// A scene whose mesh is refined, step by step, where the errors of the stresses are large.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// The scene on its present mesh.
    scene: Scene,
    bisection: Option<Bisection>,
    meshes: Vec<CoarserMesh>,
    /// The status of the last history.
    status: Status,
    /// The errors of the present mesh, if they are known.
    errors: Option<MeshErrors>,
}

/// The errors of a mesh.
#[derive(Debug, Clone)]
struct MeshErrors {
    mesh: CoarserMesh,
    /// The largest squared error of each cell.
    squares: Vec<f64>,
    /// The power of the size of elements with which errors of smooth stresses fall.
    order: f64,
}

impl Refinement {
    /// Begins with the mesh of `scene`.
    ///
    /// # Errors
    /// If the mesh cannot be built, or has other cells than triangles or tetrahedra.
    pub fn new(scene: &Scene) -> Result<Self, RunError> {
        let mut scene = scene.clone();
        scene.refine = None;
        let is_possible = Self::is_possible(&*scene.description.mesh.build().map_err(ModelError::from)?);
        let refinement =
            Refinement { scene, bisection: None, meshes: Vec::new(), status: Status::Converged, errors: None };
        if is_possible { Ok(refinement) } else { Err(refinement.other_cells()) }
    }

    /// Returns `true` if `mesh` can be refined: it has only triangles, or only tetrahedra.
    pub fn is_possible(mesh: &Mesh) -> bool {
        mesh.cells.iter().all(|cell| cell.kind.is_simplex())
    }

    /// Returns the scene on its present mesh.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Refines the mesh as if all elements became `ratio` times smaller, or a little more. Returns the value of
    /// `mesh.refine`, with two digits, that leads from the first mesh to this one, 0 if the error is 0 and all cells
    /// are divided; `None` if the mesh stays as it is, see [`Refinement::status`]. `observer` sees the iterations on
    /// coarser meshes.
    ///
    /// # Errors
    /// If a run on a coarser mesh cannot be prepared or go on. A `ratio` of at most 1, or none, leaves the mesh as it is.
    pub fn finer(&mut self, ratio: f64, observer: &mut dyn Observer) -> Result<Option<f64>, RunError> {
        let Some(MeshErrors { mesh, order, .. }) = self.errors(&mut |_| (), observer)? else { return Ok(None) };
        let exact = mesh.error / ratio.powf(*order);
        if exact == 0.0 {
            return self.divide().map(|()| Some(0.0));
        }
        if ratio.is_nan() {
            return Ok(None);
        }
        let digits = 10.0_f64.powf(1.0 - exact.log10().floor());
        let wanted = (digits * exact).floor() / digits;
        let meshes = self.meshes.len();
        self.until(wanted, &mut |_| (), observer)?;
        let is_refined = self.meshes.len() > meshes && is_known(self.status);
        Ok(is_refined.then_some(wanted))
    }

    /// Refines the mesh until its error is expected to be at most `wanted`, relative, in the energy norm; the run on
    /// the last mesh tells it. `prepare` sees each model and `observer` the iterations on coarser meshes. After a
    /// history that neither converges nor ends by slip, and if finer meshes hardly reduce the error, the mesh stays as it is.
    ///
    /// # Errors
    /// If a run on a coarser mesh cannot be prepared or go on.
    pub(super) fn until(
        &mut self,
        wanted: f64,
        prepare: &mut dyn FnMut(&Model),
        observer: &mut dyn Observer,
    ) -> Result<(), RunError> {
        for _ in 1..MAX_MESHES {
            let (meshes, share) = STAGNANT;
            let before = self.meshes.len().checked_sub(meshes).map(|k| share * self.meshes[k].error);
            let last = self.meshes.last().map(|mesh| mesh.error);
            let Some(MeshErrors { mesh, .. }) = self.errors(prepare, observer)? else { return Ok(()) };
            // Where a contact is seen at last, the error grows by more.
            if mesh.error <= wanted || before.is_some_and(|before| (before..2.0 * before).contains(&mesh.error)) {
                return Ok(());
            }
            // The next mesh is expected to reduce the error as the last one did, which may have seen a contact at last.
            let expected = mesh.error * last.map_or(1.0, |last| (mesh.error / last).max(LEAST_RATIO));
            self.divide()?;
            if expected <= wanted {
                return Ok(());
            }
        }
        Ok(())
    }

    /// Returns the status of the last history.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Returns the scene on its present mesh, and the coarser meshes.
    pub(super) fn into_scene(self) -> (Scene, Vec<CoarserMesh>) {
        (self.scene, self.meshes)
    }

    /// Divides the cells of the present mesh with large errors.
    fn divide(&mut self) -> Result<(), RunError> {
        let (Some(bisection), Some(errors)) = (&mut self.bisection, self.errors.take()) else {
            return Err(self.other_cells());
        };
        bisection.refine(&marked(&errors.squares));
        self.scene.description.mesh = MeshSource::Given(Arc::new(bisection.mesh()));
        self.meshes.push(errors.mesh);
        Ok(())
    }

    fn refused(&self, message: String, help: &str) -> RunError {
        RunError::Scene(self.scene.located(InputError::new("mesh.refine", message, help)))
    }

    fn too_coarse(&self, place: &str) -> RunError {
        let message = format!("the surface is round at {place}, and the first mesh is too coarse to become so");
        self.refused(message, "give the first mesh shorter edges there, or cells that are less flat")
    }

    fn other_cells(&self) -> RunError {
        let help = "give all bodies mesh.cells = \"triangle\" or \"tetrahedron\", or mesh files of these alone";
        self.refused("only meshes of triangles or of tetrahedra refine themselves".into(), help)
    }

    /// Returns the errors of the present mesh: the largest ones at the output times, or at the end; `None` if the
    /// history, which is solved unless they are known, does not converge.
    fn errors(
        &mut self,
        prepare: &mut dyn FnMut(&Model),
        observer: &mut dyn Observer,
    ) -> Result<Option<&MeshErrors>, RunError> {
        if self.errors.is_none() {
            let run = Run::prepared(&self.scene, prepare, &mut ())?;
            if self.bisection.is_none() {
                let model = run.model();
                let facets = surface(model);
                let round = Arc::new(RoundSurface::new(&model.mesh, facets.clone()));
                let bisection = Bisection::new(&model.mesh).map(|bisection| bisection.follow(&facets, round));
                self.bisection = bisection.transpose().map_err(|place| self.too_coarse(&model.units().point(place)))?;
            }
            let angles = self.bisection.iter().flat_map(Bisection::angles).collect::<Vec<f64>>();
            let (status, errors) = MeshErrors::of(&run, &self.scene, &angles, observer)?;
            self.errors = is_known(status).then_some(errors);
            self.status = status;
        }
        Ok(self.errors.as_ref())
    }
}

impl MeshErrors {
    /// Solves the history. `angles` are those of [`Bisection::angles`].
    fn of(
        run: &Run<'_>,
        scene: &Scene,
        angles: &[f64],
        observer: &mut dyn Observer,
    ) -> Result<(Status, Self), RunError> {
        let wanted = scene.output.increments(run.times()).into_iter().filter(|k| *k > 0).collect();
        let mut states = States { wanted, known: Vec::new(), observer };
        let status = run.history(&mut states)?.status;
        if status == Status::Converged && states.known.len() > 1 {
            states.known.pop_if(|last| !states.wanted.contains(&last.record.index));
        }
        let model = run.model();
        let mesh = &model.mesh;
        let (mut error, mut squares) = (0.0_f64, vec![0.0_f64; mesh.cells.len()]);
        for increment in &states.known {
            let t = increment.record.time;
            let displacements = model.displaced(t, &increment.state.u);
            // Where an obstacle is inside the body between nodes, and nothing touches yet, a contact is not seen.
            let touches = increment.record.contact.stick + increment.record.contact.slip > 0;
            let missed = model.between_nodes(t, &increment.state, &increment.statuses).filter(|_| !touches);
            if let Some(facet) = missed.and_then(|found| found.untouched) {
                let is_beside = |cell: &Cell| facet.iter().all(|node| cell.nodes.contains(node));
                let beside = mesh.cells.iter().zip(&mut squares).filter(|(cell, _)| is_beside(cell));
                beside.for_each(|(_, square)| *square = 1.0);
                error = 1.0;
            }
            let estimate = ElementEstimate::new(model, &model.thermal_factors(t), &displacements, &[]);
            let Some(own) = estimate.discretisation else { continue };
            let round = own.energies.iter().zip(angles).filter(|(_, angle)| **angle > 0.0);
            let at_round = round.map(|(energy, _)| energy).sum::<f64>().max(f64::MIN_POSITIVE);
            let mut whole = own.whole.powi(2);
            for (e, square) in squares.iter_mut().enumerate() {
                let of_chords = angles[e] * own.energies[e] / at_round;
                whole += of_chords;
                *square = square.max(own.of_cells[e].powi(2) + of_chords);
            }
            error = error.max(whole.sqrt());
        }
        let order = if mesh.cells.iter().any(|cell| cell.kind.is_quadratic()) { 2.0 } else { 1.0 };
        let mesh = CoarserMesh { nodes: mesh.nodes.len(), cells: mesh.cells.len(), error };
        Ok((status, MeshErrors { mesh, squares, order }))
    }
}

/// Returns `true` if a history has states that tell the errors of its mesh: up to its end, or to the slip of a joint.
fn is_known(status: Status) -> bool {
    matches!(status, Status::Converged | Status::Slips)
}

/// Keeps the states after the increments that are wanted, and after the last one.
struct States<'a> {
    wanted: Vec<usize>,
    known: Vec<RecordedIncrement>,
    observer: &'a mut dyn Observer,
}

impl Observer for States<'_> {
    fn iteration(&mut self, index: usize, record: &IterationRecord) -> ControlFlow<()> {
        self.observer.iteration(index, record)
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if step.record.status == Status::Converged {
            self.known.pop_if(|last| !self.wanted.contains(&last.record.index));
            self.known.push(RecordedIncrement::new(step));
        }
        ControlFlow::Continue(())
    }
}

/// Returns the facets of the bodies' surface without boundaries of first order that are glued, or whose gap is given.
fn surface(model: &Model) -> Vec<Facet> {
    let mesh = &model.mesh;
    let pairs = model.contact.pairs.iter().filter(|pair| pair.glued || pair.gap.is_some());
    let sides = pairs.flat_map(|pair| mesh.boundary(&pair.slave).into_iter().chain([&pair.master]));
    let kept: HashSet<Facet> = sides.flat_map(|side| &side.facets).map(|facet| sorted(facet)).collect();
    mesh.surface().into_iter().map(|of| of.0).filter(|f| mesh.is_quadratic(f) || !kept.contains(&sorted(f))).collect()
}

/// Returns the fewest cells with [`SHARE`] of the sum of `squares`; all if the sum is 0.
fn marked(squares: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..squares.len()).collect();
    order.sort_by(|&a, &b| squares[b].total_cmp(&squares[a]));
    let whole: f64 = squares.iter().sum();
    let mut sum = 0.0;
    let is_needed = |&e: &usize| {
        let needed = sum < SHARE * whole || whole == 0.0;
        sum += squares[e];
        needed
    };
    order.into_iter().take_while(is_needed).collect()
}
