//! Singular values of the small matrices of one node, by one-sided Jacobi rotations, which keep the digits of small
//! ones.

/// A matrix of at most three by three; missing entries are 0.
pub(super) type Small = [[f64; 3]; 3];

pub(super) const ONE: Small = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
#[cfg(test)]
pub(super) const ZERO: Small = [[0.0; 3]; 3];

/// A pair of columns is orthogonal if their product is below this share of their sizes.
const ORTHOGONAL: f64 = 1e-15;
const SWEEPS: usize = 30;

/// The decomposition `m = left diag(values) rightᵀ`, the largest value first. Columns of `left` are 0 if the value is
/// 0.
pub(super) struct Decomposition {
    pub left: Small,
    pub values: [f64; 3],
    pub right: Small,
}

pub(super) fn decompose(m: &Small) -> Decomposition {
    let (mut w, mut v) = (*m, ONE);
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let product = |a: usize, b: usize| (0..3).map(|i| w[i][a] * w[i][b]).sum::<f64>();
            let (pp, qq, pq) = (product(p, p), product(q, q), product(p, q));
            if pq.abs() <= ORTHOGONAL * (pp * qq).sqrt() || pq == 0.0 {
                continue;
            }
            let zeta = (qq - pp) / (2.0 * pq);
            let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            for row in w.iter_mut().chain(&mut v) {
                (row[p], row[q]) = (c * row[p] - c * t * row[q], c * t * row[p] + c * row[q]);
            }
        }
    }
    let size = |k: usize| w.iter().fold(0.0_f64, |size, row| size.hypot(row[k]));
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    let values = order.map(size);
    let left = w.map(|row| [0, 1, 2].map(|k| if values[k] > 0.0 { row[order[k]] / values[k] } else { 0.0 }));
    Decomposition { left, values, right: v.map(|row| order.map(|k| row[k])) }
}

impl Decomposition {
    /// Returns the pseudo-inverse, with those values alone that are more than `negligible`.
    pub(super) fn inverse(&self, negligible: f64) -> Small {
        let inverse = self.values.map(|s| if s > negligible { 1.0 / s } else { 0.0 });
        times(&self.right.map(|row| [0, 1, 2].map(|k| row[k] * inverse[k])), &transposed(&self.left))
    }
}

/// Returns the pseudo-inverse of `m`, which ignores singular values below the share `negligible` of the largest.
pub(super) fn pseudo_inverse(m: &Small, negligible: f64) -> Small {
    let decomposition = decompose(m);
    decomposition.inverse(negligible * decomposition.values[0])
}

pub(super) fn times(a: &Small, b: &Small) -> Small {
    a.map(|row| [0, 1, 2].map(|j| (0..3).map(|k| row[k] * b[k][j]).sum()))
}

pub(super) fn transposed(a: &Small) -> Small {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[j][i]))
}

/// Returns the product of several matrices.
pub(super) fn product(of: &[&Small]) -> Small {
    of.iter().skip(1).fold(*of[0], |left, right| times(&left, right))
}

pub(super) fn minus(a: &Small, b: &Small) -> Small {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| a[i][j] - b[i][j]))
}

#[cfg(test)]
pub(super) fn on(a: &Small, x: [f64; 3]) -> [f64; 3] {
    a.map(|row| (0..3).map(|k| row[k] * x[k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest(a: &Small) -> f64 {
        a.iter().flatten().fold(0.0, |m, v| m.max(v.abs()))
    }

    #[test]
    fn small_singular_values_keep_their_digits() {
        // Rotations with values fourteen decades apart.
        let (c, s) = (0.6, 0.8);
        let left = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let right = [[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]];
        let values = [[2.0, 0.0, 0.0], [0.0, 1e-7, 0.0], [0.0, 0.0, 3e-14]];
        let m = times(&times(&left, &values), &right);
        let found = decompose(&m);
        for (found, expected) in found.values.into_iter().zip([2.0, 1e-7]) {
            assert!((found - expected).abs() <= 1e-8 * expected, "{found} {expected}");
        }
        let diagonal = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { found.values[i] } else { 0.0 }));
        let again = times(&times(&found.left, &diagonal), &transposed(&found.right));
        let difference = [0, 1, 2].map(|i| [0, 1, 2].map(|j| again[i][j] - m[i][j]));
        assert!(largest(&difference) <= 1e-15);
    }

    #[test]
    fn a_pseudo_inverse_inverts_what_can_be_inverted() {
        let m = [[0.0, 2.0, 0.0], [0.0, 0.0, 0.0], [-4.0, 0.0, 0.0]];
        assert_eq!(pseudo_inverse(&m, 1e-10), [[0.0, 0.0, -0.25], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]);
        assert_eq!(pseudo_inverse(&ZERO, 1e-10), ZERO);
    }
}
