//! The contact rows of `H_N` (19) and the merit `Theta` (10), which is part of every method's stopping test.

use super::Layout;
use super::scaled::ScaledData;
use crate::base::units::Scaling;
use crate::solver::laws::coulomb::{normal_residual, tangential_residual};
use crate::solver::problem::ContactProblem;

/// The free choices of `H_N` and `Theta`: `r`, the pressure that limits friction, and the units in which `Theta` adds
/// its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulationScaling {
    /// `r` of the normal rows, n_c, N/m.
    pub r_n: Vec<f64>,
    /// `r` of the tangential rows, n_c, N/m; the paper has one `r_i` for both.
    pub r_t: Vec<f64>,
    /// The choice of the pressure that limits friction.
    pub pressure: Pressure,
    /// The unit by which a normal or tangential row, in N, is divided in `Theta`, n_c.
    pub row_unit: Vec<f64>,
}

/// The normal force that limits friction, `|p_t| ≤ μ (pressure)₊`. At a solution both are `p_n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pressure {
    /// `p_n`, as in (19).
    Unknown,
    /// `p_n + r_n (w_n - g)`, as in Alart and Curnier (1991): a closing node has friction at once, an opening node
    /// loses it at once.
    Trial,
}

/// `r_n` and `r_t` as shares of [`ContactProblem::contact_stiffness`]. Iterations per increment with both 0.1, 0.15,
/// 0.2 and 0.3: on the paper's block (5² to 50² elements, 2 to 100 increments) 2.40, 2.35, 2.43 and 2.52, on the
/// punch 4.55 and then 4.45 each, for the problem of Cattaneo and Mindlin 5.17, 5.67, 6.00 and 5.67; 0.7 takes 2.83
/// on the block. Doubling `r_t` gains nothing here.
const SHARES_ALONG_A_LINE: [f64; 2] = [0.15, 0.15];

/// `r_n` and `r_t` as such shares if a node slides in a plane. On cubes of 4³, 6³, 10³ and 16³ elements 3.97, 4.16,
/// 4.66 and 5.16; with 0.7 for both 3.99, 4.23, 4.74 and 5.31, with 0.35 and 1.05 4.02, 4.23 and 4.70 up to 10³, with
/// 0.7 and 1.4 3.99, 4.20 and 4.82.
const SHARES_IN_A_PLANE: [f64; 2] = [0.5, 1.0];

impl FormulationScaling {
    /// Returns the choices of the paper: `r_i = 10¹² l_i`, and contact rows as stresses (Pa) beside equilibrium rows
    /// as forces (N). `weight` are the `l_i`, n_c.
    pub fn paper(weight: &[f64]) -> Self {
        let r: Vec<f64> = weight.iter().map(|l| 1e12 * l).collect();
        FormulationScaling { r_n: r.clone(), r_t: r, pressure: Pressure::Unknown, row_unit: weight.to_vec() }
    }

    /// Returns choices derived from the problem, by its [`ContactProblem::contact_stiffness`].
    pub fn natural(problem: &ContactProblem) -> Self {
        FormulationScaling::of_stiffness(&Layout::new(problem), problem.contact_stiffness())
    }

    /// Returns choices with `r` from the stiffness of the contact nodes (n_c, N/m), friction limited by the trial
    /// pressure, and every row a force.
    pub fn of_stiffness(layout: &Layout, contact_stiffness: &[f64]) -> Self {
        let shares = |i| if layout.slides_in_a_plane(i) { SHARES_IN_A_PLANE } else { SHARES_ALONG_A_LINE };
        let r = |row: usize| contact_stiffness.iter().enumerate().map(|(i, k)| shares(i)[row] * k).collect();
        FormulationScaling {
            r_n: r(0),
            r_t: r(1),
            pressure: Pressure::Trial,
            row_unit: vec![1.0; contact_stiffness.len()],
        }
    }

    /// Multiplies every `r` by `factor`, for studies of `r` alone: solutions do not depend on `r`.
    pub fn scale_r(&mut self, factor: f64) {
        self.r_n.iter_mut().chain(&mut self.r_t).for_each(|r| *r *= factor);
    }
}

/// The contact rows of `H_N` at any `z` that begins with `(u, p_t, p_o, p_n)`.
pub(super) struct NaturalRows {
    /// `r` of the normal rows, scaled.
    pub r_n: Vec<f64>,
    /// `r` of the tangential rows, scaled.
    pub r_t: Vec<f64>,
    /// The divisor of each contact node's rows in `Theta`, in the unit of force.
    row_unit: Vec<f64>,
    pub kind: Pressure,
}

impl NaturalRows {
    pub(super) fn new(conventions: &FormulationScaling, scaling: &Scaling) -> Self {
        let scaled = |r: &[f64]| r.iter().map(|r| r / scaling.stiffness()).collect();
        NaturalRows {
            r_n: scaled(&conventions.r_n),
            r_t: scaled(&conventions.r_t),
            row_unit: conventions.row_unit.clone(),
            kind: conventions.pressure,
        }
    }

    /// Returns `-min(p_n, r_n (g - w_n))` of node `i` with this `w_n - g`.
    pub(super) fn normal(&self, i: usize, p_n: f64, approach: f64) -> f64 {
        normal_residual(p_n, approach, 0.0, self.r_n[i])
    }

    /// Returns `-p_T + Π(p_T + r_t (w_T - w̄_T))` of node `i` with the `pressure` that limits friction.
    pub(super) fn tangential(
        &self,
        data: &ScaledData,
        i: usize,
        p: [f64; 2],
        pressure: f64,
        slip: [f64; 2],
    ) -> [f64; 2] {
        tangential_residual(p, pressure, slip, data.mu[i], self.r_t[i])
    }

    /// Returns the pressure that limits friction at node `i` with this `w_n - g`.
    pub(super) fn pressure(&self, i: usize, p_n: f64, approach: f64) -> f64 {
        match self.kind {
            Pressure::Unknown => p_n,
            Pressure::Trial => p_n + self.r_n[i] * approach,
        }
    }

    /// Returns `Theta` (N², the rows in their units of [`FormulationScaling`]) at `z + t dz`, where `equilibrium` is
    /// the contribution of the equilibrium rows.
    pub(super) fn theta(&self, data: &ScaledData, equilibrium: f64, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let layout = &data.layout;
        let mut contact = 0.0;
        for i in 0..layout.contacts() {
            let n = layout.p_n(i);
            let p_n = z[n] + t * dz[n];
            let approach = data.w_n(i, z) + t * data.w_n(i, dz) - data.gap[i];
            let mut square = self.normal(i, p_n, approach).powi(2);
            if layout.has_friction(i) {
                let ahead = |[v_t, v_o]: [f64; 2], [d_t, d_o]: [f64; 2]| [v_t + t * d_t, v_o + t * d_o];
                let p = ahead(data.friction(i, z), data.friction(i, dz));
                let w = ahead(data.tangential(i, z), data.tangential(i, dz));
                let pressure = self.pressure(i, p_n, approach);
                let rows = self.tangential(data, i, p, pressure, data.slip(i, w));
                square += rows.into_iter().map(|row| row.powi(2)).sum::<f64>();
            }
            contact += square / self.row_unit[i].powi(2);
        }
        (equilibrium + 0.5 * contact) * data.scaling.force.powi(2)
    }

    /// Returns `Theta` of a residual `h` of `H_N`.
    pub(super) fn theta_of(&self, data: &ScaledData, h: &[f64]) -> f64 {
        let layout = &data.layout;
        let mut contact = 0.0;
        for i in 0..layout.contacts() {
            let dofs = layout.tangential(i).into_iter().flatten().chain([layout.p_n(i)]);
            contact += dofs.map(|k| h[k].powi(2)).sum::<f64>() / self.row_unit[i].powi(2);
        }
        (half_square(&h[..layout.displacements()]) + 0.5 * contact) * data.scaling.force.powi(2)
    }
}

/// Returns `½ |x|²`.
pub(super) fn half_square(x: &[f64]) -> f64 {
    0.5 * x.iter().map(|x| x * x).sum::<f64>()
}
