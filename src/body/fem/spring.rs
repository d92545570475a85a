//! Springs to the ground: elastic foundations of a boundary, and springs at single nodes.

use super::facet::{FacetPoint, facet_points};
use crate::algebra::vector::{axis, norm, unit};
use crate::body::mesh::{Boundary, Mesh};

/// An elastic resistance to displacements of a few nodes; the stiffness is for the components x, y and z node by node.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    nodes: Vec<usize>,
    /// The stiffness, N/m; in two dimensions per unit depth.
    stiffness: Vec<Vec<f64>>,
}

/// The stiffness of a foundation per area, N/m³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bedding {
    /// Along x, y and z.
    Axes([f64; 3]),
    /// Along the outward normal and tangentially.
    Surface {
        /// The stiffness along the normal.
        normal: f64,
        /// The tangential stiffness.
        tangential: f64,
    },
}

impl Bedding {
    /// Returns the stiffness (N/m³) as a matrix, where `n` is the outward normal.
    fn matrix(self, n: [f64; 3]) -> [[f64; 3]; 3] {
        match self {
            Bedding::Axes(k) => [0, 1, 2].map(|r| axis(r).map(|c| k[r] * c)),
            Bedding::Surface { normal, tangential } => {
                let entry = |r: usize, c: usize| (normal - tangential) * n[r] * n[c];
                [0, 1, 2].map(|r| [0, 1, 2].map(|c| entry(r, c) + if r == c { tangential } else { 0.0 }))
            }
        }
    }
}

impl Spring {
    /// Creates a spring of `stiffness` (N/m, along x, y and z) between `node` and the ground.
    pub fn at_node(node: usize, stiffness: [f64; 3]) -> Self {
        Spring { nodes: vec![node], stiffness: [0, 1, 2].map(|r| axis(r).map(|c| stiffness[r] * c).to_vec()).into() }
    }

    /// Creates the springs of a foundation under `boundary`, one for each facet: `∫ N_a k N_b dA`.
    pub fn foundation(mesh: &Mesh, boundary: &Boundary, bedding: Bedding) -> Vec<Self> {
        let of_facet = |facet: &Vec<usize>| {
            let mut stiffness = vec![vec![0.0; 3 * facet.len()]; 3 * facet.len()];
            for FacetPoint { shape, area, .. } in facet_points(mesh, facet) {
                let (k, d_area) = (bedding.matrix(unit(area)), norm(area));
                for (row, entries) in stiffness.iter_mut().enumerate() {
                    for (column, entry) in entries.iter_mut().enumerate() {
                        *entry += shape[row / 3] * shape[column / 3] * d_area * k[row % 3][column % 3];
                    }
                }
            }
            Spring { nodes: facet.clone(), stiffness }
        };
        boundary.facets.iter().map(of_facet).collect()
    }

    /// Computes its energy (J) for `displacements` of all nodes, m.
    pub fn energy(&self, displacements: &[[f64; 3]]) -> f64 {
        let u = |k: usize| displacements[self.nodes[k / 3]][k % 3];
        let of_row = |(row, entries): (usize, &'_ Vec<f64>)| {
            entries.iter().enumerate().map(|(column, value)| u(row) * value * u(column)).collect::<Vec<_>>()
        };
        0.5 * self.stiffness.iter().enumerate().flat_map(of_row).sum::<f64>()
    }

    /// Returns its stiffness (N/m) for the components x, y and z of its nodes.
    pub fn stiffness(&self) -> &[Vec<f64>] {
        &self.stiffness
    }

    /// Returns the nodes that it holds.
    pub fn nodes(&self) -> &[usize] {
        &self.nodes
    }

    /// Computes the forces (N) that it exerts on its nodes for the displacements `u` (m, all nodes of the mesh).
    pub fn forces<'a>(&'a self, u: &'a [[f64; 3]]) -> impl Iterator<Item = (usize, [f64; 3])> + 'a {
        let along =
            |row: &Vec<f64>| -> f64 { row.iter().enumerate().map(|(c, k)| -k * u[self.nodes[c / 3]][c % 3]).sum() };
        self.nodes
            .iter()
            .enumerate()
            .map(move |(a, &node)| (node, [0, 1, 2].map(|c| along(&self.stiffness[3 * a + c]))))
    }

    /// Returns nodes and directions in which it resists a motion.
    pub fn resisted(&self) -> impl Iterator<Item = (usize, [f64; 3])> + '_ {
        self.nodes.iter().enumerate().flat_map(move |(a, &node)| {
            let row = move |c: usize| [0, 1, 2].map(|d| self.stiffness[3 * a + c][3 * a + d]);
            (0..3).map(row).filter(|n| norm(*n) > 0.0).map(move |n| (node, unit(n)))
        })
    }
}
