//! Isotropic linear elasticity and the stiffness of one element.

use super::quadrature::GAUSS_2X2;
use super::shape::gradients;

/// The elasticity matrix of an isotropic material in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// `D` with `(σ_xx, σ_yy, τ_xy) = D (ε_xx, ε_yy, γ_xy)`, Pa.
    pub d: [[f64; 3]; 3],
}

impl Elasticity {
    /// Plane strain, `ε_zz = 0`: a slice of a long body. `young` in Pa, `-1 < poisson < 0.5`.
    pub fn plane_strain(young: f64, poisson: f64) -> Self {
        // Plane strain is plane stress with E/(1 - ν²) and ν/(1 - ν).
        Self::plane_stress(young / (1.0 - poisson * poisson), poisson / (1.0 - poisson))
    }

    /// Plane stress, `σ_zz = 0`: a thin plate. `young` in Pa.
    pub fn plane_stress(young: f64, poisson: f64) -> Self {
        let c = young / (1.0 - poisson * poisson);
        let shear = 0.5 * c * (1.0 - poisson);
        Elasticity { d: [[c, c * poisson, 0.0], [c * poisson, c, 0.0], [0.0, 0.0, shear]] }
    }

    /// The stress `(σ_xx, σ_yy, τ_xy)` (Pa) of the strain `(ε_xx, ε_yy, γ_xy)`.
    pub fn stress(&self, strain: [f64; 3]) -> [f64; 3] {
        self.d.map(|row| row[0] * strain[0] + row[1] * strain[1] + row[2] * strain[2])
    }
}

/// The stiffness `∫ Bᵀ D B` of a quadrilateral with `corners` (m), N/m per unit depth, unknowns
/// `(u_x, u_y)` corner by corner; `None` if the element is inverted or degenerate.
pub fn element_stiffness(corners: &[[f64; 2]; 4], material: &Elasticity) -> Option<[[f64; 8]; 8]> {
    let mut k = [[0.0; 8]; 8];
    for point in GAUSS_2X2 {
        let (g, det) = gradients(point, corners);
        if det.is_nan() || det <= 0.0 {
            return None;
        }
        // The columns of B: the strains of a unit displacement in each unknown.
        let mut b = [[0.0; 3]; 8];
        for (a, [gx, gy]) in g.into_iter().enumerate() {
            b[2 * a] = [gx, 0.0, gy];
            b[2 * a + 1] = [0.0, gy, gx];
        }
        for (i, row) in k.iter_mut().enumerate() {
            let stress = material.stress(b[i]);
            for (j, entry) in row.iter_mut().enumerate() {
                *entry += det * (stress[0] * b[j][0] + stress[1] * b[j][1] + stress[2] * b[j][2]);
            }
        }
    }
    Some(k)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_states() {
        let (young, poisson) = (210e9, 0.3);
        let lateral_free = Elasticity::plane_stress(young, poisson).stress([1e-3, -poisson * 1e-3, 0.0]);
        assert!((lateral_free[0] - young * 1e-3).abs() < 1e-3 && lateral_free[1].abs() < 1e-3);
        // In plane strain, σ_zz = ν (σ_xx + σ_yy) makes the modulus E / (1 - ν²).
        let strain = Elasticity::plane_strain(young, poisson);
        let lateral = -poisson / (1.0 - poisson) * 1e-3;
        let stress = strain.stress([1e-3, lateral, 0.0]);
        assert!((stress[0] / (young / (1.0 - poisson * poisson) * 1e-3) - 1.0).abs() < 1e-14);
        assert!(stress[1].abs() < 1e-3);
    }

    #[test]
    fn stiffness_is_symmetric_and_inverted_elements_are_refused() {
        let corners = [[0.0, 0.0], [2.0, 0.3], [1.7, 1.4], [-0.2, 1.1]];
        let material = Elasticity::plane_strain(1.0, 0.3);
        let k = element_stiffness(&corners, &material).unwrap();
        for (i, row) in k.iter().enumerate() {
            for (j, &value) in row.iter().enumerate() {
                assert!((value - k[j][i]).abs() < 1e-15);
            }
        }
        let [a, b, c, d] = corners;
        assert!(element_stiffness(&[a, d, c, b], &material).is_none());
    }
}
