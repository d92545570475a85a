//! The contact rows of `H_N` (19) and the merit `Theta` (10), by which every method is stopped.

use super::scaled::Scaled;
use crate::contact::coulomb::{normal_residual, tangential_residual};
use crate::problem::ContactProblem;
use crate::units::Scaling;

/// The free choices of `H_N` and `Theta`: `r_i`, and the units in which `Theta` adds its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Conventions {
    /// `r_i`, n_c, N/m.
    pub r: Vec<f64>,
    /// What a normal or tangential row, in N, is divided by before it enters `Theta`, n_c.
    pub row_unit: Vec<f64>,
}

impl Conventions {
    /// The paper's: `r_i = 10¹² l_i`, and contact rows as stresses (Pa) beside equilibrium rows as
    /// forces (N).
    pub fn paper(problem: &ContactProblem) -> Self {
        Conventions { r: problem.weight.iter().map(|l| 1e12 * l).collect(), row_unit: problem.weight.clone() }
    }
}

/// The contact rows of `H_N` at any `z` that begins with `(u, p_t, p_n)`.
pub(super) struct NaturalRows {
    /// `r_i`, scaled.
    pub r: Vec<f64>,
    /// Per contact node, in the unit of force: what its rows are divided by in `Theta`.
    row_unit: Vec<f64>,
}

impl NaturalRows {
    pub(super) fn new(conventions: &Conventions, scaling: &Scaling) -> Self {
        NaturalRows {
            r: conventions.r.iter().map(|r| r / scaling.stiffness()).collect(),
            row_unit: conventions.row_unit.clone(),
        }
    }

    /// `-min(p_n, r (g - w_n))` of node `i`.
    pub(super) fn normal(&self, data: &Scaled, i: usize, p_n: f64, w_n: f64) -> f64 {
        normal_residual(p_n, w_n, data.gap[i], self.r[i])
    }

    /// `-p_t + Π(p_t + r (w_t - w̄_t))` of node `i`.
    pub(super) fn tangential(&self, data: &Scaled, i: usize, p_t: f64, p_n: f64, w_t: f64) -> f64 {
        tangential_residual(p_t, p_n, w_t - data.w_t_last[i], data.mu[i], self.r[i])
    }

    /// `Theta` (N², the rows in their units of [`Conventions`]) at `z + t dz`, where the equilibrium
    /// rows are `equilibrium`.
    pub(super) fn theta(&self, data: &Scaled, equilibrium: f64, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let layout = &data.layout;
        let mut contact = 0.0;
        for i in 0..layout.contacts() {
            let n = layout.p_n(i);
            let p_n = z[n] + t * dz[n];
            let mut square = self.normal(data, i, p_n, data.w_n(i, z) + t * data.w_n(i, dz)).powi(2);
            if let Some(k) = layout.p_t(i) {
                let w_t = data.w_t(i, z) + t * data.w_t(i, dz);
                square += self.tangential(data, i, z[k] + t * dz[k], p_n, w_t).powi(2);
            }
            contact += square / self.row_unit[i].powi(2);
        }
        (equilibrium + 0.5 * contact) * data.scaling.force.powi(2)
    }

    /// `Theta` of a residual `h` of `H_N`.
    pub(super) fn theta_of(&self, data: &Scaled, h: &[f64]) -> f64 {
        let layout = &data.layout;
        let mut contact = 0.0;
        for i in 0..layout.contacts() {
            let tangential = layout.p_t(i).map_or(0.0, |k| h[k]);
            contact += (h[layout.p_n(i)].powi(2) + tangential.powi(2)) / self.row_unit[i].powi(2);
        }
        (half_square(&h[..layout.displacements()]) + 0.5 * contact) * data.scaling.force.powi(2)
    }
}

/// `½ |x|²`.
pub(super) fn half_square(x: &[f64]) -> f64 {
    0.5 * x.iter().map(|x| x * x).sum::<f64>()
}
