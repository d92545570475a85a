//! Isotropic linear elasticity in two and three dimensions.

/// An isotropic elastic law with Lamé's coefficients: `σ = λ tr(ε) 1 + 2 μ ε`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// `λ`, Pa.
    pub lambda: f64,
    /// The shear modulus `μ`, Pa.
    pub mu: f64,
}

impl Elasticity {
    /// Creates the law in three dimensions. `young` in Pa, `-1 < poisson < 0.5`.
    pub fn isotropic(young: f64, poisson: f64) -> Self {
        // 1 - 2ν is exact for ν > 1/4, so that λ keeps its digits for ν arbitrarily close to 1/2.
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Elasticity { lambda, mu: shear_modulus(young, poisson) }
    }

    /// Creates the law of plane strain, for a slice of a long body: the law in three dimensions with `ε_zz = 0`.
    pub fn plane_strain(young: f64, poisson: f64) -> Self {
        Self::isotropic(young, poisson)
    }

    /// Creates the law of plane stress, `σ_zz = 0`, for a thin plate. `young` in Pa. Here `λ` is `2λμ / (λ + 2μ)` of
    /// the material, which results from the elimination of `ε_zz`.
    pub fn plane_stress(young: f64, poisson: f64) -> Self {
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - poisson));
        Elasticity { lambda, mu: shear_modulus(young, poisson) }
    }

    /// Computes the stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) of the strain
    /// `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)`. In plane stress, `ε_zz` must be 0 and `σ_zz` has no meaning.
    pub fn stress(&self, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 6] {
        let pressure = self.lambda * (xx + yy + zz);
        let direct = |strain: f64| pressure + 2.0 * self.mu * strain;
        [direct(xx), direct(yy), direct(zz), self.mu * xy, self.mu * yz, self.mu * zx]
    }

    /// Computes the energy density `½ ε D ε` (J/m³) of a strain, with components as in [`Elasticity::stress`].
    pub fn energy_density(&self, strain: &[f64; 6]) -> f64 {
        0.5 * self.stress(*strain).iter().zip(strain).map(|(s, e)| s * e).sum::<f64>()
    }

    /// Returns the deviatoric part of the law: `2 μ (ε - ⅓ tr(ε) 1)`.
    #[must_use]
    pub fn deviatoric(&self) -> Self {
        Elasticity { lambda: -2.0 / 3.0 * self.mu, ..*self }
    }

    /// Returns the bulk modulus `λ + 2/3 μ`, Pa.
    pub fn bulk(&self) -> f64 {
        self.lambda + 2.0 / 3.0 * self.mu
    }
}

/// Returns a number for each law; equal laws have the same number.
pub fn numbered(laws: impl Iterator<Item = Elasticity>) -> Vec<usize> {
    let mut different: Vec<Elasticity> = Vec::new();
    let number = |law: Elasticity| {
        different.iter().position(|other| *other == law).unwrap_or_else(|| {
            different.push(law);
            different.len() - 1
        })
    };
    laws.map(number).collect()
}

fn shear_modulus(young: f64, poisson: f64) -> f64 {
    0.5 * young / (1.0 + poisson)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_states() {
        let (young, poisson) = (210e9, 0.3);
        let plate = Elasticity::plane_stress(young, poisson).stress([1e-3, -poisson * 1e-3, 0.0, 0.0, 0.0, 0.0]);
        assert!((plate[0] - young * 1e-3).abs() < 1e-3 && plate[1].abs() < 1e-3);
        // In plane strain, σ_zz = ν (σ_xx + σ_yy) makes the modulus E / (1 - ν²).
        let strain = Elasticity::plane_strain(young, poisson);
        let lateral = -poisson / (1.0 - poisson) * 1e-3;
        let stress = strain.stress([1e-3, lateral, 0.0, 0.0, 0.0, 0.0]);
        assert!((stress[0] / (young / (1.0 - poisson * poisson) * 1e-3) - 1.0).abs() < 1e-14);
        assert!((stress[2] / (poisson * stress[0]) - 1.0).abs() < 1e-14);
        assert!(stress[1].abs() < 1e-3);
    }

    #[test]
    fn the_bulk_modulus_keeps_its_digits_near_incompressibility() {
        // 1 - 2ν = 2⁻³⁰ exactly.
        let compressibility = 2.0_f64.powi(-30);
        let poisson = 0.5 * (1.0 - compressibility);
        let material = Elasticity::plane_strain(1.0, poisson);
        let bulk = 1.0 / (3.0 * compressibility);
        assert!(((material.lambda + 2.0 / 3.0 * material.mu) / bulk - 1.0).abs() < 1e-15);
    }
}
