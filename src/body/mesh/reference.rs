//! Shape functions and gradients at the integration points of each kind of cell, computed once for all cells of a mesh.

use super::{CellKind, Geometry, Mesh, corner_shape, fine_quadrature, local_gradients, shape, stiffness_rule};

/// The largest number of nodes of a cell.
pub(crate) const MAX_NODES: usize = 20;

/// The largest number of corners of a cell.
const MAX_CORNERS: usize = 8;

/// A point of a rule on a reference cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReferencePoint {
    /// The weight of the point.
    pub weight: f64,
    /// The shape functions of the nodes; 0 beyond the last node.
    pub shape: [f64; MAX_NODES],
    /// The shape functions of the corners, see [`corner_shape`].
    pub corners: [f64; MAX_CORNERS],
    /// `∂N_a/∂(ξ, η, ζ)` of the nodes.
    pub slopes: [[f64; 3]; MAX_NODES],
}

/// A kind of cell at its integration points.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCell {
    straight: Vec<ReferencePoint>,
    curved: Vec<ReferencePoint>,
    /// The points of [`fine_quadrature`].
    pub fine: Vec<ReferencePoint>,
}

impl ReferenceCell {
    fn new(kind: CellKind, geometry: Geometry) -> Self {
        let at = |(point, weight): ([f64; 3], f64)| {
            let (values, gradients) = (shape(kind, point), local_gradients(kind, point));
            let (mut shape, mut slopes) = ([0.0; MAX_NODES], [[0.0; 3]; MAX_NODES]);
            shape[..values.len()].copy_from_slice(&values);
            slopes[..gradients.len()].copy_from_slice(&gradients);
            let (of_corners, mut corners) = (corner_shape(kind, point), [0.0; MAX_CORNERS]);
            corners[..of_corners.len()].copy_from_slice(&of_corners);
            ReferencePoint { weight, shape, corners, slopes }
        };
        ReferenceCell {
            straight: stiffness_rule(kind, geometry, false).into_iter().map(at).collect(),
            curved: stiffness_rule(kind, geometry, true).into_iter().map(at).collect(),
            fine: fine_quadrature(kind).into_iter().map(at).collect(),
        }
    }

    /// Returns the points of [`super::quadrature_of`] for the cell of this `kind` with these `nodes`.
    pub(crate) fn of(&self, kind: CellKind, nodes: &[[f64; 3]]) -> &[ReferencePoint] {
        if kind.is_curved(nodes) { &self.curved } else { &self.straight }
    }
}

/// The kinds of cells in a mesh.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCells([Option<ReferenceCell>; CellKind::ALL.len()]);

impl ReferenceCells {
    /// Computes the points of all kinds of cells in `mesh`.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut cells = ReferenceCells(Default::default());
        for cell in &mesh.cells {
            cells.0[cell.kind as usize].get_or_insert_with(|| ReferenceCell::new(cell.kind, mesh.geometry));
        }
        cells
    }

    /// Returns the points of a kind; `None` if the mesh has no such cells.
    pub(crate) fn get(&self, kind: CellKind) -> Option<&ReferenceCell> {
        self.0[kind as usize].as_ref()
    }
}
