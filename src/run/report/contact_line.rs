//! The state of every contact node at the end of an increment.

use serde::Serialize;

use super::csv;
use super::deformation::deformation;
use super::principal::von_mises;
use super::quantities::Columns;
use crate::algebra::vector::{dot, minus, norm};
use crate::base::units::UnitSystem;
use crate::body::contact::ContactBoundary;
use crate::body::estimate::ContactGraph;
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;

/// One contact node at the end of an increment, SI.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactPoint {
    /// The number of the node in the mesh, from 0.
    pub node: usize,
    /// Position, m.
    pub x: f64,
    /// Position, m.
    pub y: f64,
    /// Position, m; 0 in two dimensions, as are the components below that exist only in space.
    pub z: f64,
    /// Distance along the contact boundary from its first node, m.
    pub s: f64,
    /// Normal contact force, N, in two dimensions per unit depth, positive in compression.
    pub p_n: f64,
    /// Tangential contact force of the body on the obstacle along the first tangent, N, in two dimensions per unit
    /// depth.
    pub p_t: f64,
    /// Tangential contact force along the second tangent, N.
    pub p_o: f64,
    /// Normal contact stress `p_n / l` (32), Pa. On boundaries of second order it is corrected and may be negative. At
    /// a node beyond the end of the other body it is the mean over the nodes of its facets.
    pub sigma_n: f64,
    /// Tangential contact stress `p_t / l` (32), Pa.
    pub sigma_t: f64,
    /// Tangential contact stress `p_o / l`, Pa.
    pub sigma_o: f64,
    /// Normal stress of the node together with its neighbours, `Σ p_n / Σ l`, Pa; with tetrahedra only.
    pub sigma_patch: Option<f64>,
    /// Normal contact displacement, m, positive towards the obstacle.
    pub w_n: f64,
    /// Tangential contact displacement along the first tangent, m.
    pub w_t: f64,
    /// Tangential contact displacement along the second tangent, m.
    pub w_o: f64,
    /// Remaining distance from the obstacle, m.
    pub gap: f64,
    /// Motion relative to the obstacle along the first tangent since the beginning, m.
    pub slip_t: f64,
    /// Motion relative to the obstacle along the second tangent since the beginning, m.
    pub slip_o: f64,
    /// Total force of the body on the obstacle, N.
    pub force: [f64; 3],
    /// The outward normal of the body and the two tangents of the obstacle, which define the components.
    pub frame: [[f64; 3]; 3],
    /// Friction coefficient.
    pub mu: f64,
    /// Contact status.
    pub status: ContactStatus,
    /// Normal stress along the surface, in the direction of the first tangent, Pa; see [`SurfaceStress`].
    ///
    /// [`SurfaceStress`]: crate::body::SurfaceStress
    pub sigma_along: f64,
    /// Normal stress along the surface at right angles to it, Pa: in two dimensions out of the plane, the hoop stress of
    /// a body of revolution.
    pub sigma_across: f64,
    /// Shear stress between both directions in the surface, Pa; 0 in two dimensions.
    pub sigma_shear: f64,
    /// The whole stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)`, Pa.
    pub stress: [f64; 6],
}

/// The contact nodes of one boundary, in order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ContactLine {
    /// The boundary, if the scene has contact on several.
    pub boundary: Option<String>,
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The number of dimensions, 2 or 3. In space the contact nodes form a surface, and `s` is meaningless.
    pub dimension: usize,
    /// The points, one per node.
    pub points: Vec<ContactPoint>,
    /// The key of the obstacle that each node meets, if several are in front of the boundary; otherwise empty.
    pub obstacles: Vec<String>,
    /// The units for tables and pictures.
    pub units: UnitSystem,
}

impl ContactLine {
    /// Returns the contact lines of a step, one for each boundary with contact.
    pub fn all(model: &Model, step: &IncrementView<'_>) -> Vec<Self> {
        let several = model.contact.boundaries.len() > 1;
        let line = |boundary: &ContactBoundary| ContactLine {
            boundary: several.then(|| boundary.name.clone()),
            index: step.record.index,
            time: step.record.time,
            dimension: model.mesh.dimension,
            points: points(model, boundary.nodes.iter().copied(), step),
            obstacles: match boundary.obstacles.len() {
                0 | 1 => Vec::new(),
                _ => boundary
                    .nodes
                    .iter()
                    .filter_map(|&i| model.assigned(i, step.record.time))
                    .map(|(k, _)| model.obstacle_key(k))
                    .collect(),
            },
            units: model.units(),
        };
        model.contact.boundaries.iter().map(line).collect()
    }

    /// Formats the nodes as CSV. In three dimensions additional columns appear among those of the plane. The obstacles
    /// come last.
    pub fn to_csv(&self) -> String {
        let has_patches = self.points.iter().any(|point| point.sigma_patch.is_some());
        let is_there = |(name, components, _): &&NodeColumn| {
            *components <= self.units.components && (has_patches || *name != PATCH)
        };
        let [before, behind] = [&BEFORE[..], &BEHIND].map(|all| all.iter().filter(is_there).collect::<Vec<_>>());
        let names = |columns: &[&NodeColumn]| columns.iter().map(|column| column.0).collect::<Vec<_>>();
        let mut header = [names(&before), vec!["status"], names(&behind)].concat();
        header.extend((!self.obstacles.is_empty()).then_some("obstacle"));
        let [written_before, written_behind] =
            [&before, &behind].map(|columns| Columns::new(&self.units, names(columns)));
        let row = |(k, p): (usize, &ContactPoint)| {
            let values = |columns: &[&NodeColumn]| columns.iter().map(|column| (column.2)(p)).collect::<Vec<_>>();
            let status = match p.status {
                ContactStatus::Open => "open",
                ContactStatus::Stick => "stick",
                ContactStatus::Slip => "slip",
            };
            let cells = written_before.cells(values(&before)).chain([status.to_string()]);
            cells.chain(written_behind.cells(values(&behind))).chain(self.obstacles.get(k).cloned()).collect()
        };
        csv::table(&header, self.points.iter().enumerate().map(row))
    }
}

/// A column of numbers: its name, the number of dimensions from which on it is written, and its value.
type NodeColumn = (&'static str, usize, fn(&ContactPoint) -> f64);

/// The column that exists only with tetrahedra.
const PATCH: &str = "sigma_patch";

/// The columns before the status.
const BEFORE: [NodeColumn; 19] = [
    ("x", 2, |p| p.x),
    ("y", 2, |p| p.y),
    ("z", 3, |p| p.z),
    ("p_n", 2, |p| p.p_n),
    ("p_t", 2, |p| p.p_t),
    ("p_o", 3, |p| p.p_o),
    ("sigma_n", 2, |p| p.sigma_n),
    ("sigma_t", 2, |p| p.sigma_t),
    ("sigma_o", 3, |p| p.sigma_o),
    (PATCH, 3, |p| p.sigma_patch.unwrap_or(f64::NAN)),
    ("w_n", 2, |p| p.w_n),
    ("w_t", 2, |p| p.w_t),
    ("w_o", 3, |p| p.w_o),
    ("gap", 2, |p| p.gap),
    ("slip_t", 2, |p| p.slip_t),
    ("slip_o", 3, |p| p.slip_o),
    ("f_x", 2, |p| p.force[0]),
    ("f_y", 2, |p| p.force[1]),
    ("f_z", 3, |p| p.force[2]),
];

/// The columns after the status: the node, the directions of its components, and the stress in the surface.
const BEHIND: [NodeColumn; 14] = [
    ("node", 2, |p| p.node as f64),
    ("n_x", 2, |p| p.frame[0][0]),
    ("n_y", 2, |p| p.frame[0][1]),
    ("n_z", 3, |p| p.frame[0][2]),
    ("t_x", 2, |p| p.frame[1][0]),
    ("t_y", 2, |p| p.frame[1][1]),
    ("t_z", 3, |p| p.frame[1][2]),
    ("o_x", 3, |p| p.frame[2][0]),
    ("o_y", 3, |p| p.frame[2][1]),
    ("o_z", 3, |p| p.frame[2][2]),
    ("sigma_along", 2, |p| p.sigma_along),
    ("sigma_across", 2, |p| p.sigma_across),
    ("sigma_shear", 3, |p| p.sigma_shear),
    ("von_mises", 2, |p| von_mises(p.stress)),
];

/// Returns the names of all columns.
#[cfg(test)]
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    BEFORE.iter().chain(&BEHIND).map(|column| column.0).chain(["status", "obstacle"])
}

/// Returns the contact nodes `nodes` at the end of a step.
pub fn points(model: &Model, nodes: impl Iterator<Item = usize>, step: &IncrementView<'_>) -> Vec<ContactPoint> {
    let (problem, state) = (&model.problem, step.state);
    let tractions = model.recovered_tractions(state);
    let in_frame = |i: usize| model.contact.nodes[i].in_frame([state.p_t[i], state.p_o[i]]);
    let over_weights = |force: &dyn Fn(usize) -> f64| {
        if tractions.is_none() { model.over_weights(force) } else { Vec::new() }
    };
    let sigma_n = over_weights(&|i| state.p_n[i]);
    let [sigma_t, sigma_o] = [0, 1].map(|k| over_weights(&|i| in_frame(i)[k]));
    let tetrahedra = model.mesh.dimension == 3 && model.mesh.cells.iter().any(|cell| cell.kind.is_simplex());
    let patches = tetrahedra.then(|| ContactGraph::new(model).patch_pressures(model, &state.p_n));
    let drift = [0, 1].map(|k| model.loading.drift_at(step.record.time, k));
    let (displacements, factors) = deformation(model, step);
    let surface = model.surface_stresses_of(&factors, &displacements, state);
    let mut s = 0.0;
    let mut last: Option<[f64; 3]> = None;
    let point = |i: usize| {
        let position = model.contact.nodes[i].position;
        s += last.replace(position).map_or(0.0, |last| norm(minus(position, last)));
        let [x, y, z] = position;
        let contact = &model.contact.nodes[i];
        let p_n = state.p_n[i];
        // Displacements relative to the motion of supports, as for gaps and tangential motions of the obstacle.
        let gap = &step.increment.gap;
        let (relative, along) = if contact.coupled().is_some() {
            let normal = model.of_node_from_rows(i, |j| problem.c_n().dot(j, &state.u));
            let tangential = |k: usize| model.of_node_from_rows(i, |j| problem.tangential_maps()[k].dot(j, &state.u));
            (normal, [0, 1].map(tangential))
        } else if contact.ends.is_none() {
            (problem.c_n().dot(i, &state.u), problem.tangential_maps().map(|map| map.dot(i, &state.u)))
        } else {
            let own = |n: [f64; 3]| {
                model.constraints.dofs.along(contact.node, n).map(|(dof, c)| c * state.u[dof]).sum::<f64>()
            };
            (own(contact.facing.normal), contact.facing.tangents.map(own))
        };
        let moved = model.moved(i, step.record.time);
        let w_n = relative + moved[0];
        let w = [0, 1].map(|k| along[k] + moved[k + 1]);
        let [p_t, p_o] = in_frame(i);
        let [w_t, w_o] = contact.in_frame(w);
        let [slip_t, slip_o] = contact.in_frame([0, 1].map(|k| along[k] - drift[k][i]));
        let [t, o] = contact.frame;
        let [sigma_n, sigma_t, sigma_o] = match &tractions {
            None => [&sigma_n, &sigma_t, &sigma_o].map(|sigma| sigma[i]),
            Some(all) => [contact.facing.normal, t, o].map(|axis| dot(axis, all[i])),
        };
        ContactPoint {
            node: contact.node,
            frame: [contact.facing.normal, t, o],
            x,
            y,
            z,
            s,
            p_n,
            p_t,
            p_o,
            sigma_n,
            sigma_t,
            sigma_o,
            sigma_patch: patches.as_ref().map(|patches| patches[i]),
            w_n,
            w_t,
            w_o,
            gap: model.nodal_gap(i, step.record.time, gap) - relative,
            slip_t,
            slip_o,
            force: model.force_of_row(state, i),
            mu: step.increment.mu[i],
            status: step.statuses[i],
            sigma_along: surface[i].along,
            sigma_across: surface[i].across,
            sigma_shear: surface[i].shear,
            stress: surface[i].stress,
        }
    };
    nodes.map(point).collect()
}
