//! The projection onto a polyhedral cone: non-negative least squares by the active set method of
//! Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23).

use crate::algebra::null_space::NEGLIGIBLE;
use crate::algebra::vector::dot;

/// Residuals are orthogonal to the columns of the fit up to about ten times 2.2e-16. A smaller angle between a column and
/// the residual is rounding.
const LEAST_ANGLE: f64 = 1e-14;

/// The cone `{Σ x_k a_k, x_k ≥ 0}` in a space of few dimensions.
pub(super) struct FiniteCone {
    dimension: usize,
    /// The `a_k`, as unit vectors.
    generators: Vec<Vec<f64>>,
}

impl FiniteCone {
    /// Creates the cone with the given `generators`; zero vectors are ignored.
    pub(super) fn new(dimension: usize, generators: impl IntoIterator<Item = Vec<f64>>) -> Self {
        FiniteCone {
            dimension,
            generators: generators.into_iter().filter_map(|a| unit(&a).map(|(_, unit)| unit)).collect(),
        }
    }

    /// Returns the residual `y` of `b` (see [`FiniteCone::residual`]), or `None` if it is negligible relative to
    /// `size`, the size of the terms whose sum is `b`: then `b` is in the cone.
    pub(super) fn outside(&self, b: &[f64], size: f64) -> Option<Vec<f64>> {
        let y = self.residual(b);
        (norm(&y) > NEGLIGIBLE * size).then_some(y)
    }

    /// Returns `y`, the difference of `b` and the nearest point of the cone: `a_k · y ≤ 0` for every generator, and
    /// `b · y = y · y`.
    pub(super) fn residual(&self, b: &[f64]) -> Vec<f64> {
        let Some((length, b)) = unit(b) else { return vec![0.0; self.dimension] };
        let mut residual = b.clone();
        // The indices and coefficients of the generators in use, at most as many as dimensions.
        let mut used: Vec<(usize, f64)> = Vec::new();
        let mut refused: Vec<usize> = Vec::new();
        // The residual shrinks with each change of the set of used generators, so no set repeats and few are tried.
        // The limit guards against rounding.
        for _ in 0..4 * (self.dimension + self.generators.len()) {
            let candidates = (0..self.generators.len())
                .filter(|k| !refused.contains(k) && used.iter().all(|(other, _)| other != k))
                .map(|k| (k, dot(&self.generators[k], &residual)));
            let Some((entering, gain)) = candidates.max_by(|a, b| a.1.total_cmp(&b.1)) else { break };
            let size = norm(&residual);
            if size <= NEGLIGIBLE || gain <= LEAST_ANGLE * size {
                break;
            }
            used.push((entering, 0.0));
            residual = self.descend(&mut used, &b);
            if used.iter().any(|&(k, _)| k == entering) {
                refused.clear();
            } else {
                // The generator entered by rounding and left again.
                refused.push(entering);
            }
        }
        residual.iter().map(|y| length * y).collect()
    }

    /// Moves the coefficients of the `used` generators to the least squares fit of `b`. A coefficient that would
    /// become negative stops at zero, and its generator is removed. Returns the residual.
    fn descend(&self, used: &mut Vec<(usize, f64)>, b: &[f64]) -> Vec<f64> {
        loop {
            let (fit, residual) = least_squares(used.iter().map(|&(k, _)| &self.generators[k]), b);
            let blocking = (used.iter().zip(&fit).enumerate())
                .filter(|(_, (_, to))| **to <= 0.0)
                .map(|(place, ((_, from), to))| (place, if *from > 0.0 { from / (from - to) } else { 0.0 }))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let step = blocking.map_or(1.0, |(_, step)| step);
            for ((_, x), to) in used.iter_mut().zip(&fit) {
                *x += step * (to - *x);
            }
            match blocking {
                Some((place, _)) => _ = used.remove(place),
                None => return residual,
            }
        }
    }
}

/// Returns the coefficients and the residual of the least squares fit of `b` by linearly independent `columns`.
/// Gram–Schmidt orthogonalisation, done twice, is as accurate as reflections.
fn least_squares<'a>(columns: impl Iterator<Item = &'a Vec<f64>>, b: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut r) = (Vec::<Vec<f64>>::new(), Vec::<Vec<f64>>::new());
    for column in columns {
        let (mut products, remainder) = without(&q, column);
        let length = norm(&remainder);
        products.push(length);
        r.push(products);
        q.push(remainder.iter().map(|x| x / length).collect());
    }
    let (mut x, residual) = without(&q, b);
    for k in (0..x.len()).rev() {
        x[k] /= r[k][k];
        for i in 0..k {
            x[i] -= r[k][i] * x[k];
        }
    }
    (x, residual)
}

/// Returns the products of `v` with the orthonormal `q`, and the component of `v` orthogonal to them.
fn without(q: &[Vec<f64>], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut products, mut remainder) = (vec![0.0; q.len()], v.to_vec());
    for _ in 0..2 {
        for (q, product) in q.iter().zip(&mut products) {
            let projection = dot(q, &remainder);
            *product += projection;
            remainder.iter_mut().zip(q).for_each(|(x, q)| *x -= projection * q);
        }
    }
    (products, remainder)
}

/// Returns the Euclidean length of `v`, without overflow or underflow.
pub(super) fn norm(v: &[f64]) -> f64 {
    unit(v).map_or(0.0, |(length, _)| length)
}

/// Returns the length and the direction of `v`, or `None` for zero.
fn unit(v: &[f64]) -> Option<(f64, Vec<f64>)> {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let scaled: Vec<f64> = v.iter().map(|x| x / largest).collect();
    let length = dot(&scaled, &scaled).sqrt();
    (largest > 0.0).then(|| (length * largest, scaled.iter().map(|x| x / length).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A generator of reproducible numbers with a uniform distribution in -1..1.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self, dimension: usize) -> Vec<f64> {
            (0..dimension).map(|_| self.next()).collect()
        }
    }

    /// Returns the distance of `b` from the cone: the smallest over all sets of `generators`, at most as many as
    /// dimensions, whose normal equations have a non-negative solution.
    fn distance(generators: &[Vec<f64>], b: &[f64]) -> f64 {
        let mut least = norm(b);
        for set in 1_u32..1 << generators.len() {
            let chosen: Vec<&Vec<f64>> =
                (0..generators.len()).filter(|k| set >> k & 1 == 1).map(|k| &generators[k]).collect();
            let n = chosen.len();
            if n > b.len() {
                continue;
            }
            // Gauss–Jordan elimination on the normal equations, with the right-hand side in the last column.
            let mut rows: Vec<Vec<f64>> =
                chosen.iter().map(|a| chosen.iter().copied().map(|c| dot(a, c)).chain([dot(a, b)]).collect()).collect();
            let mut regular = true;
            for k in 0..n {
                regular &= rows[k][k] > 1e-9;
                let pivot = rows[k].clone();
                for (i, row) in rows.iter_mut().enumerate() {
                    let factor = if i == k { 1.0 - 1.0 / pivot[k] } else { row[k] / pivot[k] };
                    row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
                }
            }
            if regular && rows.iter().all(|row| row[n] >= 0.0) {
                let mut y = b.to_vec();
                for (a, row) in chosen.iter().zip(&rows) {
                    y.iter_mut().zip(a.iter()).for_each(|(y, a)| *y -= row[n] * a);
                }
                least = least.min(norm(&y));
            }
        }
        least
    }

    #[test]
    fn no_set_of_generators_comes_closer() {
        let mut random = Random(1);
        let (mut inside, mut outside) = (0, 0);
        for trial in 0..4000 {
            let dimension = 2 + trial % 2;
            let mut generators: Vec<Vec<f64>> = (0..=trial % 7).map(|_| random.vector(dimension)).collect();
            if trial % 3 == 0 {
                // Repeats the generators with other lengths, as many nodes under one plane would.
                let more: Vec<Vec<f64>> = generators.iter().map(|a| a.iter().map(|x| 1e3 * x).collect()).collect();
                generators.extend(more.into_iter().take(2));
            }
            let b = random.vector(dimension);
            let y = FiniteCone::new(dimension, generators.clone()).residual(&b);
            let least = distance(&generators, &b);
            assert!((norm(&y) - least).abs() < 1e-8, "{generators:?}, {b:?}: {y:?}, not {least}");
            assert!(generators.iter().all(|a| dot(a, &y) <= 1e-12 * norm(a)), "{generators:?}, {b:?}: {y:?}");
            assert!((dot(&b, &y) - dot(&y, &y)).abs() < 1e-12);
            if least < 1e-8 { inside += 1 } else { outside += 1 }
        }
        assert!(inside > 500 && outside > 500, "{inside} {outside}");
    }

    #[test]
    fn in_six_dimensions_the_residual_is_in_the_polar_cone() {
        let mut random = Random(2);
        for trial in 0..200 {
            // Rounded to a few values, so that many vectors are parallel or coplanar.
            let coarse = |v: Vec<f64>| v.iter().map(|x| (1.5 * x).round()).collect::<Vec<f64>>();
            let generators: Vec<Vec<f64>> = (0..=2 * trial % 60).map(|_| coarse(random.vector(6))).collect();
            let b = coarse(random.vector(6));
            let y = FiniteCone::new(6, generators.clone()).residual(&b);
            assert!(generators.iter().all(|a| dot(a, &y) <= 1e-12), "{generators:?}, {b:?}: {y:?}");
            assert!((dot(&b, &y) - dot(&y, &y)).abs() < 1e-12);
        }
    }

    #[test]
    fn thousands_of_generators_and_any_magnitude() {
        // The rim of a circular cone around the first axis, with a half angle of 45°.
        let rim = |angle: f64| vec![1e-200, 1e-200 * angle.cos(), 1e-200 * angle.sin()];
        let angles = (0..5000).map(|k| f64::from(k) / 2500.0 * std::f64::consts::PI);
        let cone = FiniteCone::new(3, angles.map(rim).chain([vec![0.0; 3]]));
        assert_eq!(cone.generators.len(), 5000);
        assert_eq!(cone.outside(&[1e200, 0.0, 0.9e200], 1e200), None);
        assert_eq!(cone.outside(&[0.0; 3], 0.0), None);
        let y = cone.outside(&[0.0, 0.0, 1e200], 1e200).unwrap();
        let expected = [-0.5e200, 0.0, 0.5e200];
        assert!(y.iter().zip(expected).all(|(y, e)| (y - e).abs() < 1e188), "{y:?}");
        assert_eq!(FiniteCone::new(0, []).outside(&[], 0.0), None);
        assert_eq!(FiniteCone::new(2, []).outside(&[3.0, 4.0], 5.0), Some(vec![3.0, 4.0]));
    }
}
