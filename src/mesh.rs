//! Meshes in two and three dimensions with named boundaries and material groups.

mod arrays;
mod block;
mod boundaries;
mod check;
mod gmsh;
mod half_plane;
mod sides;
mod simplices;
mod source;

pub use block::block;
pub use check::MeshFault;
pub(crate) use gmsh::faces;
pub use gmsh::{GmshError, MeshFileError, from_gmsh, gmsh};
pub use source::{HalfPlane, MeshError, MeshSource, Segment};

use serde::{Deserialize, Serialize};

use crate::vector::{cross, minus};

/// A mesh of the plane or of space. The dimension is data: points always have three coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// 2 or 3.
    pub dimension: usize,
    /// Node coordinates, m; z = 0 in two dimensions.
    pub nodes: Vec<[f64; 3]>,
    /// The cells, each of the mesh's dimension.
    pub cells: Vec<Cell>,
    /// The names of the material groups.
    pub groups: Vec<String>,
    /// The parts of the boundary that a scene can name.
    pub boundaries: Vec<Boundary>,
}

/// A cell of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cell {
    /// The kind of the cell.
    pub kind: CellKind,
    /// The corners of the cell, as many as the kind has, in the order of [`CellKind`].
    pub nodes: Vec<usize>,
    /// The material group of the cell, an index of [`Mesh::groups`].
    pub group: usize,
}

/// The kinds of cells. Corners are in the order of VTK and Gmsh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
}

/// The corners of a part of the boundary: an edge in two dimensions, a triangle or a quadrilateral
/// in three. An edge has the body on its left; a face is counterclockwise seen from outside.
pub type Facet = Vec<usize>;

/// A named part of the boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Boundary {
    /// The name a scene uses.
    pub name: String,
    /// The facets of the boundary; in two dimensions in a row.
    pub facets: Vec<Facet>,
}

impl CellKind {
    /// The cells of a block with so many axes, if nothing else is asked for.
    fn of_block(axes: usize) -> Self {
        if axes == 2 { CellKind::Quadrilateral } else { CellKind::Hexahedron }
    }

    /// Whether the cell is a triangle or a tetrahedron.
    pub fn is_simplex(self) -> bool {
        matches!(self, CellKind::Triangle | CellKind::Tetrahedron)
    }

    /// 2 or 3.
    pub fn dimension(self) -> usize {
        match self {
            CellKind::Triangle | CellKind::Quadrilateral => 2,
            CellKind::Tetrahedron | CellKind::Hexahedron => 3,
        }
    }

    /// The centre of the reference cell, whose coordinates go from -1 to 1, of a triangle or tetrahedron from 0 to 1.
    pub fn centre(self) -> [f64; 3] {
        match self {
            CellKind::Quadrilateral | CellKind::Hexahedron => [0.0; 3],
            CellKind::Triangle => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            CellKind::Tetrahedron => [0.25; 3],
        }
    }

    /// The number of corners.
    pub fn corners(self) -> usize {
        match self {
            CellKind::Triangle => 3,
            CellKind::Quadrilateral | CellKind::Tetrahedron => 4,
            CellKind::Hexahedron => 8,
        }
    }
}

impl Mesh {
    /// The boundary called `name`.
    pub fn boundary(&self, name: &str) -> Option<&Boundary> {
        self.boundaries.iter().find(|boundary| boundary.name == name)
    }

    /// The names of all boundaries.
    pub fn boundary_names(&self) -> Vec<&str> {
        self.boundaries.iter().map(|boundary| boundary.name.as_str()).collect()
    }

    /// The coordinates of `nodes`, m.
    pub fn points(&self, nodes: &[usize]) -> Vec<[f64; 3]> {
        nodes.iter().map(|&node| self.nodes[node]).collect()
    }

    /// The smallest and the largest coordinate along each axis, m.
    pub fn bounds(&self) -> [(f64, f64); 3] {
        [0, 1, 2].map(|c| {
            let wider = |(lo, hi): (f64, f64), x: &[f64; 3]| (lo.min(x[c]), hi.max(x[c]));
            self.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), wider)
        })
    }

    /// The centre of cell `e`, the mean of its corners, m.
    pub fn centre(&self, e: usize) -> [f64; 3] {
        let corners = self.points(&self.cells[e].nodes);
        [0, 1, 2].map(|c| corners.iter().map(|x| x[c]).sum::<f64>() / corners.len() as f64)
    }

    /// The lengths of the box around the body, m.
    pub fn extent(&self) -> [f64; 3] {
        self.bounds().map(|(lowest, highest)| highest - lowest)
    }

    /// The longest of these, m.
    pub fn size(&self) -> f64 {
        self.extent().into_iter().fold(0.0, f64::max)
    }

    /// The outward normal of a facet times its length (m) or area (m²): exact for curved bilinear faces,
    /// too, since the integral of the normal depends on the edges alone.
    pub fn area_vector(&self, facet: &[usize]) -> [f64; 3] {
        let corners = self.points(facet);
        let from = |k: usize| minus(corners[k], corners[0]);
        if self.dimension == 2 {
            let [dx, dy, _] = from(1);
            return [dy, -dx, 0.0];
        }
        let mut sum = [0.0; 3];
        for k in 2..corners.len() {
            let triangle = cross(from(k - 1), from(k));
            sum.iter_mut().zip(triangle).for_each(|(sum, c)| *sum += 0.5 * c);
        }
        sum
    }

    /// A point in words: `(x, y)` or `(x, y, z)`.
    pub fn place(&self, x: [f64; 3]) -> String {
        let [x, y, z] = x;
        if self.dimension == 2 { format!("({x}, {y})") } else { format!("({x}, {y}, {z})") }
    }
}

impl Boundary {
    /// The nodes of the boundary, each once, in the order of its facets. Edges may be listed along
    /// their direction or against it.
    pub fn nodes(&self) -> Vec<usize> {
        let mut seen = std::collections::HashSet::new();
        let against = self.facets.windows(2).any(|pair| pair[0].len() == 2 && pair[0][0] == pair[1][1]);
        let mut nodes = Vec::new();
        for facet in &self.facets {
            let in_order: &mut dyn Iterator<Item = &usize> =
                if against { &mut facet.iter().rev() } else { &mut facet.iter() };
            nodes.extend(in_order.copied().filter(|&node| seen.insert(node)));
        }
        nodes
    }
}
