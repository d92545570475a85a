//! Stress invariants: principal stresses, von Mises' stress.

/// An upper limit of the sweeps over the three rotations. Each sweep doubles the correct digits.
const MAX_SWEEPS: usize = 20;

/// Returns the principal stresses (Pa) of the stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa), the most tensile
/// first, by Jacobi's rotations; NaN if the stress is NaN.
pub fn principal_stresses([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 3] {
    let mut a = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    for _ in 0..MAX_SWEEPS {
        if a[0][1] == 0.0 && a[0][2] == 0.0 && a[1][2] == 0.0 {
            break;
        }
        for (p, q, r) in [(0, 1, 2), (0, 2, 1), (1, 2, 0)] {
            // Off-diagonal terms that vanish by rounding beside the diagonal count as zero.
            if a[p][q].abs() <= f64::EPSILON * 1e-3 * a[p][p].abs().min(a[q][q].abs()) {
                (a[p][q], a[q][p]) = (0.0, 0.0);
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            a[p][p] -= t * a[p][q];
            a[q][q] += t * a[p][q];
            (a[p][q], a[q][p]) = (0.0, 0.0);
            let (rp, rq) = (a[r][p], a[r][q]);
            (a[r][p], a[r][q]) = (c * rp - s * rq, s * rp + c * rq);
            (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
        }
    }
    let mut stresses = [a[0][0], a[1][1], a[2][2]];
    stresses.sort_by(|a, b| b.total_cmp(a));
    stresses
}

/// Returns von Mises' equivalent stress (Pa) of a stress in the same order.
pub fn von_mises([xx, yy, zz, xy, yz, zx]: [f64; 6]) -> f64 {
    let direct = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * direct + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: [f64; 3], expected: [f64; 3], scale: f64) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 4e-16 * scale), "{found:?}, not {expected:?}");
    }

    #[test]
    fn known_states() {
        close(principal_stresses([3.0, -1.0, 2.0, 0.0, 0.0, 0.0]), [3.0, 2.0, -1.0], 3.0);
        // Pure shear in each plane, also together with a much larger pressure.
        for shear in [[5.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 5.0]] {
            close(principal_stresses([0.0, 0.0, 0.0, shear[0], shear[1], shear[2]]), [5.0, 0.0, -5.0], 5.0);
        }
        close(principal_stresses([1e9, 1e9, 1e9, 3.0, 0.0, 4.0]), [1e9 + 5.0, 1e9, 1e9 - 5.0], 1e9);
        assert!(principal_stresses([f64::NAN, 0.0, 0.0, 1.0, 0.0, 0.0])[0].is_nan());
        assert_eq!(principal_stresses([0.0; 6]), [0.0; 3]);
    }

    /// The invariants agree with those of the tensor, even for entries of very different size.
    #[test]
    fn invariants_stay() {
        for k in 0..200 {
            let x =
                |i: u32| (f64::from(k * 7 + i * 13) * 1.7).sin() * 10.0_f64.powi((k as i32 * (i as i32 + 1)) % 9 - 4);
            let s = [x(0), x(1), x(2), x(3), x(4), x(5)];
            let p = principal_stresses(s);
            assert!(p[0] >= p[1] && p[1] >= p[2]);
            let squares = s[..3].iter().map(|x| x * x).sum::<f64>() + 2.0 * s[3..].iter().map(|x| x * x).sum::<f64>();
            let scale = squares.sqrt();
            assert!((p.iter().sum::<f64>() - (s[0] + s[1] + s[2])).abs() <= 1e-14 * scale);
            assert!((p.iter().map(|x| x * x).sum::<f64>() - squares).abs() <= 1e-14 * squares);
            let det = s[0] * (s[1] * s[2] - s[4] * s[4]) - s[3] * (s[3] * s[2] - s[4] * s[5])
                + s[5] * (s[3] * s[4] - s[1] * s[5]);
            assert!((p[0] * p[1] * p[2] - det).abs() <= 1e-13 * scale.powi(3), "{p:?} {det}");
            let mises = von_mises([p[0], p[1], p[2], 0.0, 0.0, 0.0]);
            assert!((mises - von_mises(s)).abs() <= 1e-13 * scale);
        }
    }
}
