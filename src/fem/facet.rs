//! Integrals over the facets of the boundary: shares of its nodes, consistent nodal forces.

use super::dofs::Dofs;
use super::quadrature::quadrature;
use super::shape::{local_gradients, shape};
use crate::mesh::{Boundary, CellKind, Mesh};
use crate::vector::{cross, norm};

/// `∫ N_a dA` for each corner of a facet: its share of the length (m, half of an edge) or of the area (m²).
/// Exact for edges, triangles and flat quadrilaterals.
pub fn facet_weights(mesh: &Mesh, facet: &[usize]) -> Vec<f64> {
    let size = norm(mesh.area_vector(facet));
    let corners = facet.len();
    if corners < 4 {
        return vec![size / corners as f64; corners];
    }
    let mut weights = vec![0.0; corners];
    for (point, weight) in quadrature(CellKind::Quadrilateral) {
        let mut along = [[0.0; 3]; 2];
        for (d, x) in local_gradients(CellKind::Quadrilateral, point).iter().zip(mesh.points(facet)) {
            for r in 0..2 {
                for c in 0..3 {
                    along[r][c] += d[r] * x[c];
                }
            }
        }
        let area = weight * norm(cross(along[0], along[1]));
        for (sum, n) in weights.iter_mut().zip(shape(CellKind::Quadrilateral, point)) {
            *sum += n * area;
        }
    }
    weights
}

/// The nodal forces (length n_u; N, in two dimensions per unit depth) of a uniform `traction` (N/m²) on
/// `boundary`: `∫ N_a t dA`.
pub fn facet_load(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, traction: [f64; 3]) -> Vec<f64> {
    let mut force = vec![0.0; dofs.free()];
    for facet in &boundary.facets {
        for (&node, weight) in facet.iter().zip(facet_weights(mesh, facet)) {
            for (dof, component) in dofs.node(node).iter().zip(traction) {
                if let Some(dof) = *dof {
                    force[dof] += weight * component;
                }
            }
        }
    }
    force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::block;

    /// The first moments of a flat facet tell its shares apart: `Σ w_a x_a = ∫ x dA`.
    #[test]
    fn shares_are_exact_on_a_trapezium() {
        let mut mesh = block(&[1.0, 1.0, 1.0], &[1, 1, 1]);
        let top = mesh.boundary("top").unwrap().facets[0].clone();
        // The top becomes the trapezium 0 <= x <= 1 + 2 y of area 2, with ∫ x dA = 13/6, ∫ y dA = 7/6.
        mesh.nodes[7][0] = 3.0;
        let weights = facet_weights(&mesh, &top);
        let moment = |c: usize| weights.iter().zip(&top).map(|(w, &node)| w * mesh.nodes[node][c]).sum::<f64>();
        assert!((weights.iter().sum::<f64>() - 2.0).abs() < 1e-14);
        assert!((moment(0) - 13.0 / 6.0).abs() < 1e-14 && (moment(1) - 7.0 / 6.0).abs() < 1e-14, "{weights:?}");
    }
}
