//! The Newton system on `(u, p_t, p_n)`: `v_n`, `s` and `λ` eliminated row by row.
//!
//! With the right-hand sides `b_v` (gap row), `b_w` (slip row), `b_s` (cone rows), `b_pv` and `b_sλ`
//! (products) of a system with `∇H_I`, the rows of `v_n` and `s` give
//! `dv_n = b_v - dw_n` and `ds± = b_s± + μ dp_n ∓ dp_t`. In the products they leave
//!
//! - `v_n dp_n - p_n dw_n = b_pv - p_n b_v`
//! - `(λ⁺ s⁻ + λ⁻ s⁺) dp_t - μ (λ⁺ s⁻ - λ⁻ s⁺) dp_n - s⁺ s⁻ dw_t
//!   = s⁺ s⁻ b_w + s⁻ (λ⁺ b_s⁺ - b_sλ⁺) - s⁺ (λ⁻ b_s⁻ - b_sλ⁻)`
//!
//! The second row is multiplied by `s⁺ s⁻`, so that nothing is divided by a quantity that goes to zero. Both rows are
//! in the pattern of (21).

use crate::algebra::linear::SystemMatrix;
use crate::solver::formulation::SlackLayout;
use crate::solver::formulation::mixed::{MixedMatrix, TangentialRow};
use crate::solver::formulation::scaled::ScaledData;

/// The reduced system.
pub(super) struct Reduced {
    matrix: MixedMatrix,
    /// The largest coefficient, by which each normal row and then each tangential row was divided.
    row_scale: Vec<[f64; 2]>,
}

impl Reduced {
    pub(super) fn new(matrix: MixedMatrix, contacts: usize) -> Self {
        Reduced { matrix, row_scale: vec![[1.0; 2]; contacts] }
    }

    pub(super) fn matrix(&self) -> &SystemMatrix {
        self.matrix.matrix()
    }

    pub(super) fn linearize(&mut self, data: &ScaledData, layout: &SlackLayout, z: &[f64]) {
        for i in 0..data.layout.contacts() {
            let (p_n, v_n) = (z[data.layout.p_n(i)], z[layout.v_n(i)]);
            let normal = p_n.max(v_n);
            self.matrix.set_normal(i, -p_n / normal, v_n / normal);
            self.row_scale[i][0] = normal;
            if let Some(p_t) = data.layout.p_t(i) {
                let [s_plus, s_minus] = layout.s(p_t).map(|k| z[k]);
                let [l_plus, l_minus] = layout.lambda(p_t).map(|k| z[k]);
                let (by_plus, by_minus, by_w_t) = (l_plus * s_minus, l_minus * s_plus, s_plus * s_minus);
                let scale = (by_plus + by_minus).max(by_w_t);
                let by_p_n = -data.mu[i] * (by_plus - by_minus);
                let row = TangentialRow {
                    w: [-by_w_t / scale, 0.0],
                    p: [(by_plus + by_minus) / scale, 0.0],
                    p_n: by_p_n / scale,
                };
                self.matrix.set_tangential(i, 0, &row);
                self.row_scale[i][1] = scale;
            }
        }
    }

    pub(super) fn reduce(&self, data: &ScaledData, layout: &SlackLayout, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        rhs[..data.layout.displacements()].copy_from_slice(&b[..data.layout.displacements()]);
        for i in 0..data.layout.contacts() {
            let [normal, tangential] = self.row_scale[i];
            let (p_n, v_n) = (data.layout.p_n(i), layout.v_n(i));
            rhs[p_n] = (b[v_n] - z[p_n] * b[p_n]) / normal;
            if let Some(p_t) = data.layout.p_t(i) {
                let ([s_plus, s_minus], [l_plus, l_minus]) = (layout.s(p_t), layout.lambda(p_t));
                let plus = z[s_minus] * (z[l_plus] * b[s_plus] - b[l_plus]);
                let minus = z[s_plus] * (z[l_minus] * b[s_minus] - b[l_minus]);
                rhs[p_t] = (z[s_plus] * z[s_minus] * b[p_t] + plus - minus) / tangential;
            }
        }
    }
}

/// Computes `dv_n`, `ds` and `dλ` from `(du, dp_t, dp_n)`. The small member of a pair gets its change from the
/// product row, divided by the large member. As a difference of large numbers, or divided by the small member, it
/// would lose most of its digits.
pub(super) fn recover(data: &ScaledData, layout: &SlackLayout, z: &[f64], b: &[f64], dz: &mut [f64]) {
    for i in 0..data.layout.contacts() {
        let (p_n, v_n) = (data.layout.p_n(i), layout.v_n(i));
        dz[v_n] = if z[p_n] > z[v_n] { (b[v_n] - z[v_n] * dz[p_n]) / z[p_n] } else { b[p_n] - data.w_n(i, dz) };
        let Some(p_t) = data.layout.p_t(i) else { continue };
        let ([s_plus, s_minus], [l_plus, l_minus]) = (layout.s(p_t), layout.lambda(p_t));
        for (sign, s, lambda) in [(1.0, s_plus, l_plus), (-1.0, s_minus, l_minus)] {
            dz[s] = b[s] + data.mu[i] * dz[p_n] - sign * dz[p_t];
            dz[lambda] = (b[lambda] - z[lambda] * dz[s]) / z[s];
        }
        // If a node slips, λ follows from the slip row.
        let slip = b[p_t] + data.w_t(i, dz);
        let (slips_plus, slips_minus) = (z[s_plus] < z[l_plus], z[s_minus] < z[l_minus]);
        if slips_plus && !slips_minus {
            dz[l_plus] = dz[l_minus] + slip;
            dz[s_plus] = (b[l_plus] - z[s_plus] * dz[l_plus]) / z[l_plus];
        } else if slips_minus && !slips_plus {
            dz[l_minus] = dz[l_plus] - slip;
            dz[s_minus] = (b[l_minus] - z[s_minus] * dz[l_minus]) / z[l_minus];
        }
    }
}
