//! The laws of one contact as an equation `F(r, u) = 0`, and its linearisation.
//!
//! `ρ` is the stiffness of the contact. With the trial forces `n = r_N - ρ u_N` and `t = r_T - ρ u_T`, and the friction
//! disk of the trial radius `μ n₊` (Alart and Curnier):
//!
//! ```text
//! F_N = r_N - n₊,   F_T = r_T - Π(t),   Π(t) = t where |t| ≤ μ n₊, otherwise μ n₊ e,   e = t / |t|
//! ```
//!
//! and `dF = A du + B dr` with
//!
//! | case | `A` | `B` |
//! | --- | --- | --- |
//! | open, `n ≤ 0` | 0 | 1 |
//! | closed: normal row | `ρ` | 0 |
//! | stick, `|t| ≤ μ n` | `ρ` | 0 |
//! | slip: at the normal, at the tangents | `ρ μ e`, `ρ κ P` | `-μ e`, `1 - κ P` |
//!
//! with `κ = μ n / |t|` and `P = 1 - e eᵀ`, which vanishes in the plane.

/// A matrix for the directions of one contact; rows and columns of missing directions are 0.
pub(super) type Block = [[f64; 3]; 3];

/// The values at a contact: normal, then tangents; 0 for missing directions.
pub(super) type Vector3 = [f64; 3];

/// One contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalContact {
    /// `μ`.
    pub mu: f64,
    /// The number of tangents; 0 without friction.
    pub tangents: usize,
    /// `ρ`, one over the largest diagonal entry of its block of `W`.
    pub stiffness: f64,
}

/// `dF = A du + B dr`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear {
    /// The derivative by velocities.
    pub by_u: Block,
    /// The derivative by forces.
    pub by_r: Block,
}

/// The unit matrix.
pub(super) const UNIT: Block = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl LocalContact {
    /// Creates a contact whose block of `W` is `diagonal`.
    pub(super) fn new(mu: f64, tangents: usize, diagonal: &Block) -> Self {
        let compliance = (0..=tangents).map(|k| diagonal[k][k]).fold(0.0, f64::max);
        let stiffness = if compliance > 0.0 { 1.0 / compliance } else { 1.0 };
        LocalContact { mu, tangents, stiffness }
    }

    /// Returns `(n, t)`.
    fn trial(&self, r: Vector3, u: Vector3) -> (f64, [f64; 2]) {
        let [n, a, b] = [0, 1, 2].map(|k| r[k] - self.stiffness * u[k]);
        (n, [a, b])
    }

    /// Returns `F`.
    pub(super) fn residual(&self, r: Vector3, u: Vector3) -> Vector3 {
        let (n, [a, b]) = self.trial(r, u);
        if n <= 0.0 {
            return r;
        }
        let sticking = u.map(|u| self.stiffness * u);
        let (reach, radius) = (a.hypot(b), self.mu * n);
        if reach <= radius {
            return sticking;
        }
        [sticking[0], r[1] - radius * (a / reach), r[2] - radius * (b / reach)]
    }

    /// Returns `A` and `B`.
    pub(super) fn linearize(&self, r: Vector3, u: Vector3) -> Linear {
        let (n, [a, b]) = self.trial(r, u);
        let (mut by_u, mut by_r) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        if n <= 0.0 {
            return Linear { by_u, by_r: UNIT };
        }
        by_u[0][0] = self.stiffness;
        let reach = a.hypot(b);
        if reach <= self.mu * n {
            (1..=self.tangents).for_each(|k| by_u[k][k] = self.stiffness);
            return Linear { by_u, by_r };
        }
        let (e, kappa) = ([a / reach, b / reach], self.mu * n / reach);
        let across = [[e[1] * e[1], -e[0] * e[1]], [-e[0] * e[1], e[0] * e[0]]];
        for k in 0..self.tangents {
            by_u[k + 1][0] = self.stiffness * self.mu * e[k];
            by_r[k + 1][0] = -self.mu * e[k];
            for l in 0..self.tangents {
                by_u[k + 1][l + 1] = self.stiffness * kappa * across[k][l];
                by_r[k + 1][l + 1] = UNIT[k][l] - kappa * across[k][l];
            }
        }
        Linear { by_u, by_r }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The linearisation is the derivative in every case.
    #[test]
    fn linearisation_is_the_derivative() {
        let diagonal = [[0.5, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.3]];
        for (tangents, r, u) in [
            (2, [0.3, 0.1, 0.0], [1.0, 0.2, 0.1]),
            (2, [1.0, 0.1, 0.2], [-0.1, 0.02, 0.01]),
            (2, [1.0, 0.3, -0.2], [-0.1, -0.7, 0.4]),
            (1, [1.0, 0.3, 0.0], [0.2, 0.9, 0.0]),
            (0, [1.0, 0.0, 0.0], [0.2, 0.0, 0.0]),
        ] {
            let law = LocalContact::new(if tangents > 0 { 0.4 } else { 0.0 }, tangents, &diagonal);
            let Linear { by_u, by_r } = law.linearize(r, u);
            for k in 0..=tangents {
                let step = 1e-6;
                let moved = |x: Vector3, step: f64| {
                    let mut x = x;
                    x[k] += step;
                    x
                };
                let slope = |a: Vector3, b: Vector3| [0, 1, 2].map(|c| (a[c] - b[c]) / (2.0 * step));
                let over_u = slope(law.residual(r, moved(u, step)), law.residual(r, moved(u, -step)));
                let over_r = slope(law.residual(moved(r, step), u), law.residual(moved(r, -step), u));
                for c in 0..=tangents {
                    assert!((over_u[c] - by_u[c][k]).abs() < 1e-8, "{law:?} {r:?} {u:?}: {over_u:?} {by_u:?}");
                    assert!((over_r[c] - by_r[c][k]).abs() < 1e-8, "{law:?} {r:?} {u:?}: {over_r:?} {by_r:?}");
                }
            }
        }
    }

    #[test]
    fn the_residual_vanishes_on_the_law() {
        let law = LocalContact::new(0.5, 2, &UNIT);
        for (r, u) in [
            ([0.0; 3], [1.0, 3.0, -2.0]),
            ([2.0, 0.3, 0.4], [0.0; 3]),
            ([2.0, -0.6, 0.8], [0.0, 3.0, -4.0]),
            ([0.0; 3], [0.0, 3.0, -4.0]),
        ] {
            let missed = law.residual(r, u);
            assert!(missed.iter().all(|f| f.abs() < 1e-15), "{r:?} {u:?}: {missed:?}");
        }
        assert_ne!(law.residual([2.0, 0.6, -0.8], [0.0, 3.0, -4.0]), [0.0; 3]);
    }
}
