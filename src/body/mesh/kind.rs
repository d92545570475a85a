//! The kinds of cells and the table of their properties.

use serde::{Deserialize, Serialize};

use super::rules::{self, Rule};

/// The kinds of cells. Nodes are in the order of VTK: first the corners, then, in cells of second order, the nodes at
/// the middles of the edges, at last those within the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CellKind {
    /// Three corners, counterclockwise.
    Triangle,
    /// Four corners, counterclockwise.
    Quadrilateral,
    /// Four corners: the first three are counterclockwise seen from the fourth.
    Tetrahedron,
    /// Eight corners: four counterclockwise seen from inside, then those above them.
    Hexahedron,
    /// Six corners: three counterclockwise seen from the other three, then the other three above them.
    Prism,
    /// A triangle with nodes at the middles of its edges, from corner 0 to 1, 1 to 2 and 2 to 0, which may be curved.
    Triangle6,
    /// A tetrahedron with nodes at the middles of its edges, from corner 0 to 1, 1 to 2, 2 to 0, 0 to 3, 1 to 3 and 2
    /// to 3, which may be curved.
    Tetrahedron10,
    /// A quadrilateral with nodes at the middles of its edges, from corner 0 to 1, 1 to 2, 2 to 3 and 3 to 0, which may
    /// be curved.
    Quadrilateral8,
    /// The quadrilateral of eight nodes with another at its centre.
    Quadrilateral9,
    /// A hexahedron with nodes at the middles of its edges, which may be curved: those around the first four corners,
    /// those around the other four, and those between the two.
    Hexahedron20,
    /// A prism with nodes at the middles of its edges, which may be curved: those around the first three corners, those
    /// around the other three, and those between the two.
    Prism15,
}

/// The shape functions of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Functions {
    /// The barycentric coordinates of a simplex.
    Linear,
    /// Quadratic functions on a simplex.
    Quadratic,
    /// Products of linear functions along the axes of a square or cube.
    Multilinear,
    /// Products of the functions of a triangle and linear functions normal to it.
    Prismatic,
    /// The functions of [`Functions::Multilinear`] and their products with one of the coordinates, for nodes at the
    /// middles of edges but none within the cell.
    Serendipity,
    /// Products of quadratic functions along the axes of a square.
    Multiquadratic,
    /// The functions of [`Functions::Serendipity`] for a prism.
    SerendipityPrism,
}

/// The properties of a kind of cell.
pub(super) struct Properties {
    /// The name of the kind.
    pub name: &'static str,
    pub functions: Functions,
    /// For each corner, the corners at the other ends of its edges, as many as there are dimensions, in right-handed
    /// order; for a tetrahedron one corner suffices.
    pub neighbours: &'static [&'static [usize]],
    /// The corners at the ends of the edge of each node on an edge.
    pub edges: &'static [[usize; 2]],
    /// The corners around each node within the cell.
    pub around: &'static [&'static [usize]],
    /// The order of the nodes that reverses the orientation of a cell.
    pub mirrored: &'static [usize],
    /// The sides, oriented as in [`super::Facet`].
    pub sides: &'static [&'static [usize]],
    /// The rule for the stiffness.
    pub rule: fn() -> Rule,
    /// The rule for loads, of a higher degree.
    pub fine_rule: fn() -> Rule,
    /// Gmsh's number of the type.
    pub gmsh: i64,
    /// The index of each node in the order of Gmsh.
    pub gmsh_order: &'static [usize],
    /// VTK's number of the type.
    pub vtk: u8,
}

const TRIANGLE: Properties = Properties {
    name: "triangle",
    functions: Functions::Linear,
    neighbours: &[&[1, 2], &[2, 0], &[0, 1]],
    edges: &[],
    around: &[],
    mirrored: &[2, 1, 0],
    sides: &[&[0, 1], &[1, 2], &[2, 0]],
    rule: rules::triangle1,
    fine_rule: rules::triangle3,
    gmsh: 2,
    gmsh_order: &[0, 1, 2],
    vtk: 5,
};

const QUADRILATERAL: Properties = Properties {
    name: "quadrilateral",
    functions: Functions::Multilinear,
    neighbours: &[&[1, 3], &[2, 0], &[3, 1], &[0, 2]],
    edges: &[],
    around: &[],
    mirrored: &[3, 2, 1, 0],
    sides: &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
    rule: rules::square4,
    fine_rule: rules::square4,
    gmsh: 3,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 9,
};

const TETRAHEDRON: Properties = Properties {
    name: "tetrahedron",
    functions: Functions::Linear,
    neighbours: &[&[1, 2, 3]],
    edges: &[],
    around: &[],
    mirrored: &[1, 0, 2, 3],
    sides: &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
    rule: rules::tetrahedron1,
    fine_rule: rules::tetrahedron4,
    gmsh: 4,
    gmsh_order: &[0, 1, 2, 3],
    vtk: 10,
};

const HEXAHEDRON: Properties = Properties {
    name: "hexahedron",
    functions: Functions::Multilinear,
    neighbours: &[&[1, 3, 4], &[2, 0, 5], &[3, 1, 6], &[0, 2, 7], &[7, 5, 0], &[4, 6, 1], &[5, 7, 2], &[6, 4, 3]],
    edges: &[],
    around: &[],
    mirrored: &[4, 5, 6, 7, 0, 1, 2, 3],
    sides: &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    rule: rules::cube8,
    fine_rule: rules::cube8,
    gmsh: 5,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 12,
};

const PRISM: Properties = Properties {
    name: "prism",
    functions: Functions::Prismatic,
    neighbours: &[&[1, 2, 3], &[2, 0, 4], &[0, 1, 5], &[5, 4, 0], &[3, 5, 1], &[4, 3, 2]],
    edges: &[],
    around: &[],
    mirrored: &[3, 4, 5, 0, 1, 2],
    sides: &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
    // With one point in the triangle, the prism would have a zero-energy mode.
    rule: rules::prism6,
    fine_rule: rules::prism6,
    gmsh: 6,
    gmsh_order: &[0, 1, 2, 3, 4, 5],
    vtk: 13,
};

const TRIANGLE6: Properties = Properties {
    name: "triangle of six nodes",
    functions: Functions::Quadratic,
    edges: &[[0, 1], [1, 2], [2, 0]],
    mirrored: &[2, 1, 0, 4, 3, 5],
    sides: &[&[0, 3, 1], &[1, 4, 2], &[2, 5, 0]],
    rule: rules::triangle3,
    fine_rule: rules::triangle6,
    gmsh: 9,
    gmsh_order: &[0, 1, 2, 3, 4, 5],
    vtk: 22,
    ..TRIANGLE
};

const TETRAHEDRON10: Properties = Properties {
    name: "tetrahedron of ten nodes",
    functions: Functions::Quadratic,
    edges: &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
    mirrored: &[1, 0, 2, 3, 4, 6, 5, 8, 7, 9],
    sides: &[&[0, 6, 2, 5, 1, 4], &[0, 4, 1, 8, 3, 7], &[1, 5, 2, 9, 3, 8], &[0, 7, 3, 9, 2, 6]],
    // Four points are exact on straight edges.
    rule: rules::tetrahedron4,
    fine_rule: rules::tetrahedron27,
    gmsh: 11,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    vtk: 24,
    ..TETRAHEDRON
};

const QUADRILATERAL8: Properties = Properties {
    name: "quadrilateral of eight nodes",
    functions: Functions::Serendipity,
    edges: &[[0, 1], [1, 2], [2, 3], [3, 0]],
    mirrored: &[3, 2, 1, 0, 6, 5, 4, 7],
    sides: &[&[0, 4, 1], &[1, 5, 2], &[2, 6, 3], &[3, 7, 0]],
    // Exact for the gradients times the determinant of curved edges, too, and times the distance from an axis.
    rule: rules::square9,
    fine_rule: rules::square9,
    gmsh: 16,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7],
    vtk: 23,
    ..QUADRILATERAL
};

const QUADRILATERAL9: Properties = Properties {
    name: "quadrilateral of nine nodes",
    functions: Functions::Multiquadratic,
    around: &[&[0, 1, 2, 3]],
    mirrored: &[3, 2, 1, 0, 6, 5, 4, 7, 8],
    gmsh: 10,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 8],
    vtk: 28,
    ..QUADRILATERAL8
};

const HEXAHEDRON20: Properties = Properties {
    name: "hexahedron of twenty nodes",
    functions: Functions::Serendipity,
    edges: &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]],
    mirrored: &[4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19],
    sides: &[
        &[0, 11, 3, 10, 2, 9, 1, 8],
        &[4, 12, 5, 13, 6, 14, 7, 15],
        &[0, 8, 1, 17, 5, 12, 4, 16],
        &[1, 9, 2, 18, 6, 13, 5, 17],
        &[2, 10, 3, 19, 7, 14, 6, 18],
        &[3, 11, 0, 16, 4, 15, 7, 19],
    ],
    // Exact for the gradients times the determinant of curved edges, too.
    rule: rules::cube27,
    fine_rule: rules::cube27,
    gmsh: 17,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    vtk: 25,
    ..HEXAHEDRON
};

const PRISM15: Properties = Properties {
    name: "prism of fifteen nodes",
    functions: Functions::SerendipityPrism,
    edges: &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
    mirrored: &[3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8, 12, 13, 14],
    sides: &[
        &[0, 8, 2, 7, 1, 6],
        &[3, 9, 4, 10, 5, 11],
        &[0, 6, 1, 13, 4, 9, 3, 12],
        &[1, 7, 2, 14, 5, 10, 4, 13],
        &[2, 8, 0, 12, 3, 11, 5, 14],
    ],
    // A prism whose ends are not parallel fails the patch test with three points in the triangle.
    rule: rules::prism18,
    fine_rule: rules::prism18,
    gmsh: 18,
    gmsh_order: &[0, 1, 2, 3, 4, 5, 6, 9, 7, 12, 14, 13, 8, 10, 11],
    vtk: 26,
    ..PRISM
};

/// The corners of the cube [-1, 1]³; the corners of the square are the first four, without ζ.
const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// The corners of the reference tetrahedron; the corners of the triangle are the first three.
const SIMPLEX: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl CellKind {
    /// All kinds.
    pub const ALL: [CellKind; 11] = [
        CellKind::Triangle,
        CellKind::Quadrilateral,
        CellKind::Tetrahedron,
        CellKind::Hexahedron,
        CellKind::Prism,
        CellKind::Triangle6,
        CellKind::Tetrahedron10,
        CellKind::Quadrilateral8,
        CellKind::Quadrilateral9,
        CellKind::Hexahedron20,
        CellKind::Prism15,
    ];

    pub(super) fn properties(self) -> &'static Properties {
        match self {
            CellKind::Triangle => &TRIANGLE,
            CellKind::Quadrilateral => &QUADRILATERAL,
            CellKind::Tetrahedron => &TETRAHEDRON,
            CellKind::Hexahedron => &HEXAHEDRON,
            CellKind::Prism => &PRISM,
            CellKind::Triangle6 => &TRIANGLE6,
            CellKind::Tetrahedron10 => &TETRAHEDRON10,
            CellKind::Quadrilateral8 => &QUADRILATERAL8,
            CellKind::Quadrilateral9 => &QUADRILATERAL9,
            CellKind::Hexahedron20 => &HEXAHEDRON20,
            CellKind::Prism15 => &PRISM15,
        }
    }

    /// Returns the default kind of cells of a block with `axes` axes.
    pub(super) fn of_block(axes: usize) -> Self {
        if axes == 2 { CellKind::Quadrilateral } else { CellKind::Hexahedron }
    }

    /// Returns the kind with the same corners and nodes at the middles of the edges; `None` if it has such nodes.
    pub(super) fn of_second_order(self) -> Option<Self> {
        match self {
            CellKind::Triangle => Some(CellKind::Triangle6),
            CellKind::Quadrilateral => Some(CellKind::Quadrilateral8),
            CellKind::Tetrahedron => Some(CellKind::Tetrahedron10),
            CellKind::Hexahedron => Some(CellKind::Hexahedron20),
            CellKind::Prism => Some(CellKind::Prism15),
            _ => None,
        }
    }

    /// Returns the name of the kind.
    pub fn name(self) -> &'static str {
        self.properties().name
    }

    /// Returns `true` for triangles and tetrahedra.
    pub fn is_simplex(self) -> bool {
        matches!(self.properties().functions, Functions::Linear | Functions::Quadratic)
    }

    /// Returns `true` for prisms.
    pub fn is_prism(self) -> bool {
        matches!(self.properties().functions, Functions::Prismatic | Functions::SerendipityPrism)
    }

    /// Returns `true` if there are nodes at the middles of the edges.
    pub fn is_quadratic(self) -> bool {
        !self.properties().edges.is_empty()
    }

    /// Returns the dimension, 2 or 3.
    pub fn dimension(self) -> usize {
        self.properties().neighbours[0].len()
    }

    /// Returns the centre of the reference cell. Coordinates go from -1 to 1; in a triangle or tetrahedron, and across
    /// the axis of a prism, from 0 to 1.
    pub fn centre(self) -> [f64; 3] {
        match self.dimension() {
            _ if self.is_prism() => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            _ if !self.is_simplex() => [0.0; 3],
            2 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            _ => [0.25; 3],
        }
    }

    /// Returns the number of corners.
    pub fn corners(self) -> usize {
        let Properties { edges, around, gmsh_order, .. } = self.properties();
        gmsh_order.len() - edges.len() - around.len()
    }

    /// Returns the number of nodes.
    pub fn nodes(self) -> usize {
        self.properties().gmsh_order.len()
    }

    /// Returns the nodes of each side, oriented as in [`super::Facet`].
    pub(crate) fn sides(self) -> &'static [&'static [usize]] {
        self.properties().sides
    }

    /// Returns the corners between which node `k` is: the ends of its edge, or those around it; none for a corner.
    pub(crate) fn between(self, k: usize) -> &'static [usize] {
        let Properties { edges, around, .. } = self.properties();
        let Some(middle) = k.checked_sub(self.corners()) else { return &[] };
        match edges.get(middle) {
            Some(ends) => ends,
            None => around[middle - edges.len()],
        }
    }

    /// Returns the position of node `k` in the reference cell.
    pub(crate) fn reference_node(self, k: usize) -> [f64; 3] {
        let corner = |k: usize| match self.dimension() {
            _ if self.is_prism() => [SIMPLEX[k % 3][0], SIMPLEX[k % 3][1], CUBE[4 * (k / 3)][2]],
            _ if self.is_simplex() => SIMPLEX[k],
            2 => [CUBE[k][0], CUBE[k][1], 0.0],
            _ => CUBE[k],
        };
        match self.between(k) {
            [] => corner(k),
            of => [0, 1, 2].map(|c| of.iter().map(|&k| corner(k)[c]).sum::<f64>() / of.len() as f64),
        }
    }

    /// VTK's number of the kind.
    pub fn vtk(self) -> u8 {
        self.properties().vtk
    }
}
