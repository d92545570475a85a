//! Integrals over the facets of the boundary: shares of its nodes, consistent nodal forces.

use super::dofs::Dofs;
use super::quadrature::quadrature;
use super::shape::{local_gradients, shape};
use crate::mesh::{Boundary, CellKind, Mesh};
use crate::vector::{cross, norm};

/// Forces on nodes (N; in two dimensions per unit depth), each with the number of its node; those on one node add up.
pub type NodalForces = Vec<(usize, [f64; 3])>;

/// A point of a facet at which something is integrated.
pub(super) struct FacetPoint {
    /// The shape functions of the corners of the facet.
    pub shape: Vec<f64>,
    /// The position, m.
    pub position: [f64; 3],
    /// The outward normal times the weight of the point: length (m) or area (m²).
    pub area: [f64; 3],
}

/// The integration points of a facet: exact for cubic polynomials along an edge and along both axes of a quadrilateral,
/// for quadratic ones on a triangle.
pub(super) fn facet_points(mesh: &Mesh, facet: &[usize]) -> Vec<FacetPoint> {
    let corners = mesh.points(facet);
    let position = |shape: &[f64]| [0, 1, 2].map(|c| shape.iter().zip(&corners).map(|(n, x)| n * x[c]).sum());
    let flat = |shape: Vec<f64>, weight: f64| FacetPoint {
        position: position(&shape),
        shape,
        area: mesh.area_vector(facet).map(|a| weight * a),
    };
    match facet.len() {
        2 => [-1.0, 1.0].map(|side| 0.5 * (1.0 + side / 3.0_f64.sqrt())).map(|s| flat(vec![1.0 - s, s], 0.5)).into(),
        3 => (0..3)
            .map(|k| flat((0..3).map(|j| if j == k { 2.0 / 3.0 } else { 1.0 / 6.0 }).collect(), 1.0 / 3.0))
            .collect(),
        _ => (quadrature(CellKind::Quadrilateral).into_iter())
            .map(|(point, weight)| {
                let shape = shape(CellKind::Quadrilateral, point);
                let [along, across] = tangents(&corners, point);
                FacetPoint { position: position(&shape), shape, area: cross(along, across).map(|a| weight * a) }
            })
            .collect(),
    }
}

/// `∂x/∂ξ` and `∂x/∂η` of a quadrilateral with these corners.
fn tangents(corners: &[[f64; 3]], point: [f64; 3]) -> [[f64; 3]; 2] {
    let mut along = [[0.0; 3]; 2];
    for (d, x) in local_gradients(CellKind::Quadrilateral, point).iter().zip(corners) {
        for r in 0..2 {
            for c in 0..3 {
                along[r][c] += d[r] * x[c];
            }
        }
    }
    along
}

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
        let [along, across] = tangents(&mesh.points(facet), point);
        let area = weight * norm(cross(along, across));
        for (sum, n) in weights.iter_mut().zip(shape(CellKind::Quadrilateral, point)) {
            *sum += n * area;
        }
    }
    weights
}

/// The length (m) or area (m²) of `boundary`.
pub fn area(mesh: &Mesh, boundary: &Boundary) -> f64 {
    boundary.facets.iter().flat_map(|facet| facet_weights(mesh, facet)).sum()
}

/// The forces of a uniform `traction` (N/m²) on `boundary`: `∫ N_a t dA`.
pub fn uniform_traction(mesh: &Mesh, boundary: &Boundary, traction: [f64; 3]) -> NodalForces {
    let on_facet = |facet: &Vec<usize>| {
        let weights = facet_weights(mesh, facet);
        facet.iter().copied().zip(weights.into_iter().map(|weight| traction.map(|t| weight * t))).collect::<Vec<_>>()
    };
    boundary.facets.iter().flat_map(on_facet).collect()
}

/// The forces of tractions on `boundary` that change along it: `∫ N_a t dA`, where `force` tells `t dA` (N) of a position (m)
/// and the outward area vector (m or m²) of a point.
pub fn traction(mesh: &Mesh, boundary: &Boundary, force: impl Fn([f64; 3], [f64; 3]) -> [f64; 3]) -> NodalForces {
    let mut forces = Vec::new();
    for facet in &boundary.facets {
        for FacetPoint { shape, position, area } in facet_points(mesh, facet) {
            let force = force(position, area);
            forces.extend(facet.iter().zip(&shape).map(|(&node, n)| (node, force.map(|f| n * f))));
        }
    }
    forces
}

/// The nodal forces (length n_u; N, in two dimensions per unit depth) of a uniform `traction` (N/m²) on
/// `boundary`: `∫ N_a t dA`.
pub fn facet_load(mesh: &Mesh, dofs: &Dofs, boundary: &Boundary, traction: [f64; 3]) -> Vec<f64> {
    dofs.forces(uniform_traction(mesh, boundary, traction))
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
        // ∫ x y dA = ∫ (1 + 2 y)² y / 2 dy = 17/12.
        let forces = traction(&mesh, mesh.boundary("top").unwrap(), |[x, y, _], area| area.map(|a| a * x * y));
        let sum = forces.iter().map(|(_, force)| force[2]).sum::<f64>();
        assert!((sum - 17.0 / 12.0).abs() < 1e-14, "{sum}");
    }

    /// The products of a quadratic and a linear function, integrated on every kind of facet.
    #[test]
    fn tractions_that_change_along_a_boundary() {
        let plane = block(&[3.0, 1.0], &[2, 1]);
        let space = block(&[3.0, 2.0, 1.0], &[2, 1, 1]);
        let simplices = space.clone().into_simplices();
        for (mesh, exact) in [(&plane, 9.0), (&space, 18.0), (&simplices, 18.0)] {
            let up = mesh.dimension - 1;
            let forces = traction(mesh, mesh.boundary("top").unwrap(), |[x, ..], area| area.map(|a| a * x * x));
            let sum = forces.iter().map(|(_, force)| force[up]).sum::<f64>();
            assert!((sum - exact).abs() < 1e-13, "{sum}");
            let uniform = uniform_traction(mesh, mesh.boundary("top").unwrap(), [1.0; 3]);
            let sum = uniform.iter().map(|(_, force)| force[0]).sum::<f64>();
            assert!((sum - area(mesh, mesh.boundary("top").unwrap())).abs() < 1e-14);
        }
    }
}
