//! Meshes that refine themselves: the history is solved, the cells with the largest errors of the stresses are divided, and
//! so on until the error of the mesh is as small as asked for.
//!
//! The cells with half of the squared error `η²` of [`DiscretisationError`] are divided (Dörfler, SIAM J. Numer. Anal. 33
//! (1996) 1106), at the output times or at the end, each with its largest error. Errors are largest at the ends of
//! contact zones and at corners, so that most cells are there.
//!
//! [`DiscretisationError`]: crate::body::DiscretisationError

use std::borrow::Cow;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::Serialize;

use super::{Recording, Run, RunError};
use crate::base::input_error::InputError;
use crate::body::ElementEstimate;
use crate::body::mesh::{Bisection, Mesh, MeshSource};
use crate::scene::Scene;

/// The share of the squared error in the cells that are divided.
const SHARE: f64 = 0.5;

/// The number of meshes after which the error is out of reach; each has about 1.5 times the cells of the last one.
const MAX_MESHES: usize = 60;

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

/// Returns `scene` on the mesh that its `refine` asks for, and the meshes before; as it is if it asks for none.
///
/// # Errors
/// If the mesh has other cells than triangles or tetrahedra, if a run on a coarser mesh fails, and if the error does not
/// become as small as asked for.
pub(super) fn refined(scene: &Scene) -> Result<(Cow<'_, Scene>, Vec<CoarserMesh>), RunError> {
    let Some(wanted) = scene.refine else { return Ok((Cow::Borrowed(scene), Vec::new())) };
    let fault =
        |message: &str, help: &str| RunError::Scene(scene.located(InputError::new("mesh.refine", message, help)));
    let (mut refined, mut meshes) = (scene.clone(), Vec::new());
    refined.refine = None;
    let mut bisection: Option<Bisection> = None;
    for _ in 0..MAX_MESHES {
        let run = Run::new(&refined)?;
        let mesh = Arc::clone(&run.model().mesh);
        let (error, squares) = errors(&run, scene)?;
        if error <= wanted {
            return Ok((Cow::Owned(refined), meshes));
        }
        meshes.push(CoarserMesh { nodes: mesh.nodes.len(), cells: mesh.cells.len(), error });
        if bisection.is_none() {
            bisection = Bisection::new(&mesh);
        }
        let Some(bisection) = bisection.as_mut() else {
            let help = "give mesh.cells = \"triangle\" or \"tetrahedron\", or a mesh file of these alone";
            return Err(fault("only meshes of triangles or of tetrahedra refine themselves", help));
        };
        bisection.refine(&marked(&squares));
        refined.description.mesh = MeshSource::Given(Arc::new(bisection.mesh()));
        // The run that is asked for tells the error of the last mesh.
        if error * expected_ratio(&mesh) <= wanted {
            return Ok((Cow::Owned(refined), meshes));
        }
    }
    Err(fault(&format!("an error of {} % is out of reach", 100.0 * wanted), "ask for a larger error"))
}

/// Returns the ratio of the errors of a mesh and of the one before: cells of half the volume, where half of the squared
/// error is.
fn expected_ratio(mesh: &Mesh) -> f64 {
    let order = if mesh.cells.iter().any(|cell| cell.kind.is_quadratic()) { 2.0 } else { 1.0 };
    (1.0 - SHARE * (1.0 - 0.5_f64.powf(2.0 * order / mesh.dimension as f64))).sqrt()
}

/// Solves a history and returns the largest error of the mesh in the energy norm at the output times, or at the end, and the
/// largest squared error of each cell.
fn errors(run: &Run<'_>, scene: &Scene) -> Result<(f64, Vec<f64>), RunError> {
    let numbers: Vec<usize> = scene.output.increments(run.times()).into_iter().filter(|k| *k > 0).collect();
    let mut recording = if numbers.is_empty() { Recording::last() } else { Recording::of(numbers) };
    run.history(&mut recording)?;
    let model = run.model();
    let (mut error, mut squares) = (0.0_f64, vec![0.0_f64; model.mesh.cells.len()]);
    for increment in &recording.increments {
        let t = increment.record.time;
        let displacements = model.displaced(t, &increment.state.u);
        let estimate = ElementEstimate::new(model, &model.thermal_factors(t), &displacements, &[]);
        let Some(own) = estimate.discretisation else { continue };
        error = error.max(own.whole);
        squares.iter_mut().zip(&own.of_cells).for_each(|(square, share)| *square = square.max(share * share));
    }
    Ok((error, squares))
}

/// Returns the fewest cells with [`SHARE`] of the sum of `squares`.
fn marked(squares: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..squares.len()).collect();
    order.sort_by(|&a, &b| squares[b].total_cmp(&squares[a]));
    let whole: f64 = squares.iter().sum();
    let mut sum = 0.0;
    let is_needed = |&e: &usize| {
        let needed = sum < SHARE * whole;
        sum += squares[e];
        needed
    };
    order.into_iter().take_while(is_needed).collect()
}
