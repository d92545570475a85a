//! The null space of a matrix with few columns, such as the at most six rigid modes.

/// The tolerance relative to the size of a row: far above rounding, and far below one element relative to the size of the
/// body.
pub(crate) const NEGLIGIBLE: f64 = 1e-10;

/// A row of a matrix with a handful of columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// One entry for each column.
    pub entries: Vec<f64>,
    /// The size of the terms that the entries are sums of. Entries that are negligible beside it are rounding.
    pub size: f64,
}

impl Row {
    /// A row of entries that are sums of terms of size one.
    pub fn of_unit_size(entries: Vec<f64>) -> Self {
        Row { entries, size: 1.0 }
    }
}

/// Motions of a body, and the values of linear forms of its displacements for them.
pub(crate) struct Motions<'a> {
    motions: &'a [Vec<f64>],
    /// The largest displacement of all of them.
    largest: f64,
}

impl<'a> Motions<'a> {
    /// Collects `motions`, each with one entry for each displacement.
    pub fn new(motions: &'a [Vec<f64>]) -> Self {
        let largest = motions.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        Motions { motions, largest }
    }

    /// Returns the value of the linear form with these coefficients for each motion.
    pub fn felt(&self, form: &[(usize, f64)]) -> Row {
        let size: f64 = form.iter().map(|(_, c)| c.abs()).sum();
        let felt = |motion: &Vec<f64>| form.iter().map(|&(j, c)| c * motion[j]).sum();
        Row { entries: self.motions.iter().map(felt).collect(), size: size * self.largest }
    }

    /// Returns the weights of the combinations of the motions for which each of the `rows` is 0: an orthonormal basis.
    pub fn unfelt(&self, rows: impl IntoIterator<Item = Row>) -> Vec<Vec<f64>> {
        null_space(self.motions.len(), rows)
    }
}

/// Returns the combinations of `motions` unit directions that no row constrains: an orthonormal basis of the null
/// space of the matrix with the given `rows`, each of length `motions`.
///
/// Processes one row at a time: rotates the remaining basis until only one member has a nonzero product with the row,
/// and removes that member. A row that is [`NEGLIGIBLE`] relative to its own size constrains nothing.
pub(crate) fn null_space(motions: usize, rows: impl IntoIterator<Item = Row>) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> =
        (0..motions).map(|k| (0..motions).map(|j| f64::from(u8::from(j == k))).collect()).collect();
    for Row { entries, size } in rows {
        let felt: Vec<f64> = basis.iter().map(|b| b.iter().zip(&entries).map(|(x, y)| x * y).sum()).collect();
        let norm = felt.iter().map(|c| c * c).sum::<f64>().sqrt();
        if norm <= NEGLIGIBLE * size {
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
        let null_space = |rows: Vec<Vec<f64>>| null_space(3, rows.into_iter().map(Row::of_unit_size));
        let basis = null_space(rows.clone());
        assert_eq!(basis.len(), 2);
        for b in &basis {
            assert!((b[0] + b[1]).abs() < 1e-15);
            assert!((b.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert!(basis[0].iter().zip(&basis[1]).map(|(x, y)| x * y).sum::<f64>().abs() < 1e-15);
        assert!(null_space([rows, vec![vec![0.0, 1.0, 0.0], vec![0.0, 0.0, -3.0]]].concat()).is_empty());
    }

    #[test]
    fn rows_count_by_their_own_size() {
        for size in [1e-100, 1e-12, 1.0, 1e12, 1e100] {
            let row = |entries: [f64; 2]| Row { entries: entries.map(|x| x * size).to_vec(), size };
            assert_eq!(null_space(2, [row([1.0, 0.0])]).len(), 1, "{size}");
            assert_eq!(null_space(2, [row([1.0, 0.0]), row([0.5, 1e-15])]).len(), 1, "{size}");
            assert_eq!(null_space(2, [row([0.0, 0.0]), row([1e-15, 1e-15])]).len(), 2, "{size}");
        }
    }
}
