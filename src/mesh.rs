//! Meshes of quadrilaterals with named boundaries.

mod block;

pub use block::block;

/// A two-dimensional mesh of bilinear quadrilaterals.
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
}

impl Boundary {
    /// The nodes of the boundary, each once, in the order of its edges.
    pub fn nodes(&self) -> Vec<usize> {
        let mut nodes: Vec<usize> = Vec::with_capacity(self.edges.len() + 1);
        for &[a, b] in &self.edges {
            if nodes.last() != Some(&a) {
                nodes.push(a);
            }
            nodes.push(b);
        }
        nodes
    }
}
