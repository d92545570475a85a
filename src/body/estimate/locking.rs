//! How much too stiff elements are that cannot keep their volume: from what they do, and before a run from what they are.
//!
//! Elements lock where the dilatation varies within them although the material hardly allows any. The share of the strain energy
//! that is in dilatation about its mean,
//!
//! ```text
//! s = Σ_e ½ κ ∫_e (θ - θ_m)² / U,
//! ```
//!
//! tells how much: with θ_m the mean over a quadrilateral or hexahedron, and over the corners of a triangle or tetrahedron, where
//! θ is the mean of the cells around. A body is too stiff by about `c s / (1 - s)`.
//!
//! Elements that cannot deform at all without their volume hardly show it: θ is 0 in each, and s with it. But then their pressures κ θ vary
//! more than anything shears them. Where these are so, and far more is expected before a run, the body is twice as stiff as it should be, or more.
//!
//! Where a force or a contact presses a single node strains are singular, so that θ varies however fine the mesh is. Cells that are next
//! to such a node, and those next to these, are left out.

use super::places::Places;
use super::strains::{Strains, dilatation, volume};
use crate::algebra::vector::{minus, norm};
use crate::body::description::{Action, Load, Where};
use crate::body::fem::{Elasticity, Element};
use crate::body::mesh::{Bodies, CellKind};
use crate::body::model::Model;

/// So many layers of cells around a singular strain say nothing of the others.
const LAYERS: usize = 2;

/// A share of the strain energy that is smaller says nothing of the body.
const COUNTS: f64 = 0.1;

/// What is locked altogether is expected to be too stiff by so many times what s tells.
const ALTOGETHER: f64 = 10.0;

/// A body twice as stiff as it should be.
const TWICE: f64 = 1.0;

/// Poisson's ratios between which the estimate before a run was measured.
const MEASURED: [f64; 2] = [0.45, 0.4999];

/// What was measured of a kind of cell: c above, and that of [`expected_locking`]; none of those that do not lock.
fn measured(kind: CellKind) -> Option<[f64; 2]> {
    match kind {
        CellKind::Quadrilateral => Some([1.3, 0.17]),
        CellKind::Hexahedron | CellKind::Prism => Some([1.3, 0.21]),
        CellKind::Triangle => Some([2.0, 0.26]),
        CellKind::Tetrahedron => Some([3.0, 0.28]),
        CellKind::Triangle6 | CellKind::Tetrahedron10 => None,
    }
}

/// Whether elements of the model can lock.
fn can_lock(model: &Model) -> bool {
    model.element() == Element::Bilinear && !model.is_thin()
}

/// By what share the body is too stiff, about: within a factor of two where it is below 1. The largest of the laws that hold a
/// tenth of the energy; none where no cell can lock. The `pressed` nodes are those that a contact presses alone.
pub(super) fn locking(model: &Model, places: &Places, strains: &Strains, pressed: &[usize]) -> Option<f64> {
    let kinds = || model.mesh.cells.iter().map(|cell| measured(cell.kind));
    if !can_lock(model) || kinds().any(|measured| measured.is_none()) {
        return None;
    }
    let simplices = model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
    let means = simplices.then(|| places.means(strains.volumes(), |e, _| [strains.mean_dilatation(e)]));
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
        let number = places.laws()[e];
        if number >= laws.len() {
            laws.resize(number + 1, None);
        }
        let sums =
            laws[number].get_or_insert(OfLaw { kind: cell.kind, law: *law, energy: 0.0, locked: 0.0, weighted: 0.0 });
        sums.energy += strains.energies()[e];
        sums.locked += locked;
        sums.weighted += c * locked;
    }
    let all: f64 = laws.iter().flatten().map(|sums| sums.energy).sum();
    let count = laws.iter().flatten().filter(|sums| sums.energy > COUNTS * all);
    count.map(|sums| sums.locking(model)).reduce(f64::max)
}

/// What the cells of one law sum up to.
#[derive(Clone)]
struct OfLaw {
    kind: CellKind,
    law: Elasticity,
    /// Their strain energy, J.
    energy: f64,
    /// What of it is in dilatation about its mean, J.
    locked: f64,
    /// That times c, J.
    weighted: f64,
}

impl OfLaw {
    fn locking(&self, model: &Model) -> f64 {
        let OfLaw { kind, law, energy, locked, weighted } = self;
        let share = weighted / (energy - locked);
        // The energy that shear stresses of the size of what pressures vary by would have.
        let pressures = law.bulk() / law.mu * locked;
        let altogether =
            || expected(model, *kind, law).is_some_and(|foreseen| foreseen > TWICE.max(ALTOGETHER * share));
        if pressures > *energy && altogether() { share.max(TWICE) } else { share }
    }
}

/// Whether each cell is next to a node that a point force acts on, or to one of those `pressed`, or next to such a cell. None is where
/// there are no such nodes, or nothing else would be left.
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

/// What [`locking`] is expected to be before a run, of the law with the largest of Poisson's ratios.
pub(crate) fn expected_locking(model: &Model) -> Option<f64> {
    let law = model.materials().iter().max_by(|a, b| poisson(a).total_cmp(&poisson(b)))?;
    let bodies = model.mesh.bodies();
    let body = of_law(model, &bodies, law);
    let kind = model.mesh.cells[bodies.cells(body).next()?].kind;
    if can_lock(model) { expected(model, kind, law) } else { None }
}

/// The first body that has cells of this law.
fn of_law(model: &Model, bodies: &Bodies, law: &Elasticity) -> usize {
    let first = model.materials().iter().position(|own| own == law);
    first.map_or(0, |e| bodies.of_cells()[e])
}

/// `c m^-1.4 (1 - 2ν)^-0.75` with m elements across the smaller side of the body of this law; none where Poisson's ratio is below 0.45, as it was
/// measured for blocks that are pressed with ratios from there on.
fn expected(model: &Model, kind: CellKind, law: &Elasticity) -> Option<f64> {
    let [_, c] = measured(kind)?;
    let poisson = poisson(law);
    let about = || c * across(model, law).powf(-1.4) * (1.0 - 2.0 * poisson.min(MEASURED[1])).powf(-0.75);
    (poisson >= MEASURED[0] - ROUNDING).then(about)
}

fn poisson(law: &Elasticity) -> f64 {
    0.5 * law.lambda / (law.lambda + law.mu)
}

/// The elements across the smaller side of the body that has this law; two triangles make up a square, two prisms or six tetrahedra a cube.
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

/// What is computed back from Lamé's constants may miss Poisson's ratio by as much.
const ROUNDING: f64 = 1e-9;
