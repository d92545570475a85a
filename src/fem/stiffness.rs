//! The stiffness of one element.

use super::elastic::Elasticity;
use super::quadrature::GAUSS_2X2;
use super::shape::gradients;
use super::strain::{Element, mean_gradients, strain_columns};

/// The stiffness `∫ Bᵀ D B` of a quadrilateral with `corners` (m), N/m per unit depth, unknowns
/// `(u_x, u_y)` corner by corner; `None` if the element is inverted or degenerate.
pub fn element_stiffness(corners: &[[f64; 2]; 4], element: Element, material: &Elasticity) -> Option<[[f64; 8]; 8]> {
    let points = GAUSS_2X2.map(|point| gradients(point, corners));
    if points.iter().any(|(_, det)| det.is_nan() || *det <= 0.0) {
        return None;
    }
    let mean = mean_gradients(&points);
    let mut k = [[0.0; 8]; 8];
    for (gradients, det) in &points {
        let b = match element {
            Element::Bilinear => strain_columns(gradients, gradients),
            Element::BBar => strain_columns(gradients, &mean),
        };
        for (i, row) in k.iter_mut().enumerate() {
            let stress = material.stress(b[i]);
            for (entry, strain) in row.iter_mut().zip(&b) {
                *entry += det * stress.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>();
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
        let corners = [[0.0, 0.0], [2.0, 0.3], [1.7, 1.4], [-0.2, 1.1]];
        let material = Elasticity::plane_strain(1.0, 0.3);
        for element in [Element::Bilinear, Element::BBar] {
            let k = element_stiffness(&corners, element, &material).unwrap();
            for (i, row) in k.iter().enumerate() {
                for (j, &value) in row.iter().enumerate() {
                    assert!((value - k[j][i]).abs() < 1e-15);
                }
            }
            let [a, b, c, d] = corners;
            assert!(element_stiffness(&[a, d, c, b], element, &material).is_none());
        }
    }
}
