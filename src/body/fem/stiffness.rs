//! The stiffness of one element.

use super::elastic::Elasticity;
use super::shape::CellPoint;
use super::strain::{Element, strain_columns};
use crate::body::mesh::{CellKind, Geometry, quadrature_of};

/// Computes the stiffness `∫ Bᵀ D B` of a cell with `nodes` (m), N/m; in two dimensions per unit depth, for a body of
/// revolution over the full circumference.
///
/// Unknowns are `(u_x, u_y)` or `(u_x, u_y, u_z)` node by node. `None` if the element is inverted or degenerate.
pub fn element_stiffness(
    kind: CellKind,
    geometry: Geometry,
    nodes: &[[f64; 3]],
    element: Element,
    material: &Elasticity,
) -> Option<Vec<Vec<f64>>> {
    let points = CellPoint::all(kind, geometry, nodes, &quadrature_of(kind, geometry, nodes))?;
    let mean = element.mean_dilatation(&points);
    let unknowns = kind.dimension() * nodes.len();
    let mut k = vec![vec![0.0; unknowns]; unknowns];
    for point in &points {
        let b = strain_columns(kind.dimension(), point, mean.as_deref());
        for (row, strain) in k.iter_mut().zip(&b) {
            let stress = material.stress(*strain);
            for (entry, strain) in row.iter_mut().zip(&b) {
                *entry += point.volume * stress.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>();
            }
        }
    }
    Some(k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiffness_is_symmetric_and_inverted_elements_are_refused() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.3, 0.0], [1.7, 1.4, 0.0], [-0.2, 1.1, 0.0]];
        let material = Elasticity::plane_strain(1.0, 0.3);
        for element in [Element::Bilinear, Element::BBar] {
            let of = |corners: &[[f64; 3]]| {
                element_stiffness(CellKind::Quadrilateral, Geometry::Cartesian, corners, element, &material)
            };
            let k = of(&corners).unwrap();
            for (i, row) in k.iter().enumerate() {
                for (j, &value) in row.iter().enumerate() {
                    assert!((value - k[j][i]).abs() < 1e-15);
                }
            }
            let [a, b, c, d] = corners;
            assert!(of(&[a, d, c, b]).is_none());
        }
    }
}
