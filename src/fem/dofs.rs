//! The numbering of the free displacements.

use crate::mesh::Mesh;

/// Which displacement components are unknowns, and their numbers. Supported components are
/// eliminated: they have no number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Dofs {
    of_node: Vec<[Option<usize>; 2]>,
    free: usize,
}

impl Dofs {
    /// Numbers node by node every component for which `fixed(node, component)` is false.
    pub fn new(mesh: &Mesh, fixed: impl Fn(usize, usize) -> bool) -> Self {
        let mut free = 0;
        let mut number = |fixed: bool| {
            (!fixed).then(|| {
                free += 1;
                free - 1
            })
        };
        let of_node = (0..mesh.nodes.len()).map(|node| [0, 1].map(|c| number(fixed(node, c)))).collect();
        Dofs { of_node, free }
    }

    /// The number of unknown displacements, n_u.
    pub fn free(&self) -> usize {
        self.free
    }

    /// The unknowns of `node` along x and y; `None` where a support holds it.
    pub fn node(&self, node: usize) -> [Option<usize>; 2] {
        self.of_node[node]
    }

    /// The node of an unknown.
    pub fn node_of(&self, dof: usize) -> Option<usize> {
        self.of_node.iter().position(|dofs| dofs.contains(&Some(dof)))
    }

    /// The eight unknowns of an element, corner by corner.
    pub fn element(&self, quad: &[usize; 4]) -> [Option<usize>; 8] {
        let mut dofs = [None; 8];
        for (a, &node) in quad.iter().enumerate() {
            dofs[2 * a..2 * a + 2].copy_from_slice(&self.of_node[node]);
        }
        dofs
    }

    /// The displacement of every node (m) from the vector `u` of unknowns; 0 where supported.
    pub fn displacements(&self, u: &[f64]) -> Vec<[f64; 2]> {
        self.of_node.iter().map(|dofs| dofs.map(|dof| dof.map_or(0.0, |d| u[d]))).collect()
    }
}
