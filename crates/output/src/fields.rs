//! The fields of a body at the end of an increment: displacement, stress, contact.

use super::part::RANK;
use super::vtu::{Field, Grid, Values};
use stickslip::algebra::{across, dot, norm, plus, unit};
use stickslip::body::mesh::Cell;
use stickslip::body::{ElementEstimate, Model};
use stickslip::run::report::{ContactPoint, contact_points as points, deformation, principal_stresses, von_mises};
use stickslip::solver::ContactStatus;
use stickslip::solver::history::IncrementView;

/// Returns the body with its fields at the end of a step, SI.
///
/// Fields of points: `displacement`; `contact_pressure` (Pa, `p_n / l` (32)), `tangential_traction` (Pa, the vector of
/// the body on the obstacle), `slip` (m, the vector of motion relative to the obstacle since the beginning), `gap` (m,
/// the remaining distance), and with tetrahedra `patch_pressure` (Pa, the pressure of a node and its neighbours
/// together), all NaN off the contact; `status`: -1 off the contact, 0 open, 1 stick, 2 slip. A node that meets two
/// obstacles shows the one that presses more. If bodies press each other, the other side has the same pressure and
/// traction, distributed to its own nodes, but no slip, gap and status. `nodal_stress` (Pa, all nine components row by
/// row) and `nodal_von_mises` (Pa): the stress recovered at each node, on the contact surface that along it with the
/// contact stresses.
///
/// Fields of cells: `stress` (Pa, at the centre, all nine components row by row), `principal_stress` (Pa, the most
/// tensile first), `von_mises` (Pa), `material`, a number from 0 for each group of the mesh and each law in it, in the
/// order of the elements; with several bodies `body`, the number of each from 0; `discretisation_error`, the
/// contribution of a cell to the error of the mesh in the energy norm; and if several processes share the body, `rank`,
/// the lowest rank of the cell's nodes.
pub fn fields(model: &Model, step: &IncrementView<'_>) -> Grid {
    let mesh = &model.mesh;
    let (displacements, factors) = deformation(model, step);
    let mut point_fields = vec![real("displacement", 3, displacements.iter().flatten().copied().collect())];
    let mut at_nodes = model.nodal_stresses(&factors, &displacements);
    if !model.contact.nodes.is_empty() {
        let contact: Vec<ContactPoint> = points(model, 0..model.contact.nodes.len(), step);
        for point in &contact {
            at_nodes[point.node] = point.stress;
        }
        point_fields.extend(contact_fields(model, step, &contact));
    }
    point_fields.push(real("nodal_stress", 9, tensors(&at_nodes)));
    point_fields.push(real("nodal_von_mises", 1, at_nodes.into_iter().map(von_mises).collect()));
    let stresses = model.stresses(&factors, &displacements);
    let mut cell_fields = vec![
        real("stress", 9, tensors(&stresses)),
        real("principal_stress", 3, stresses.iter().flat_map(|&stress| principal_stresses(stress)).collect()),
        real("von_mises", 1, stresses.iter().copied().map(von_mises).collect()),
        whole("material", materials(model)),
    ];
    let bodies = mesh.bodies();
    if bodies.are_several() {
        cell_fields.push(whole("body", bodies.of_cells().iter().map(|&k| k as i32).collect()));
    }
    let error = ElementEstimate::new(model, &factors, &displacements, &[]).discretisation;
    let of_cells = error.map_or_else(|| vec![0.0; mesh.cells.len()], |error| error.of_cells);
    cell_fields.push(real("discretisation_error", 1, of_cells));
    cell_fields.extend(ranks(model).map(|ranks| whole(RANK, ranks)));
    let cells = mesh.cells.iter().map(|cell| (cell.nodes.clone(), cell.kind.vtk())).collect();
    Grid { units: model.units(), points: mesh.nodes.clone(), cells, point_fields, cell_fields }
}

/// Returns all nine components of stresses, row by row.
fn tensors(stresses: &[[f64; 6]]) -> Vec<f64> {
    stresses.iter().flat_map(|&[xx, yy, zz, xy, yz, zx]| [xx, xy, zx, xy, yy, yz, zx, yz, zz]).collect()
}

/// The names of all fields.
#[cfg(test)]
pub(super) const NAMES: [&str; 16] = [
    "displacement",
    "contact_pressure",
    "patch_pressure",
    "tangential_traction",
    "slip",
    "opening",
    "contact",
    "nodal_stress",
    "nodal_von_mises",
    "stress",
    "principal_stress",
    "von_mises",
    "material",
    "body",
    "discretisation_error",
    RANK,
];

fn contact_fields(model: &Model, step: &IncrementView<'_>, points: &[ContactPoint]) -> Vec<Field> {
    let n = model.mesh.nodes.len();
    let (mut pressure, mut patch) = (vec![f64::NAN; n], vec![f64::NAN; n]);
    let mut patches = false;
    let (mut traction, mut slip) = (vec![[f64::NAN; 3]; n], vec![[f64::NAN; 3]; n]);
    let (mut gap, mut status) = (vec![f64::NAN; n], vec![-1; n]);
    for (contact, point) in model.contact.nodes.iter().zip(points) {
        let node = contact.node;
        if pressure[node] >= point.sigma_n {
            continue;
        }
        let [t, o] = contact.frame;
        let along = |a: f64, b: f64| [0, 1, 2].map(|c| a * t[c] + b * o[c]);
        pressure[node] = point.sigma_n;
        if let Some(sigma_patch) = point.sigma_patch {
            patch[node] = sigma_patch;
            patches = true;
        }
        traction[node] = along(point.sigma_t, point.sigma_o);
        slip[node] = along(point.slip_t, point.slip_o);
        gap[node] = point.gap;
        status[node] = match point.status {
            ContactStatus::Open => 0,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        };
    }
    let masters = model.master_tractions(step.state);
    let normals = masters.first().map(|_| nodal_normals(model));
    for (node, sigma) in masters {
        let normal = normals.as_ref().map_or([0.0; 3], |normals| normals[node]);
        let sigma_n = dot(sigma, normal);
        if pressure[node].is_nan() || pressure[node] < sigma_n {
            pressure[node] = sigma_n;
            traction[node] = across(sigma, normal);
        }
    }
    let mut fields = vec![
        real("contact_pressure", 1, pressure),
        real("tangential_traction", 3, traction.into_flattened()),
        real("slip", 3, slip.into_flattened()),
        real("opening", 1, gap),
        whole("contact", status),
    ];
    fields.extend(patches.then(|| real("patch_pressure", 1, patch)));
    fields
}

/// Returns the unit outward normal at each node of a master, the mean over its facets.
fn nodal_normals(model: &Model) -> Vec<[f64; 3]> {
    let mut normals = vec![[0.0; 3]; model.mesh.nodes.len()];
    for boundary in model.contact.pairs.iter().map(|pair| &pair.master) {
        for facet in &boundary.facets {
            let area = model.mesh.area_vector(facet);
            for &node in facet {
                normals[node] = plus(normals[node], 1.0, area);
            }
        }
    }
    normals.into_iter().map(|n| if norm(n) > 0.0 { unit(n) } else { n }).collect()
}

/// Returns a number for each cell's group and law.
fn materials(model: &Model) -> Vec<i32> {
    let mut different = Vec::new();
    let number = |(cell, law): (&Cell, _)| {
        let material = (cell.group, law);
        different.iter().position(|other| *other == material).unwrap_or_else(|| {
            different.push(material);
            different.len() - 1
        }) as i32
    };
    model.mesh.cells.iter().zip(model.materials()).map(number).collect()
}

/// Returns the rank of each cell if several share the body: the lowest rank of its nodes. Nodes without displacements
/// belong to the first rank.
fn ranks(model: &Model) -> Option<Vec<i32>> {
    let stiffness = model.problem.stiffness().distributed()?;
    let of = |cell: &Cell| cell.nodes.iter().filter_map(|node| stiffness.owner(*node)).min().unwrap_or(0) as i32;
    let ranks: Vec<i32> = model.mesh.cells.iter().map(of).collect();
    ranks.iter().any(|rank| *rank > 0).then_some(ranks)
}

fn real(name: &'static str, components: usize, values: Vec<f64>) -> Field {
    Field { name, components, values: Values::Real(values) }
}

fn whole(name: &'static str, values: Vec<i32>) -> Field {
    Field { name, components: 1, values: Values::Whole(values) }
}
