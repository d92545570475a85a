//! The exact law of one contact as equations of an interior point method.
//!
//! The unknowns are the distance velocity `v`, `ρ = μ r_N`, `e = r_T / ρ`, the reserve of the cone `s`, and the slip
//! per friction `λ`:
//!
//! | row | equation |
//! | --- | --- |
//! | gap | `v - u_N = 0` |
//! | slip | `u_T + 2 λ e = 0` |
//! | cone | `s - ρ (1 - e²) = 0` |
//! | products | `r_N v = τ`, `s λ = τ` |
//!
//! with `r_N, v, s, λ > 0` and `τ → 0`. (The cone equation is `ρ² - r_T² ≥ 0` divided by `ρ`; undivided, it has no
//! gradient at the tip of the cone.) A step with right-hand sides `b`, after elimination of `dv`, `ds` and `dλ`, solves
//!
//! ```text
//! r_N du_N + v dr_N = b_rv - r_N b_v
//! s du_T + (2 λ s / ρ) (dr_T - μ e dr_N) + 4 λ e (e·dr_T) - 2 λ μ (1 + e²) e dr_N = s b_T - 2 e (b_sλ - λ b_s)
//! ```
//!
//! This is `A du + B dr = b`, with each row divided by its largest coefficient. A contact without friction has only the
//! first row.

use crate::local::law::{Linear, LocalContact, UNIT, Vector3};
use stickslip::algebra::dot;

/// The unknowns of a contact, or their change.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Unknowns {
    pub r: Vector3,
    pub v: f64,
    pub s: f64,
    pub lambda: f64,
}

/// The residuals of the equations, as right-hand side of a step.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Missing {
    pub gap: f64,
    pub slip: [f64; 2],
    pub cone: f64,
    /// The residuals of `r_N v` and of `s λ`.
    pub products: [f64; 2],
}

impl Unknowns {
    /// Returns a point far inside the cone, with pressure `force` and distance `velocity`.
    pub(super) fn start(law: &LocalContact, force: f64, velocity: f64) -> Self {
        let (s, lambda) = if law.tangents > 0 { (law.mu * force, velocity / law.mu) } else { (0.0, 0.0) };
        Unknowns { r: [force, 0.0, 0.0], v: velocity, s, lambda }
    }

    /// Returns the pairs whose products go to zero.
    pub(super) fn pairs(&self, law: &LocalContact) -> impl Iterator<Item = (f64, f64)> {
        [(self.r[0], self.v), (self.s, self.lambda)].into_iter().take(if law.tangents > 0 { 2 } else { 1 })
    }

    /// Returns the point after a `step` along a direction.
    pub(super) fn ahead(&self, step: f64, direction: &Self) -> Self {
        Unknowns {
            r: [0, 1, 2].map(|k| self.r[k] + step * direction.r[k]),
            v: self.v + step * direction.v,
            s: self.s + step * direction.s,
            lambda: self.lambda + step * direction.lambda,
        }
    }

    /// Returns `ρ` and `e`.
    fn friction(&self, law: &LocalContact) -> (f64, [f64; 2]) {
        let rho = law.mu * self.r[0];
        (rho, [self.r[1] / rho, self.r[2] / rho])
    }

    /// Returns `ρ (1 - e²)`, the reserve of the cone.
    pub(super) fn room(&self, law: &LocalContact) -> f64 {
        let (rho, e) = self.friction(law);
        rho * (1.0 - dot(e, e))
    }

    /// Returns the residuals at the velocity `u` for `τ = 0`.
    pub(super) fn missing(&self, law: &LocalContact, u: Vector3) -> Missing {
        let mut missing = Missing { gap: u[0] - self.v, products: [-self.r[0] * self.v, 0.0], ..Missing::default() };
        if law.tangents > 0 {
            let (_, e) = self.friction(law);
            missing.slip = [0, 1].map(|k| -(u[k + 1] + 2.0 * self.lambda * e[k]));
            missing.cone = self.room(law) - self.s;
            missing.products[1] = -self.s * self.lambda;
        }
        missing
    }

    /// Returns `A` and `B`, and the divisors of the normal and the tangential rows.
    pub(super) fn linearize(&self, law: &LocalContact) -> (Linear, [f64; 2]) {
        let (mut by_u, mut by_r, mut sizes) = ([[0.0; 3]; 3], [[0.0; 3]; 3], [1.0; 2]);
        sizes[0] = (self.r[0] / law.stiffness).max(self.v);
        (by_u[0][0], by_r[0][0]) = (self.r[0] / sizes[0], self.v / sizes[0]);
        if law.tangents > 0 {
            let (rho, e) = self.friction(law);
            let (round, along) = (2.0 * self.lambda * self.s / rho, 4.0 * self.lambda);
            sizes[1] = (self.s / law.stiffness).max(round + along * dot(e, e));
            let by_normal = -law.mu * (round + 2.0 * self.lambda * (1.0 + dot(e, e)));
            for a in 0..law.tangents {
                by_u[a + 1][a + 1] = self.s / sizes[1];
                by_r[a + 1][0] = by_normal * e[a] / sizes[1];
                for b in 0..law.tangents {
                    by_r[a + 1][b + 1] = (round * UNIT[a][b] + along * e[a] * e[b]) / sizes[1];
                }
            }
        }
        (Linear { by_u, by_r }, sizes)
    }

    /// Returns the right-hand side of the reduced system.
    pub(super) fn reduce(&self, law: &LocalContact, sizes: [f64; 2], missing: &Missing) -> Vector3 {
        let normal = (missing.products[0] - self.r[0] * missing.gap) / sizes[0];
        if law.tangents == 0 {
            return [normal, 0.0, 0.0];
        }
        let (_, e) = self.friction(law);
        let multiplier = missing.products[1] - self.lambda * missing.cone;
        let [a, b] = [0, 1].map(|k| (self.s * missing.slip[k] - 2.0 * e[k] * multiplier) / sizes[1]);
        [normal, a, b]
    }

    /// Returns the complete direction, from changes `dr` of force and `du` of velocity. The smaller member of a pair is
    /// calculated from the product, because the difference of large numbers would lose most of its digits.
    pub(super) fn recover(&self, law: &LocalContact, missing: &Missing, dr: Vector3, du: Vector3) -> Self {
        let v =
            if self.r[0] > self.v { (missing.products[0] - self.v * dr[0]) / self.r[0] } else { du[0] + missing.gap };
        if law.tangents == 0 {
            return Unknowns { r: dr, v, s: 0.0, lambda: 0.0 };
        }
        let (_, e) = self.friction(law);
        let s = missing.cone + law.mu * (1.0 + dot(e, e)) * dr[0] - 2.0 * dot(e, [dr[1], dr[2]]);
        Unknowns { r: dr, v, s, lambda: (missing.products[1] - self.lambda * s) / self.s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A direction removes all residuals to first order.
    #[test]
    fn a_small_step_takes_away_its_share() {
        let w = [[1.0, 0.2, 0.1], [0.3, 0.8, -0.1], [0.1, -0.2, 0.9]];
        let times = |x: Vector3| [0, 1, 2].map(|k| dot(w[k], x));
        for tangents in [0, 1, 2] {
            let law = LocalContact::new(if tangents > 0 { 0.6 } else { 0.0 }, tangents, &w);
            let own = |x: Vector3| [0, 1, 2].map(|k| if k <= tangents { x[k] } else { 0.0 });
            let point =
                Unknowns { r: own([1.2, 0.2, 0.3]), v: 0.4, s: if tangents > 0 { 0.5 } else { 0.0 }, lambda: 0.7 };
            let velocity = |point: &Unknowns| {
                let product = times(point.r);
                own([product[0] - 0.7, product[1] + 0.5, product[2] - 0.2])
            };
            let missing = point.missing(&law, velocity(&point));
            let (Linear { by_u, by_r }, sizes) = point.linearize(&law);
            let rhs = point.reduce(&law, sizes, &missing);
            // Solves (A W + B) dr = b by Cramer's rule, with 1 on the diagonal of missing directions.
            let mut matrix = UNIT;
            for k in 0..=tangents {
                for l in 0..=tangents {
                    matrix[k][l] = (0..3).map(|m| by_u[k][m] * w[m][l]).sum::<f64>() + by_r[k][l];
                }
            }
            let determinant = |m: [[f64; 3]; 3]| dot(m[0], stickslip::algebra::cross(m[1], m[2]));
            let dr = own([0, 1, 2].map(|k| {
                let mut replaced = matrix;
                (0..3).for_each(|row| replaced[row][k] = rhs[row]);
                determinant(replaced) / determinant(matrix)
            }));
            let direction = point.recover(&law, &missing, dr, own(times(dr)));
            let numbers = |m: &Missing| [m.gap, m.slip[0], m.slip[1], m.cone, m.products[0], m.products[1]];
            let step = 1e-4;
            let ahead = point.ahead(step, &direction);
            let left = ahead.missing(&law, velocity(&ahead));
            for (before, after) in numbers(&missing).into_iter().zip(numbers(&left)) {
                assert!((after - (1.0 - step) * before).abs() < 1e-6, "{tangents}: {missing:?} {left:?}");
            }
        }
    }
}
