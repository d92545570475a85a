//! The fields of a body at the end of an increment: displacement, stress, contact.

use super::vtu::{Field, Grid, Values};
use crate::contact::ContactStatus;
use crate::history::Step;
use crate::mesh::CellKind;
use crate::model::Model;

/// The body with its fields at the end of a step, SI.
///
/// Of points: `displacement`; and `contact_pressure` (Pa, `p_n / l` (32)), `tangential_traction` (Pa, the vector of the
/// body on the obstacle), `slip` (m, the vector of motion past the obstacle since the beginning), `gap` (m, the distance
/// that is left), all NaN off the contact; `status`: -1 off the contact, 0 open, 1 stick, 2 slip. A node that meets
/// two obstacles shows the one that presses more.
/// Of cells: `stress` (Pa, at the centre, all nine components row by row), `von_mises` (Pa), `material`, the number
/// of the material group.
pub fn fields(model: &Model, step: &Step<'_>) -> Grid {
    let mesh = &model.mesh;
    let displacements = model.dofs.displacements(&step.state.u);
    let mut point_fields = vec![real("displacement", 3, displacements.iter().flatten().copied().collect())];
    if !model.contacts.is_empty() {
        point_fields.extend(contact_fields(model, step));
    }
    let stresses = model.centre_stresses(&displacements);
    let tensors = stresses.iter().flat_map(|&[xx, yy, zz, xy, yz, zx]| [xx, xy, zx, xy, yy, yz, zx, yz, zz]);
    let cell_fields = vec![
        real("stress", 9, tensors.collect()),
        real("von_mises", 1, stresses.iter().map(von_mises).collect()),
        whole("material", mesh.cells.iter().map(|cell| cell.group as i32).collect()),
    ];
    let cells = mesh.cells.iter().map(|cell| (cell.nodes.clone(), vtk(cell.kind))).collect();
    Grid { points: mesh.nodes.clone(), cells, point_fields, cell_fields }
}

fn contact_fields(model: &Model, step: &Step<'_>) -> [Field; 5] {
    let (problem, state, n) = (&model.problem, step.state, model.mesh.nodes.len());
    let drift = [0, 1].map(|k| model.loading.drift_at(step.record.time, k));
    let mut pressure = vec![f64::NAN; n];
    let (mut traction, mut slip) = (vec![[f64::NAN; 3]; n], vec![[f64::NAN; 3]; n]);
    let (mut gap, mut status) = (vec![f64::NAN; n], vec![-1; n]);
    for (i, contact) in model.contacts.iter().enumerate() {
        let (node, l) = (contact.node, problem.weight[i]);
        if pressure[node] >= state.p_n[i] / l {
            continue;
        }
        let [t, o] = contact.facing.tangents;
        let along = |a: f64, b: f64| [0, 1, 2].map(|c| a * t[c] + b * o[c]);
        pressure[node] = state.p_n[i] / l;
        traction[node] = along(state.p_t[i] / l, state.p_o[i] / l);
        let past = |k: usize, w: f64| if contact.tangents[k].is_empty() { 0.0 } else { w - drift[k][i] };
        slip[node] = along(past(0, problem.c_t.dot(i, &state.u)), past(1, problem.c_o.dot(i, &state.u)));
        gap[node] = step.increment.gap[i] - problem.c_n.dot(i, &state.u);
        status[node] = match step.statuses[i] {
            ContactStatus::Open => 0,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        };
    }
    [
        real("contact_pressure", 1, pressure),
        real("tangential_traction", 3, traction.into_flattened()),
        real("slip", 3, slip.into_flattened()),
        real("gap", 1, gap),
        whole("status", status),
    ]
}

fn real(name: &'static str, components: usize, values: Vec<f64>) -> Field {
    Field { name, components, values: Values::Real(values) }
}

fn whole(name: &'static str, values: Vec<i32>) -> Field {
    Field { name, components: 1, values: Values::Whole(values) }
}

fn von_mises(&[xx, yy, zz, xy, yz, zx]: &[f64; 6]) -> f64 {
    let direct = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * direct + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

/// VTK's number of a kind of cell.
fn vtk(kind: CellKind) -> u8 {
    match kind {
        CellKind::Triangle => 5,
        CellKind::Quadrilateral => 9,
        CellKind::Tetrahedron => 10,
        CellKind::Hexahedron => 12,
    }
}
