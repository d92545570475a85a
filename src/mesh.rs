//! Meshes of quadrilaterals with named boundaries.

mod block;
mod half_plane;

pub use block::{block, graded_block};
pub use half_plane::half_plane;

/// A two-dimensional mesh of four-node quadrilaterals.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Node coordinates, m.
    pub nodes: Vec<[f64; 2]>,
    /// The corner nodes of each element, counterclockwise.
    pub quads: Vec<[usize; 4]>,
    /// The parts of the boundary that a scene can name.
    pub boundaries: Vec<Boundary>,
}

/// A named part of the boundary.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Boundary {
    /// The name a scene uses.
    pub name: String,
    /// Edges in a row, each with the body on its left, so that `(dy, -dx)` points outwards.
    pub edges: Vec<[usize; 2]>,
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

    /// The vector along `edge`, m.
    pub fn edge_vector(&self, edge: [usize; 2]) -> [f64; 2] {
        let [a, b] = edge.map(|node| self.nodes[node]);
        [b[0] - a[0], b[1] - a[1]]
    }

    /// The corner coordinates of element `e`, m.
    pub fn corners(&self, e: usize) -> [[f64; 2]; 4] {
        self.quads[e].map(|node| self.nodes[node])
    }

    /// The centre of element `e`, the mean of its corners, m.
    pub fn centre(&self, e: usize) -> [f64; 2] {
        let corners = self.corners(e);
        [0, 1].map(|c| corners.iter().map(|x| x[c]).sum::<f64>() / 4.0)
    }
}

impl Boundary {
    /// The nodes of the boundary, each once, in the order of its edges. Edges may be listed along
    /// their direction or against it.
    pub fn nodes(&self) -> Vec<usize> {
        let mut seen = std::collections::HashSet::new();
        let against = self.edges.windows(2).any(|pair| pair[0][0] == pair[1][1]);
        let ends = self.edges.iter().flat_map(|&[a, b]| if against { [b, a] } else { [a, b] });
        ends.filter(|&node| seen.insert(node)).collect()
    }
}
