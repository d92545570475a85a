//! The change of a solution with the data of the increments, by the last linearisation.
//!
//! While no contact node changes its case, the equations of an increment are affine (if slip turns, to first order)
//! and have the matrix of the last linearisation: one substitution leads from a solution to the next.

use super::Bdiff;
use crate::algebra::linear::LinearError;
use crate::solver::laws::coulomb::{NormalCase, TangentialCase, direction};

impl Bdiff {
    /// Returns `true` if there is a linearisation without pinned modes.
    pub fn has_tangent(&self) -> bool {
        !self.is_pinned() && self.cases.iter().all(Option::is_some)
    }

    /// Returns the residual at `z`, with the data of the present increment, of the equations with the matrix of the
    /// last linearisation: `w_n = g` if a node is closed, `p_n = 0` if it is open, `Δw_T = 0` if it sticks, `p_T = 0`
    /// without pressure, and `p_T = μ p_n n + R r Δw_T` if it slips.
    ///
    /// # Errors
    /// As [`Bdiff::residual`].
    pub fn residual_of_cases(&self, z: &[f64]) -> Result<Vec<f64>, LinearError> {
        let Bdiff { data, rows, .. } = self;
        let mut h = vec![0.0; z.len()];
        self.residual(z, &mut h)?;
        for (i, case) in self.cases.iter().enumerate() {
            let Some((normal, tangential)) = *case else { continue };
            let p_n = data.layout.p_n(i);
            h[p_n] = match normal {
                NormalCase::Open => -z[p_n],
                NormalCase::Closed => rows.r_n[i] * (data.w_n(i, z) - data.gap[i]),
            };
            let Some(tangential) = tangential else { continue };
            let (p, slip) = (data.friction(i, z), data.slip(i, data.tangential(i, z)));
            let moved = slip.map(|w| rows.r_t[i] * w);
            let row = match tangential {
                TangentialCase::NoPressure => p.map(|p| -p),
                TangentialCase::Stick => moved,
                TangentialCase::Slip { direction, turning } => [0, 1].map(|d| {
                    let turned = turning[d][0] * moved[0] + turning[d][1] * moved[1];
                    data.mu[i] * direction[d] * z[p_n] - p[d] + turned
                }),
            };
            for (k, row) in data.layout.tangential(i).into_iter().zip(row) {
                if let Some(k) = k {
                    h[k] = row;
                }
            }
        }
        Ok(h)
    }

    /// Makes nodes slip that were open in the last linearisation and are closed at `z`: puts their `p_T` on the cone,
    /// along their slip. A closing node has moved tangentially, and immediate sticking would hold it without a
    /// reason.
    pub fn slip_where_closing(&self, z: &mut [f64]) {
        let data = &self.data;
        for (i, case) in self.cases.iter().enumerate() {
            let trial = z[data.layout.p_n(i)] + self.rows.r_n[i] * (data.w_n(i, z) - data.gap[i]);
            if !matches!(case, Some((NormalCase::Open, _))) || trial <= 0.0 {
                continue;
            }
            let along = direction(data.slip(i, data.tangential(i, z)));
            for (k, n) in data.layout.tangential(i).into_iter().zip(along) {
                if let Some(k) = k {
                    z[k] = data.mu[i] * trial * n;
                }
            }
        }
    }
}
