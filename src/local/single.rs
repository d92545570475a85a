//! The problem of one contact, `u = W r + q` with a block `W`, by formulas.
//!
//! Open, where `q_N ≥ 0`, and held, where `r = -W⁻¹ q` lies in the cone. Otherwise the contact slips: with `u_N = 0` the normal force
//! is `r_N = -(q_N + W_NT r_T) / W_NN`, what is left of the tangential rows is `u_T = A r_T + b`, and friction against it,
//! `u_T = -λ r_T` with `λ ≥ 0`, makes `r_T(λ) = -(A + λ)⁻¹ b`. The one number λ follows from `|r_T| = μ r_N`, whose difference is
//! positive at 0, where the force is beyond the cone, and negative for large λ, where no friction is left.

use super::law::{Contact, Vector3};
use super::scaled::Block;

/// Halvings of an interval are enough when it is as short as rounding.
const STEPS: usize = 100;

/// The force of a contact with the block `w` of `W` and the velocity `q` that it has without its force.
pub(super) fn force(law: &Contact, w: &Block, q: Vector3) -> Vector3 {
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
    let beyond = |t: [f64; 2]| t[0].hypot(t[1]) - law.mu * normal(t);
    let whole = |t: [f64; 2]| [normal(t), t[0], t[1]];
    let held = friction(0.0);
    if beyond(held) <= 0.0 {
        return whole(held);
    }
    // Where the matrix is regular and friction small: λ at which |r_T| is below any force of this contact.
    let (mut low, mut high) = (0.0, 1.0 / law.stiffness);
    for _ in 0..STEPS {
        if beyond(friction(high)) <= 0.0 {
            break;
        }
        (low, high) = (high, 4.0 * high);
    }
    for _ in 0..STEPS {
        // Between numbers far apart the middle is that of their sizes.
        let middle = if low > 0.0 && high > 4.0 * low { (low * high).sqrt() } else { 0.5 * (low + high) };
        if middle <= low || middle >= high {
            break;
        }
        if beyond(friction(middle)) <= 0.0 { high = middle } else { low = middle }
    }
    let t = friction(high);
    let n = normal(t).max(0.0);
    let reach = t[0].hypot(t[1]);
    // On the rim of the cone to the last digit.
    let share = if reach > 0.0 { law.mu * n / reach } else { 0.0 };
    [n, share * t[0], share * t[1]]
}
