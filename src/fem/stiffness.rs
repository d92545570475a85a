//! The stiffness of one element.

use super::elastic::Elasticity;
use super::shape::gradients_at;
use super::strain::{Element, mean_gradients, strain_columns};
use crate::mesh::{CellKind, quadrature_of};

/// The stiffness `∫ Bᵀ D B` of a cell with `nodes` (m); N/m, in two dimensions per unit depth. Unknowns
/// `(u_x, u_y)` or `(u_x, u_y, u_z)` node by node. `None` if the element is inverted or degenerate.
pub fn element_stiffness(
    kind: CellKind,
    nodes: &[[f64; 3]],
    element: Element,
    material: &Elasticity,
) -> Option<Vec<Vec<f64>>> {
    let points = gradients_at(kind, &quadrature_of(kind, nodes), nodes)?;
    let mean = mean_gradients(&points);
    let unknowns = kind.dimension() * nodes.len();
    let mut k = vec![vec![0.0; unknowns]; unknowns];
    for (gradients, volume) in &points {
        let dilatation = match element {
            Element::Bilinear | Element::NodalVolume => gradients,
            Element::BBar => &mean,
        };
        let b = strain_columns(kind.dimension(), gradients, dilatation);
        for (row, strain) in k.iter_mut().zip(&b) {
            let stress = material.stress(*strain);
            for (entry, strain) in row.iter_mut().zip(&b) {
                *entry += volume * stress.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>();
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
            let k = element_stiffness(CellKind::Quadrilateral, &corners, element, &material).unwrap();
            for (i, row) in k.iter().enumerate() {
                for (j, &value) in row.iter().enumerate() {
                    assert!((value - k[j][i]).abs() < 1e-15);
                }
            }
            let [a, b, c, d] = corners;
            assert!(element_stiffness(CellKind::Quadrilateral, &[a, d, c, b], element, &material).is_none());
        }
    }
}
