//! The numbering of the free displacements.

use crate::mesh::Mesh;

/// Which displacement components are unknowns, and their numbers. Supported components are
/// eliminated: they have no number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dofs {
    dimension: usize,
    /// Node by node, as many as there are dimensions.
    numbers: Vec<Option<usize>>,
    free: usize,
}

impl Dofs {
    /// Numbers node by node every component for which `fixed(node, component)` is false.
    pub fn new(mesh: &Mesh, fixed: impl Fn(usize, usize) -> bool) -> Self {
        let dimension = mesh.dimension;
        let mut free = 0;
        let mut number = |fixed: bool| {
            (!fixed).then(|| {
                free += 1;
                free - 1
            })
        };
        let components = (0..mesh.nodes.len()).flat_map(|node| (0..dimension).map(move |c| (node, c)));
        let numbers = components.map(|(node, c)| number(fixed(node, c))).collect();
        Dofs { dimension, numbers, free }
    }

    /// The number of unknown displacements, n_u.
    pub fn free(&self) -> usize {
        self.free
    }

    /// The unknowns of `node` along x, y and, in three dimensions, z; `None` where a support holds it.
    pub fn node(&self, node: usize) -> &[Option<usize>] {
        &self.numbers[self.dimension * node..self.dimension * (node + 1)]
    }

    /// The node of an unknown.
    pub fn node_of(&self, dof: usize) -> Option<usize> {
        Some(self.numbers.iter().position(|&number| number == Some(dof))? / self.dimension)
    }

    /// The unknowns of an element with the corners `nodes`, corner by corner.
    pub fn element(&self, nodes: &[usize]) -> Vec<Option<usize>> {
        nodes.iter().flat_map(|&node| self.node(node)).copied().collect()
    }

    /// The displacement of every node (m) from the vector `u` of unknowns; 0 where supported.
    pub fn displacements(&self, u: &[f64]) -> Vec<[f64; 3]> {
        let node = |dofs: &[Option<usize>]| [0, 1, 2].map(|c| dofs.get(c).copied().flatten().map_or(0.0, |dof| u[dof]));
        self.numbers.chunks_exact(self.dimension).map(node).collect()
    }
}
