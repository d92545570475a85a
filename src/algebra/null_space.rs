//! The null space of a matrix with a handful of columns, such as the six rigid motions at most.

/// Relative to the size of a row; far above rounding and far below one element against the body's size.
pub const NEGLIGIBLE: f64 = 1e-10;

/// A row of a matrix with a handful of columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// One entry for each column.
    pub entries: Vec<f64>,
    /// The size of the terms that the entries are sums of: what is negligible beside it is rounding.
    pub size: f64,
}

impl Row {
    /// A row of entries that are sums of terms of size one.
    pub fn of_unit_size(entries: Vec<f64>) -> Self {
        Row { entries, size: 1.0 }
    }
}

/// Motions of a large body, and what linear forms of its displacements say of them.
pub struct Motions<'a> {
    motions: &'a [Vec<f64>],
    /// The largest displacement of all of them.
    largest: f64,
}

impl<'a> Motions<'a> {
    /// These motions, each with one entry for each displacement.
    pub fn new(motions: &'a [Vec<f64>]) -> Self {
        let largest = motions.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        Motions { motions, largest }
    }

    /// What the linear form with these coefficients says of each motion.
    pub fn felt(&self, form: &[(usize, f64)]) -> Row {
        let size: f64 = form.iter().map(|(_, c)| c.abs()).sum();
        let felt = |motion: &Vec<f64>| form.iter().map(|&(j, c)| c * motion[j]).sum();
        Row { entries: self.motions.iter().map(felt).collect(), size: size * self.largest }
    }

    /// The weights of the motions in those combinations of them for which each of the `rows` is 0: an orthonormal basis.
    pub fn unfelt(&self, rows: impl IntoIterator<Item = Row>) -> Vec<Vec<f64>> {
        null_space(self.motions.len(), rows)
    }
}

/// The combinations of `motions` unit directions that no row constrains: an orthonormal basis of
/// the null space of the matrix with the given `rows`, each as long as there are directions.
///
/// Works row by row: what is left of the basis is turned until a single member feels the row, and
/// that member is dropped. A row that is [`NEGLIGIBLE`] beside its own size constrains nothing.
pub fn null_space(motions: usize, rows: impl IntoIterator<Item = Row>) -> Vec<Vec<f64>> {
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
