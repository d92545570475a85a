//! What there is to know of a kind of cell at the points of its rules, worked out once for all cells of a mesh.

use super::{CellKind, Geometry, Mesh, corner_shape, fine_quadrature, local_gradients, shape, stiffness_rule};

/// No cell has more nodes.
pub(crate) const MOST_NODES: usize = 10;

/// No cell has more corners.
const MOST_CORNERS: usize = 8;

/// A point of a rule on a reference cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReferencePoint {
    /// The weight of the point.
    pub weight: f64,
    /// The shape functions of the nodes there; 0 beyond the last.
    pub shape: [f64; MOST_NODES],
    /// Those of the corners alone, of [`corner_shape`].
    pub corners: [f64; MOST_CORNERS],
    /// `∂N_a/∂(ξ, η, ζ)` of the nodes.
    pub slopes: [[f64; 3]; MOST_NODES],
}

/// A kind of cell at the points of its rules.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCell {
    straight: Vec<ReferencePoint>,
    curved: Vec<ReferencePoint>,
    /// At those of [`fine_quadrature`].
    pub fine: Vec<ReferencePoint>,
}

impl ReferenceCell {
    fn new(kind: CellKind, geometry: Geometry) -> Self {
        let at = |(point, weight): ([f64; 3], f64)| {
            let (values, gradients) = (shape(kind, point), local_gradients(kind, point));
            let (mut shape, mut slopes) = ([0.0; MOST_NODES], [[0.0; 3]; MOST_NODES]);
            shape[..values.len()].copy_from_slice(&values);
            slopes[..gradients.len()].copy_from_slice(&gradients);
            let (of_corners, mut corners) = (corner_shape(kind, point), [0.0; MOST_CORNERS]);
            corners[..of_corners.len()].copy_from_slice(&of_corners);
            ReferencePoint { weight, shape, corners, slopes }
        };
        ReferenceCell {
            straight: stiffness_rule(kind, geometry, false).into_iter().map(at).collect(),
            curved: stiffness_rule(kind, geometry, true).into_iter().map(at).collect(),
            fine: fine_quadrature(kind).into_iter().map(at).collect(),
        }
    }

    /// At the points of [`super::quadrature_of`] the cell of this `kind` with these `nodes`.
    pub(crate) fn of(&self, kind: CellKind, nodes: &[[f64; 3]]) -> &[ReferencePoint] {
        if kind.is_curved(nodes) { &self.curved } else { &self.straight }
    }
}

/// The kinds of cells that a mesh has.
#[derive(Debug, Clone)]
pub(crate) struct ReferenceCells([Option<ReferenceCell>; CellKind::ALL.len()]);

impl ReferenceCells {
    /// Those of `mesh`.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        let mut cells = ReferenceCells(Default::default());
        for cell in &mesh.cells {
            cells.0[cell.kind as usize].get_or_insert_with(|| ReferenceCell::new(cell.kind, mesh.geometry));
        }
        cells
    }

    /// That of a kind that the mesh has.
    pub(crate) fn get(&self, kind: CellKind) -> Option<&ReferenceCell> {
        self.0[kind as usize].as_ref()
    }
}
