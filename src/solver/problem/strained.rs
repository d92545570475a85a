//! Displacements without their rigid part.

use crate::algebra::sparse::DoubleDouble;

/// Removes from `u + rest` its part along the `rigid_modes`, in double-double arithmetic. `K` gives no forces for
/// this part, but if it is large, rounding of the entries of `K` would exceed the forces.
pub(crate) fn strained(rigid_modes: &[Vec<f64>], u: &[f64], u_rest: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut u, mut u_rest) = (u.to_vec(), u_rest.to_vec());
    u_rest.resize(u.len(), 0.0);
    let mut basis = Vec::<Vec<f64>>::new();
    for motion in rigid_modes {
        let mut motion = motion.clone();
        for other in &basis {
            let share = product(&motion, other) / product(other, other);
            motion.iter_mut().zip(other).for_each(|(r, other)| *r -= share * other);
        }
        basis.push(motion);
    }
    // The second pass removes the rounding of the first.
    for motion in basis.iter().chain(&basis) {
        let share = product(&u, motion) / product(motion, motion);
        for ((u, rest), r) in u.iter_mut().zip(&mut u_rest).zip(motion) {
            let mut left = DoubleDouble::default();
            left.add(*u);
            left.add_product(-share, *r);
            left.add(*rest);
            *u = left.value();
            left.add(-*u);
            *rest = left.value();
        }
    }
    (u, u_rest)
}

#[cfg(test)]
mod tests {
    use super::strained;

    #[test]
    fn what_is_small_beside_a_free_motion_is_left() {
        let motions = [vec![1.0, 1.0, 1.0, 1.0], vec![0.0, 1.0, 2.0, 3.0]];
        // 1e9 along one mode and 1e6 along the other, plus a strained part below the rounding of these.
        let u_lo = [1e-8, -1e-8, -1e-8, 1e-8];
        let u: Vec<f64> = (0..4).map(|i| 1e9 + 1e6 * f64::from(i)).collect();
        let (left, u_rest) = strained(&motions, &u, &u_lo);
        for ((left, rest), part) in left.iter().zip(&u_rest).zip(u_lo) {
            assert!((left + rest - part).abs() < 1e-15, "{left} {rest}");
        }
        assert_eq!(strained(&[], &u, &[]), (u, vec![0.0; 4]));
    }
}
