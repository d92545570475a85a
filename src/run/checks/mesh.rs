//! Meshes that are too coarse for the body itself.

use super::locking;
use super::prelude::*;
use crate::body::fem::Element;
use crate::body::mesh::CellKind;

kinds! {
    /// The error of the mesh is above 15 % in the energy norm.
    COARSE_MESH("coarse-mesh", "Refine where the field `discretisation_error` is large; second order.",
        "the errors in the message suffice");
    /// The mesh error of the largest tangential force is above 5 %, where that of the body is small.
    TANGENTIAL_COARSE("tangential-coarse", "Refine; second order.", "tangential forces do not matter");
    /// Poisson's ratio is 0.45 or more: stresses are more than 10 % off, and three times as much as the error of the mesh.
    ROUGH_STRESSES("rough-stresses", "`b-bar`, `nodal-volume`, refine.", "only forces and displacements matter");
}

/// The error of the largest tangential force by the mesh above which a warning is given, if that of the body is small.
const TANGENTIAL: f64 = 0.05;

/// The ratio of the estimate to the error in the energy norm if corners make the solution singular.
const OF_SINGULAR: f64 = 0.6;

/// The error in the energy norm above which a warning is given. Of 200 random scenes, those with 0.14 to 0.2 had
/// tangential forces that were 2 to 20 % off.
const COARSE: f64 = 0.15;

/// A warning of the stresses is given if their error is above this and above [`FAR`] times the error of the mesh.
const ROUGH: f64 = 0.1;
const FAR: f64 = 3.0;

/// Returns the cure of both kinds of coarse meshes.
fn finer(model: &Model) -> String {
    let all = |of: fn(CellKind) -> bool| model.mesh.cells.iter().all(|cell| of(cell.kind));
    let itself = if all(CellKind::is_simplex) { ", as `mesh.refine` does" } else { "" };
    let order = if all(CellKind::is_quadratic) { "" } else { ", or use elements of second order" };
    format!("refine it where the field `discretisation_error` is large{itself}{order}")
}

/// Returns the warnings of the mesh.
pub(super) fn warnings(solved: &Solved<'_>) -> Vec<Warning> {
    let (estimates, finer) = (solved.estimates, finer(solved.model));
    let locking = estimates.locking.and_then(|share| locking::warning(solved.model, share));
    let tangential = || estimates.tangential.filter(|e| *e > TANGENTIAL).map(|e| coarse_for_friction(e, &finer));
    let coarse = estimates.discretisation.filter(|e| *e > COARSE).map(|e| coarse(e, &finer)).or_else(tangential);
    locking.into_iter().chain(coarse).chain(inaccurate(solved)).collect()
}

/// Warns of a mesh that is too coarse for the body itself.
fn coarse(error: f64, finer: &str) -> Warning {
    let [whole, off, singular] = [100.0 * error, 100.0 * error * error, 100.0 * (error / OF_SINGULAR).powi(2)];
    WarningKind::COARSE_MESH.warning(format!(
        "the mesh is coarse: its error is about {whole:.0} % in the energy norm, so displacements and forces may be off \
         by about {off:.0} % (if stresses at corners or ends of supports are singular, by {singular:.0} %), and \
         pressures by more; {finer}"
    ))
}

/// Warns of a mesh that is too coarse for tangential forces much smaller than the normal ones.
fn coarse_for_friction(error: f64, finer: &str) -> Warning {
    WarningKind::TANGENTIAL_COARSE.warning(format!(
        "the mesh is coarse for the tangential forces: the error of the largest one is about {:.0} %; {finer}",
        100.0 * error
    ))
}

/// Warns if stresses in the body are much less accurate than displacements.
fn inaccurate(Solved { model, estimates, .. }: &Solved<'_>) -> Option<Warning> {
    let whole = estimates.discretisation?;
    let stresses = estimates.stresses.filter(|error| *error > ROUGH && *error > FAR * whole)?;
    let has_b_bar = model.mesh.cells.iter().all(|cell| !cell.kind.is_simplex() && !cell.kind.is_quadratic());
    let cure = match model.element() {
        Element::Bilinear if has_b_bar => "use mesh.element = \"b-bar\"",
        Element::Bilinear => "use mesh.element = \"nodal-volume\"",
        Element::BBar | Element::NodalVolume => "refine the mesh",
    };
    let [off, of_mesh] = [stresses, whole].map(|share| 100.0 * share);
    Some(WarningKind::ROUGH_STRESSES.warning(format!(
        "stresses in the body (fields and probes) may be off by about {off:.0} %, although the error of the mesh \
         is {of_mesh:.0} % in the energy norm: pressures in nearly incompressible elements vary from one to the \
         next; {cure}, or use only forces and displacements"
    )))
}
