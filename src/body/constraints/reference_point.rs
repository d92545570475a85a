//! Reference points: two nodes outside the mesh whose unknowns are the motion of a rigid part.
//!
//! A node at `x` that a point at `p` carries moves by `u(x) = U + θ × (x - p)`. The first node of the point has the
//! translation `U` as its displacement, the second one `r θ`, where the length `r` gives the unknowns one size; in two
//! dimensions its first component is `r θ_z`, and the second is held.

use crate::algebra::vector::{minus, norm, plus};
use crate::body::mesh::Mesh;

/// A point that carries nodes of a mesh as a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePoint {
    /// Its position, m.
    pub position: [f64; 3],
    /// The length `r` by which rotations are multiplied, m.
    pub radius: f64,
    /// A node that it carries.
    pub carried: usize,
}

impl ReferencePoint {
    /// Creates the point at `position` (m) that carries `nodes` of `mesh`, which must not be empty.
    pub fn new(mesh: &Mesh, position: [f64; 3], nodes: &[usize]) -> Self {
        let arm = |node: &usize| norm(minus(mesh.nodes[*node], position));
        let radius = nodes.iter().map(arm).fold(0.0, f64::max);
        let radius = if radius > 0.0 { radius } else { mesh.size() };
        ReferencePoint { position, radius, carried: nodes.first().copied().unwrap_or(0) }
    }

    /// Returns the displacement of its second node for a `rotation`, rad.
    pub fn of_rotation(&self, dimension: usize, rotation: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = rotation.map(|angle| self.radius * angle);
        if dimension == 2 { [z, 0.0, 0.0] } else { [x, y, z] }
    }

    /// Returns the matrix `θ × (x - p)` of the displacement of the second node.
    pub(super) fn arm(&self, dimension: usize, x: [f64; 3]) -> [[f64; 3]; 3] {
        let [x, y, z] = minus(x, self.position).map(|arm| arm / self.radius);
        match dimension {
            2 => [[-y, 0.0, 0.0], [x, 0.0, 0.0], [0.0; 3]],
            _ => [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]],
        }
    }
}

/// The jump between the two sides of a glued pair.
#[derive(Debug, Clone, PartialEq)]
pub struct Jump {
    /// A node of the mesh on the first side.
    pub node: usize,
    /// The jump as the sum `Σ c u` of displacements of nodes; empty if it is held along all axes.
    pub sum: Vec<(usize, f64)>,
}

impl Jump {
    /// Returns the jump for the displacements `u` of the nodes of the mesh, m.
    pub(super) fn at(&self, u: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
        self.sum.iter().fold([0.0; 3], |sum, &(node, c)| plus(sum, c, u(node)))
    }
}
