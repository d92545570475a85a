//! Consistent nodal forces of boundary tractions.

use super::dofs::Dofs;
use crate::mesh::{Boundary, Mesh};

/// The nodal forces (N per unit depth, length n_u) of a uniform `traction` (N/m²) on `boundary`,
/// exact for the linear edges of bilinear elements: half of each edge's force to either end.
pub fn edge_load(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, traction: [f64; 2]) -> Vec<f64> {
    let mut force = vec![0.0; dofs.free()];
    for &edge in &boundary.edges {
        let [dx, dy] = mesh.edge_vector(edge);
        let half = 0.5 * dx.hypot(dy);
        for node in edge {
            for (dof, component) in dofs.node(node).into_iter().zip(traction) {
                if let Some(dof) = dof {
                    force[dof] += half * component;
                }
            }
        }
    }
    force
}
