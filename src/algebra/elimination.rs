//! Small dense systems by Gauss-Jordan elimination.

/// A smaller pivot counts as rounding; the columns of the matrix have the size 1.
const SINGULAR: f64 = 1e-10;

/// Replaces B by `A⁻¹ B` by Gauss-Jordan elimination; each row contains a row of A followed by a row of B. `None` if A
/// is singular.
pub(crate) fn solve<const N: usize>(rows: &mut [[f64; N]]) -> Option<()> {
    let n = rows.len();
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, largest);
        let pivot = rows[k][k];
        if pivot.abs() < SINGULAR {
            return None;
        }
        rows[k].iter_mut().for_each(|x| *x /= pivot);
        let scaled = rows[k];
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row[k..].iter_mut().zip(&scaled[k..]).for_each(|(x, y)| *x -= factor * y);
        }
    }
    Some(())
}
