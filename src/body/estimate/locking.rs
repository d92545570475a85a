//! Estimates of volumetric locking: from a solution and, before a run, from the mesh and the material.
//!
//! Elements lock if the dilatation varies within them although the material is almost incompressible. The measure is
//! the share of the strain energy in the variation of the dilatation about its mean,
//!
//! ```text
//! s = Σ_e ½ κ ∫_e (θ - θ_m)² / U,
//! ```
//!
//! where θ_m is the mean over a quadrilateral or hexahedron; in a triangle or tetrahedron it is the mean over the
//! corners, at which θ is the mean of the surrounding cells. A body is too stiff by about `c s / (1 - s)`.
//!
//! This measure fails for elements that cannot deform without a change of volume: θ and s are then almost 0 in each.
//! But their pressures κ θ vary more than the shear stresses. If this is so, and the estimate before a run is much
//! larger, the body is at least twice as stiff as it should be.
//!
//! If a force or a contact presses a single node, strains are singular, so that θ varies on any mesh. The two layers of
//! cells around such a node are left out.

use super::recovery::Places;
use super::strains::{Strains, dilatation, volume};
use crate::algebra::vector::{minus, norm};
use crate::body::description::{Action, Load, Where};
use crate::body::fem::{Elasticity, Element};
use crate::body::mesh::{Bodies, CellKind};
use crate::body::model::Model;

/// The number of layers of cells left out around a singularity.
const LAYERS: usize = 2;

/// A law is ignored if its share of the strain energy is smaller than this.
const COUNTS: f64 = 0.1;

/// Elements count as fully locked if the stiffness error expected before a run is this many times the error estimated
/// from s.
const ALTOGETHER: f64 = 10.0;

/// The estimate of a body that is twice as stiff as it should be.
const TWICE: f64 = 1.0;

/// The range of Poisson's ratios for which the estimate before a run was measured.
const MEASURED: [f64; 2] = [0.45, 0.4999];

/// Returns the measured coefficients of a kind of cell, c above and that of [`expected_locking`]; `None` for kinds that
/// do not lock.
fn measured(kind: CellKind) -> Option<[f64; 2]> {
    match kind {
        CellKind::Quadrilateral => Some([1.3, 0.17]),
        CellKind::Hexahedron | CellKind::Prism => Some([1.3, 0.21]),
        CellKind::Triangle => Some([2.0, 0.26]),
        CellKind::Tetrahedron => Some([3.0, 0.28]),
        _ => None,
    }
}

/// Returns `true` if elements of the model can lock.
fn can_lock(model: &Model) -> bool {
    model.element() == Element::Bilinear && !model.is_thin()
}

/// Estimates the share by which the body is too stiff, to a factor of two below 1. The result is the largest value of
/// the laws with at least a tenth of the energy; `None` if no cell can lock. The `pressed` nodes are single nodes that
/// a contact presses.
pub(super) fn locking(model: &Model, places: &Places, strains: &Strains, pressed: &[usize]) -> Option<f64> {
    let kinds = || model.mesh.cells.iter().map(|cell| measured(cell.kind));
    if !can_lock(model) || kinds().any(|measured| measured.is_none()) {
        return None;
    }
    let simplices = model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
    let means = simplices.then(|| places.means(&strains.volumes, |e, _| [strains.mean_dilatation(e)]));
    let singular = around(model, pressed);
    let mut laws: Vec<Option<OfLaw>> = Vec::new();
    for (e, (cell, law)) in model.mesh.cells.iter().zip(model.materials()).enumerate() {
        if singular.get(e) == Some(&true) {
            continue;
        }
        let mean = match &means {
            Some(means) if cell.kind.is_simplex() => {
                let corners = places.of_cell(e);
                corners.iter().map(|&place| means[place][0]).sum::<f64>() / corners.len() as f64
            }
            _ => strains.mean_dilatation(e),
        };
        let varies: f64 = strains.of_cell(e).iter().map(|(v, strain)| v * (dilatation(strain) - mean).powi(2)).sum();
        let [c, _] = measured(cell.kind)?;
        let locked = 0.5 * law.bulk() * varies;
        let number = places.laws[e];
        if number >= laws.len() {
            laws.resize(number + 1, None);
        }
        let sums =
            laws[number].get_or_insert(OfLaw { kind: cell.kind, law: *law, energy: 0.0, locked: 0.0, weighted: 0.0 });
        sums.energy += strains.energies[e];
        sums.locked += locked;
        sums.weighted += c * locked;
    }
    let all: f64 = laws.iter().flatten().map(|sums| sums.energy).sum();
    let count = laws.iter().flatten().filter(|sums| sums.energy > COUNTS * all);
    count.map(|sums| sums.locking(model)).reduce(f64::max)
}

/// Sums over the cells of one law.
#[derive(Clone)]
struct OfLaw {
    kind: CellKind,
    law: Elasticity,
    /// Their strain energy, J.
    energy: f64,
    /// The part of the energy in the variation of the dilatation, J.
    locked: f64,
    /// The part `locked` times c, J.
    weighted: f64,
}

impl OfLaw {
    fn locking(&self, model: &Model) -> f64 {
        let OfLaw { kind, law, energy, locked, weighted } = self;
        let share = weighted / (energy - locked);
        // The energy of shear stresses as large as the variation of the pressures.
        let pressures = law.bulk() / law.mu * locked;
        let altogether =
            || expected(model, *kind, law).is_some_and(|foreseen| foreseen > TWICE.max(ALTOGETHER * share));
        if pressures > *energy && altogether() { share.max(TWICE) } else { share }
    }
}

/// Returns for each cell `true` if it is within [`LAYERS`] layers of a node with a point force or of a `pressed` node.
/// Empty if there are no such nodes or if no other cell would be left.
fn around(model: &Model, pressed: &[usize]) -> Vec<bool> {
    let mesh = &model.mesh;
    let point = |load: &Load| match load.action {
        Action::Force { at: Where::Point(point), .. } => Some(point.components()),
        _ => None,
    };
    let nearest = |point: [f64; 3]| {
        let distance = |&node: &usize| norm(minus(mesh.nodes[node], point));
        (0..mesh.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    let forces = model.description().loads.iter().filter_map(point).filter_map(nearest);
    let mut nodes: Vec<usize> = forces.chain(pressed.iter().copied()).collect();
    if nodes.is_empty() {
        return Vec::new();
    }
    let mut cells = vec![false; mesh.cells.len()];
    let mut reached = vec![false; mesh.nodes.len()];
    for _ in 0..LAYERS {
        nodes.drain(..).for_each(|node| reached[node] = true);
        for (own, cell) in cells.iter_mut().zip(&mesh.cells) {
            if !*own && cell.nodes.iter().any(|&node| reached[node]) {
                *own = true;
                nodes.extend(&cell.nodes);
            }
        }
    }
    if cells.contains(&false) { cells } else { Vec::new() }
}

/// Estimates [`locking`] before a run, for the law with the largest Poisson's ratio.
pub(crate) fn expected_locking(model: &Model) -> Option<f64> {
    let law = model.materials().iter().max_by(|a, b| poisson(a).total_cmp(&poisson(b)))?;
    let bodies = model.mesh.bodies();
    let body = of_law(model, &bodies, law);
    let kind = model.mesh.cells[bodies.cells(body).next()?].kind;
    if can_lock(model) { expected(model, kind, law) } else { None }
}

/// Returns the first body with cells of this law.
fn of_law(model: &Model, bodies: &Bodies, law: &Elasticity) -> usize {
    let first = model.materials().iter().position(|own| own == law);
    first.map_or(0, |e| bodies.of_cells()[e])
}

/// Computes `c m^-1.4 (1 - 2ν)^-0.75` with m elements across the smaller side of the body of this law. `None` if
/// Poisson's ratio is below 0.45, since the formula was measured for compressed blocks with larger ratios.
fn expected(model: &Model, kind: CellKind, law: &Elasticity) -> Option<f64> {
    let [_, c] = measured(kind)?;
    let poisson = poisson(law);
    let about = || c * across(model, law).powf(-1.4) * (1.0 - 2.0 * poisson.min(MEASURED[1])).powf(-0.75);
    (poisson >= MEASURED[0] - POISSON_ROUNDING).then(about)
}

fn poisson(law: &Elasticity) -> f64 {
    0.5 * law.lambda / (law.lambda + law.mu)
}

/// Returns the number of elements across the smaller side of the body with this law; two triangles count as a square,
/// two prisms or six tetrahedra as a cube.
fn across(model: &Model, law: &Elasticity) -> f64 {
    let mesh = &model.mesh;
    let d = mesh.dimension;
    let bodies = mesh.bodies();
    let body = of_law(model, &bodies, law);
    let bounds = mesh.bounds_of(bodies.nodes(body));
    let smaller = bounds[..d].iter().map(|(lowest, highest)| highest - lowest).fold(f64::INFINITY, f64::min);
    let cells: Vec<usize> = bodies.cells(body).collect();
    let together = match cells.first().map(|&e| mesh.cells[e].kind) {
        Some(CellKind::Triangle | CellKind::Prism) => 2.0,
        Some(CellKind::Tetrahedron) => 6.0,
        _ => 1.0,
    };
    let size = together * volume(mesh, &cells) / cells.len() as f64;
    smaller / size.powf(1.0 / d as f64)
}

/// The rounding error of Poisson's ratio computed from Lamé's constants.
const POISSON_ROUNDING: f64 = 1e-9;
