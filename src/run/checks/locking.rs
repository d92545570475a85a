//! Locking: elements that are too stiff.

use super::prelude::*;
use crate::body::estimate::expected_locking;
use crate::body::fem::Element;

kinds! {
    /// Elements make the body more than 5 % too stiff: those that hardly change volume, near a Poisson's ratio of 0.5,
    /// or those too large for bending. Second order: Poisson's ratio above 0.499.
    LOCKING("locking", "See the message: `mesh.element = \"b-bar\"` or `\"nodal-volume\"`, second order, smaller elements.",
        "the share in the message suffices");
}

/// Poisson's ratio from which resistance to a change of volume makes elements too stiff, and not bending.
const NEARLY_INCOMPRESSIBLE: f64 = 0.45;

/// A smaller excess of stiffness by locking causes no warning.
const LOCKING: f64 = 0.05;

/// Above this share, the estimate is known to be too small.
const AT_LEAST: f64 = 1.0;

/// The factor by which elements of half the size lock less.
const HALVED: f64 = 2.64;

/// The Poisson's ratio up to which elements of second order are as good as B-bar elements, and its rounding.
const QUADRATIC_LOCKING: f64 = 0.499 + 1e-9;

/// Warns of locking if it makes the body too stiff by a significant `share`.
pub(super) fn warning(model: &Model, share: f64) -> Option<Warning> {
    let poisson = largest_poisson(model);
    let simplices = model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
    let (tri, quad) =
        if model.mesh.dimension == 2 { ("triangles", "quadrilaterals") } else { ("tetrahedra", "hexahedra") };
    let (why, nodal) = if poisson >= NEARLY_INCOMPRESSIBLE {
        (format!("its elements lock near nu = 0.5, and nu is {poisson:.6}"), "mesh.element = \"nodal-volume\", ")
    } else {
        ("its elements are too stiff in bending".to_string(), "")
    };
    let cells = if simplices {
        format!("use {nodal}{tri} of second order, or {quad} with mesh.element = \"b-bar\"")
    } else {
        "use mesh.element = \"b-bar\"".to_string()
    };
    let about = if share > AT_LEAST { "at least" } else { "about" };
    let [now, halved] = [share, share / HALVED].map(|share| 100.0 * share);
    let message = format!(
        "expect the body to be {about} {now:.0} % too stiff: {why}; {cells}, or halve the elements for about \
         {halved:.0} %"
    );
    (share > LOCKING).then_some(WarningKind::LOCKING.warning(message))
}

/// Predicts locking before the solution.
pub(super) fn expected(model: &Model) -> Option<Warning> {
    if let Some(share) = expected_locking(model) {
        return warning(model, share);
    }
    let poisson = largest_poisson(model);
    let quadratic = model.mesh.cells.iter().any(|cell| cell.kind.is_quadratic());
    let plain = model.element() == Element::Bilinear && !model.is_thin();
    let locks = quadratic && plain && poisson > QUADRATIC_LOCKING;
    let message = format!(
        "nu is {poisson:.6}: elements of second order may be too stiff as well; use mesh.element = \"nodal-volume\""
    );
    locks.then_some(WarningKind::LOCKING.warning(message))
}

fn largest_poisson(model: &Model) -> f64 {
    model.materials().iter().map(|law| 0.5 * law.lambda / (law.lambda + law.mu)).fold(0.0, f64::max)
}
