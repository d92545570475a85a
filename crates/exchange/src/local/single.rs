//! Solves the problem of one contact, `u = W r + q` with a block `W`, by formulas.
//!
//! The contact is open if `q_N ≥ 0`, and sticks if `r = -W⁻¹ q` lies in the cone. Otherwise it slips. With `u_N = 0`
//! the normal force is `r_N = -(q_N + W_NT r_T) / W_NN`, the tangential rows become `u_T = A r_T + b`, and opposing
//! friction, `u_T = -λ r_T` with `λ ≥ 0`, gives `r_T(λ) = -(A + λ)⁻¹ b`. The single unknown λ follows from `|r_T| = μ
//! r_N`. The difference of both sides is positive at 0, where the force is outside the cone, and negative for large λ,
//! where no friction is left.

use super::law::{Block, LocalContact, Vector3};

/// The number of bisections, enough to reduce an interval to rounding.
const STEPS: usize = 100;

/// A determinant, relative to the square of the trace, that is hardly larger than the rounding of its terms.
const SINGULAR: f64 = 1e-10;

/// Returns the force of a contact with the block `w` of `W` and the velocity `q` without this force.
pub(super) fn force(law: &LocalContact, w: &Block, q: Vector3) -> Vector3 {
    if q[0] >= 0.0 || w[0][0] <= 0.0 {
        return [0.0; 3];
    }
    let normal = |t: [f64; 2]| -(q[0] + w[0][1] * t[0] + w[0][2] * t[1]) / w[0][0];
    if law.tangents == 0 {
        return [normal([0.0; 2]), 0.0, 0.0];
    }
    let reduced = |k: usize, l: usize| w[k][l] - w[k][0] * w[0][l] / w[0][0];
    let a = [[reduced(1, 1), reduced(1, 2)], [reduced(2, 1), reduced(2, 2)]];
    let b = [1, 2].map(|k| q[k] - w[k][0] * q[0] / w[0][0]);
    let friction = |lambda: f64| -> [f64; 2] {
        if law.tangents == 1 {
            return [-b[0] / (a[0][0] + lambda), 0.0];
        }
        let m = [[a[0][0] + lambda, a[0][1]], [a[1][0], a[1][1] + lambda]];
        let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
        [(m[0][1] * b[1] - m[1][1] * b[0]) / determinant, (m[1][0] * b[0] - m[0][0] * b[1]) / determinant]
    };
    let excess = |t: [f64; 2]| t[0].hypot(t[1]) - law.mu * normal(t);
    let whole = |t: [f64; 2]| [normal(t), t[0], t[1]];
    // If only motion in one direction can be stopped, the block is singular, and sticking is replaced by a very small
    // slip.
    let trace = a[0][0] + a[1][1];
    let regular = law.tangents == 1 || a[0][0] * a[1][1] - a[0][1] * a[1][0] > SINGULAR * trace * trace;
    let sticking = friction(if regular { 0.0 } else { SINGULAR * trace.abs() });
    if excess(sticking) <= 0.0 {
        return whole(sticking);
    }
    // λ for which the matrix is regular and |r_T| is below any force of this contact.
    let (mut low, mut high) = (0.0, 1.0 / law.stiffness);
    for _ in 0..STEPS {
        if excess(friction(high)) <= 0.0 {
            break;
        }
        (low, high) = (high, 4.0 * high);
    }
    for _ in 0..STEPS {
        // The geometric mean if the ends differ by orders of magnitude.
        let middle = if low > 0.0 && high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) };
        if middle <= low || middle >= high {
            break;
        }
        if excess(friction(middle)) <= 0.0 { high = middle } else { low = middle }
    }
    let t = friction(high);
    let n = normal(t).max(0.0);
    let reach = t[0].hypot(t[1]);
    // Moves the force to the boundary of the cone, to the last digit.
    let share = if reach > 0.0 { law.mu * n / reach } else { 0.0 };
    [n, share * t[0], share * t[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mass that falls on a floor: sticking, sliding, separating; and one that slides without friction.
    #[test]
    fn a_mass_on_a_floor() {
        let unit = crate::local::law::UNIT;
        let law = |mu: f64, tangents| LocalContact::new(mu, tangents, &unit);
        assert_eq!(force(&law(0.5, 2), &unit, [-2.0, 0.3, -0.4]), [2.0, -0.3, 0.4]);
        assert_eq!(force(&law(0.5, 2), &unit, [0.0, 3.0, 0.0]), [0.0; 3]);
        assert_eq!(force(&law(0.0, 0), &unit, [-2.0, 0.0, 0.0]), [2.0, 0.0, 0.0]);
        let slips = force(&law(0.5, 2), &unit, [-2.0, 3.0, -4.0]);
        assert!(slips.iter().zip([2.0, -0.6, 0.8]).all(|(a, b)| (a - b).abs() < 1e-14), "{slips:?}");
    }

    /// The force satisfies the law for blocks of any kind, including semidefinite and asymmetric ones.
    #[test]
    fn the_law_holds() {
        let mut seed = 7_u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 23) - 1.0
        };
        let (mut sticking, mut slipping) = (0, 0);
        for case in 0..3000 {
            let tangents = 1 + case % 2;
            let rank = if case % 7 == 0 { 2 } else { 3 };
            let factor: Vec<[f64; 3]> = (0..rank).map(|_| [random(), random(), random()]).collect();
            let mut w = [[0.0; 3]; 3];
            for (k, row) in w.iter_mut().enumerate().take(tangents + 1) {
                for (l, w) in row.iter_mut().enumerate().take(tangents + 1) {
                    let turn = if case % 5 == 0 && rank == 3 { 1e-4 * random() } else { 0.0 };
                    *w = factor.iter().map(|f| f[k] * f[l]).sum::<f64>() + turn;
                }
            }
            // A block without a clearly positive normal compliance belongs to no contact.
            if w[0][0] < 1e-2 {
                continue;
            }
            let law = LocalContact::new(1.5 * random().abs(), tangents, &w);
            // In the range of a singular block, from possible forces.
            let from = [random(), random(), if tangents == 2 { random() } else { 0.0 }];
            let q = [0, 1, 2].map(|k| w[k].iter().zip(from).map(|(w, r)| w * r).sum::<f64>());
            let r = force(&law, &w, q);
            let u = [0, 1, 2].map(|k| q[k] + w[k].iter().zip(r).map(|(w, r)| w * r).sum::<f64>());
            let size = r.iter().chain(&q.map(|q| q * law.stiffness)).fold(1.0_f64, |m, r| m.max(r.abs()));
            let missed = law.residual(r, u).iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let stiff = law.stiffness * w.iter().flatten().fold(0.0_f64, |m, w| m.max(w.abs()));
            assert!(missed <= 1e-6 * size * stiff.max(1.0), "{case}: {missed} {size} {law:?} {w:?} {q:?} {r:?}");
            if r[0] > 0.0 {
                if u[1].hypot(u[2]) > 1e-6 { slipping += 1 } else { sticking += 1 }
            }
        }
        assert!(sticking > 200 && slipping > 200, "{sticking} {slipping}");
    }
}
