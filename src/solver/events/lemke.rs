//! Lemke's method for a linear complementarity problem.
//!
//! Finds `z ≥ 0` with `q + M z ≥ 0` and `zᵀ (q + M z) = 0`. An artificial variable is added to every row, large
//! enough that `z = 0` is feasible. Complementary pivots then remove it again (Cottle, Pang, Stone, The Linear
//! Complementarity Problem, 1992, section 4.4).

/// A pivot below this share of the largest entry of its column counts as rounding.
const PIVOT: f64 = 1e-11;

/// The perturbation of the rows, relative to the largest entry of `q`.
const APART: f64 = 1e-9;

/// The number of pivots for each variable after which the method is assumed to cycle.
const PATIENCE: usize = 50;

/// Returns which of the `n` variables `z` are basic at a solution; the slacks of the others are basic. Returns `None`
/// if the method ends on a ray. `m` is stored row by row.
pub(super) fn lemke(m: &[f64], q: &[f64]) -> Option<Vec<bool>> {
    let n = q.len();
    if q.iter().all(|q| *q >= 0.0) {
        return Some(vec![false; n]);
    }
    // The perturbation prevents two rows from reaching 0 at once, so that no basis repeats. Multiples of the golden
    // section modulo 1 are all different.
    let size = q.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let apart = |i: usize| APART * size * (1.0 + (i as f64 * 0.618_033_988_749_895).fract());
    // w - M z - e z0 = q; variables 0..n are w, n..2n are z, 2n is z0, and the last column is the right-hand side.
    let width = 2 * n + 2;
    let (artificial, right) = (2 * n, 2 * n + 1);
    let mut table = vec![0.0; n * width];
    for (i, row) in table.chunks_exact_mut(width).enumerate() {
        row[i] = 1.0;
        row[n..2 * n].iter_mut().zip(&m[i * n..]).for_each(|(to, m)| *to = -m);
        row[artificial] = -1.0;
        row[right] = q[i] + apart(i);
    }
    let mut basis: Vec<usize> = (0..n).collect();
    let first = (0..n).min_by(|&a, &b| q[a].total_cmp(&q[b]))?;
    let (mut row, mut entering) = (first, artificial);
    for _ in 0..PATIENCE * (n + 1) {
        pivot(&mut table, width, row, entering);
        let left = std::mem::replace(&mut basis[row], entering);
        if left == artificial {
            return Some((0..n).map(|k| basis.contains(&(n + k))).collect());
        }
        entering = if left < n { left + n } else { left - n };
        row = ratio_test(&table, width, entering, &basis, artificial)?;
    }
    None
}

/// Returns the row whose basic variable `entering` drives to 0 first. The artificial variable wins ties.
fn ratio_test(table: &[f64], width: usize, entering: usize, basis: &[usize], artificial: usize) -> Option<usize> {
    let rows = || table.chunks_exact(width);
    let largest = rows().fold(0.0_f64, |m, row| m.max(row[entering].abs()));
    let ratio = |row: &[f64]| (row[entering] > PIVOT * largest).then(|| row[width - 1].max(0.0) / row[entering]);
    let least = rows().filter_map(ratio).min_by(f64::total_cmp)?;
    let ties = rows().enumerate().filter(|(_, row)| ratio(row).is_some_and(|ratio| ratio <= least * (1.0 + PIVOT)));
    ties.max_by(|(i, a), (k, b)| {
        let rank = |i: &usize| basis[*i] == artificial;
        rank(i).cmp(&rank(k)).then(a[entering].total_cmp(&b[entering]))
    })
    .map(|(row, _)| row)
}

/// Turns `column` into the unit vector with its 1 in `row`.
fn pivot(table: &mut [f64], width: usize, row: usize, column: usize) {
    let scale = 1.0 / table[row * width + column];
    let pivotal: Vec<f64> = table[row * width..][..width].iter().map(|value| value * scale).collect();
    for (i, other) in table.chunks_exact_mut(width).enumerate() {
        let factor = other[column];
        if i == row {
            other.copy_from_slice(&pivotal);
        } else if factor != 0.0 {
            other.iter_mut().zip(&pivotal).for_each(|(value, pivotal)| *value -= factor * pivotal);
            other[column] = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns `true` if `z` of this basis, solved from the rows of its variables, is a solution.
    fn holds(m: &[f64], q: &[f64], basic: &[bool]) -> bool {
        // Gauss–Seidel sweeps solve the small diagonally dominant systems of these tests.
        let n = q.len();
        let mut z = vec![0.0; n];
        for _ in 0..500 {
            for i in (0..n).filter(|&i| basic[i]) {
                let rest: f64 = (0..n).filter(|&j| j != i).map(|j| m[i * n + j] * z[j]).sum();
                z[i] = -(q[i] + rest) / m[i * n + i];
            }
        }
        let slack = |i: usize| q[i] + (0..n).map(|j| m[i * n + j] * z[j]).sum::<f64>();
        (0..n).all(|i| z[i] >= -1e-12 && slack(i) >= -1e-12)
    }

    #[test]
    fn complementary_solutions_are_found() {
        let m = [4.0, 1.0, -1.0, 1.0, 5.0, 2.0, -1.0, 2.0, 6.0];
        for q in [[1.0, 2.0, 3.0], [-1.0, 2.0, 3.0], [-1.0, -2.0, 0.5], [-3.0, -1.0, -2.0], [0.0, -1.0, 0.0]] {
            let basic = lemke(&m, &q).unwrap();
            assert!(holds(&m, &q, &basic), "{q:?}: {basic:?}");
        }
        // An unsymmetric matrix.
        let m = [3.0, -2.0, 2.0, 3.0];
        for q in [[-1.0, -1.0], [1.0, -2.0], [-2.0, 1.0]] {
            assert!(holds(&m, &q, &lemke(&m, &q).unwrap()), "{q:?}");
        }
    }

    #[test]
    fn where_there_is_none_it_ends() {
        assert_eq!(lemke(&[0.0], &[-1.0]), None);
        assert_eq!(lemke(&[-1.0], &[-1.0]), None);
        assert_eq!(lemke(&[0.0, 0.0, 0.0, 1.0], &[-1.0, -1.0]), None);
        // There are two solutions; either is correct.
        assert!(lemke(&[-1.0], &[1.0]).is_some());
    }
}
