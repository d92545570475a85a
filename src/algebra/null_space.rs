//! The null space of a matrix with few columns, such as the at most six rigid modes.

/// The tolerance relative to unit rows: far above rounding and far below one element relative to the size of the
/// body.
pub(crate) const NEGLIGIBLE: f64 = 1e-10;

/// Returns the combinations of `motions` unit directions that no row constrains: an orthonormal basis of the null
/// space of the matrix with the given `rows`, each of length `motions`.
///
/// Processes one row at a time: rotates the remaining basis until only one member has a nonzero product with the row,
/// and removes that member.
pub(crate) fn null_space(motions: usize, rows: impl IntoIterator<Item = Vec<f64>>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> =
        (0..motions).map(|k| (0..motions).map(|j| f64::from(u8::from(j == k))).collect()).collect();
    for row in rows {
        let felt: Vec<f64> = basis.iter().map(|b| b.iter().zip(&row).map(|(x, y)| x * y).sum()).collect();
        let norm = felt.iter().map(|c| c * c).sum::<f64>().sqrt();
        if norm <= NEGLIGIBLE {
            continue;
        }
        // The Householder reflection that turns `felt` into a multiple of the first direction.
        let mut v = felt.clone();
        v[0] += norm.copysign(felt[0]);
        let vv: f64 = v.iter().map(|x| x * x).sum();
        let mut along = vec![0.0; motions];
        for (b, &vk) in basis.iter().zip(&v) {
            for (sum, x) in along.iter_mut().zip(b) {
                *sum += vk * x;
            }
        }
        for (b, vk) in basis.iter_mut().zip(&v) {
            for (x, sum) in b.iter_mut().zip(&along) {
                *x -= 2.0 * vk / vv * sum;
            }
        }
        basis.remove(0);
        if basis.is_empty() {
            break;
        }
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_take_directions_away_one_by_one() {
        let rows = vec![vec![1.0, 1.0, 0.0], vec![2.0, 2.0, 0.0]];
        let basis = null_space(3, rows.clone());
        assert_eq!(basis.len(), 2);
        for b in &basis {
            assert!((b[0] + b[1]).abs() < 1e-15);
            assert!((b.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert!(basis[0].iter().zip(&basis[1]).map(|(x, y)| x * y).sum::<f64>().abs() < 1e-15);
        assert!(null_space(3, rows.into_iter().chain([vec![0.0, 1.0, 0.0], vec![0.0, 0.0, -3.0]])).is_empty());
    }
}
