//! Dense symmetric matrices whose clones share their entries.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::{MatrixError, expect_length};
use crate::algebra::vector::dot;

/// The number of entries below which a product is faster in one thread.
const PARALLEL_ENTRIES: usize = 1 << 17;

/// The smallest number of rows for one thread.
const ROWS: usize = 32;

/// A dense symmetric matrix: a factor times entries that all its clones share, whatever their factors.
///
/// Both triangles are stored, column by column, so that a row is a column. Every sum of a product therefore has
/// contiguous terms, belongs to one thread, and has one order for any number of threads.
#[derive(Debug, Clone)]
pub struct DenseSymmetric {
    shared: Arc<Shared>,
    factor: f64,
}

#[derive(Debug, Clone)]
struct Shared {
    order: usize,
    values: Vec<f64>,
    /// The largest absolute value in each row, computed on demand.
    row_norms: OnceLock<Vec<f64>>,
}

impl PartialEq for DenseSymmetric {
    fn eq(&self, other: &Self) -> bool {
        let is_one = Arc::ptr_eq(&self.shared, &other.shared);
        self.factor == other.factor && (is_one || self.shared.values == other.shared.values)
    }
}

impl DenseSymmetric {
    /// Creates the matrix of order `n` with the lower triangle of these `values`, column by column. Values above the
    /// diagonal are ignored.
    ///
    /// # Errors
    /// If there are not `n²` values, or one in the lower triangle is NaN or infinite.
    pub fn from_lower(n: usize, values: Vec<f64>) -> Result<Self, MatrixError> {
        expect_length("values of the matrix", n.saturating_mul(n), values.len())?;
        let lower = (0..n).flat_map(|column| (column..n).map(move |row| (row, column)));
        match lower.map(|(row, column)| (row, column, values[column * n + row])).find(|entry| !entry.2.is_finite()) {
            Some((row, column, value)) => Err(MatrixError::NotFinite { row, column, value }),
            None => Ok(Self::of_lower(n, values)),
        }
    }

    /// Computes [`DenseSymmetric::from_lower`] for the right number of values, without checking them.
    pub(crate) fn of_lower(n: usize, mut values: Vec<f64>) -> Self {
        mirror(&mut values, n);
        DenseSymmetric { shared: Arc::new(Shared { order: n, values, row_norms: OnceLock::new() }), factor: 1.0 }
    }

    /// Returns the order.
    pub fn order(&self) -> usize {
        self.shared.order
    }

    /// Returns the matrix times `factor`, with the same entries in memory.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        DenseSymmetric { factor: self.factor * factor, ..self.clone() }
    }

    /// Returns the entry at `(row, column)`, or 0 outside the matrix.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let n = self.order();
        if row.max(column) < n { self.factor * self.shared.values[column * n + row] } else { 0.0 }
    }

    /// Returns the factor of the shared entries.
    pub(crate) fn factor(&self) -> f64 {
        self.factor
    }

    /// Returns a column, which is also a row, without the factor.
    pub(crate) fn column(&self, j: usize) -> &[f64] {
        let n = self.order();
        &self.shared.values[j * n..(j + 1) * n]
    }

    /// Iterates over the entries on and below the diagonal as `(row, column, value)`, column by column.
    pub(crate) fn lower_entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let n = self.order();
        (0..n).flat_map(move |j| self.column(j)[j..].iter().zip(j..).map(move |(value, i)| (i, j, self.factor * value)))
    }

    /// Iterates over all entries as `(row, column, value)`, column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let n = self.order();
        (0..n).flat_map(move |j| self.column(j).iter().enumerate().map(move |(i, value)| (i, j, self.factor * value)))
    }

    /// Adds `value` at `(row, column)` and its mirror image; the matrix no longer shares its entries.
    pub(crate) fn raise(&mut self, row: usize, column: usize, value: f64) {
        let shared = self.owned();
        let n = shared.order;
        shared.values[column * n + row] += value;
        if row != column {
            shared.values[row * n + column] += value;
        }
    }

    /// Returns the entries multiplied by the factor, no longer shared.
    fn owned(&mut self) -> &mut Shared {
        let factor = std::mem::replace(&mut self.factor, 1.0);
        let shared = Arc::make_mut(&mut self.shared);
        shared.row_norms = OnceLock::new();
        if factor != 1.0 {
            shared.values.iter_mut().for_each(|value| *value *= factor);
        }
        shared
    }

    /// Returns the largest absolute value in each row without the factor; NaN counts as the largest.
    fn unscaled_row_norms(&self) -> &[f64] {
        let larger = |m: f64, value: &f64| if value.abs() > m || value.is_nan() { value.abs() } else { m };
        let norm = |j: usize| self.column(j).iter().fold(0.0, larger);
        self.shared.row_norms.get_or_init(|| (0..self.order()).map(norm).collect())
    }

    /// Returns the largest absolute value in each row.
    pub(crate) fn row_norms(&self) -> impl Iterator<Item = f64> + '_ {
        self.unscaled_row_norms().iter().map(|norm| self.factor.abs() * norm)
    }

    /// Returns the largest absolute value.
    pub(crate) fn largest_entry(&self) -> f64 {
        self.row_norms().fold(0.0, f64::max)
    }

    /// Returns `true` if all entries are finite.
    pub(crate) fn is_finite(&self) -> bool {
        self.row_norms().all(f64::is_finite)
    }

    /// Computes `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.each_row(y, |row, y| *y = self.factor * dot(row, x));
    }

    /// Computes `y += |A| |x|`.
    pub(crate) fn add_sizes(&self, x: &[f64], y: &mut [f64]) {
        self.each_row(y, |row, y| *y += self.factor.abs() * dot_and_size(row, x).1);
    }

    /// Computes `r -= A x`, `s += |A| |x|`, in one pass over the matrix.
    pub(crate) fn residual(&self, x: &[f64], r: &mut [f64], s: &mut [f64]) {
        let mut both: Vec<(f64, f64)> = r.iter().copied().zip(s.iter().copied()).collect();
        self.each_row(&mut both, |row, (r, s)| {
            let (product, size) = dot_and_size(row, x);
            *r -= self.factor * product;
            *s += self.factor.abs() * size;
        });
        for ((r, s), both) in r.iter_mut().zip(s).zip(both) {
            (*r, *s) = both;
        }
    }

    /// Returns the products of some rows with `x`.
    pub(crate) fn products(&self, rows: &[usize], x: &[f64]) -> Vec<f64> {
        let product = |&row: &usize| self.factor * dot(self.column(row), x);
        if rows.len() * self.order() < PARALLEL_ENTRIES {
            rows.iter().map(product).collect()
        } else {
            rows.par_iter().with_min_len(ROWS).map(product).collect()
        }
    }

    /// Calls `work` with each row and its result.
    fn each_row<T: Send>(&self, results: &mut [T], work: impl Fn(&[f64], &mut T) + Sync) {
        let n = self.order();
        if n * n < PARALLEL_ENTRIES {
            results.iter_mut().enumerate().for_each(|(i, result)| work(self.column(i), result));
        } else {
            let rows = results.par_iter_mut().with_min_len(ROWS).enumerate();
            rows.for_each(|(i, result)| work(self.column(i), result));
        }
    }
}

/// Returns `Σ a_k b_k` and `Σ |a_k b_k|`; the first equals [`dot`] to the last bit.
fn dot_and_size(a: &[f64], b: &[f64]) -> (f64, f64) {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let (mut sums, mut sizes) = ([0.0; 8], [0.0; 8]);
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            let product = a[k] * b[k];
            sums[k] += product;
            sizes[k] += product.abs();
        }
    }
    let rest = || a_rest.iter().zip(b_rest).map(|(a, b)| a * b);
    let (rest_sum, rest_size): (f64, f64) = (rest().sum(), rest().map(f64::abs).sum());
    (sums.iter().sum::<f64>() + rest_sum, sizes.iter().sum::<f64>() + rest_size)
}

/// Copies the lower triangle of an n × n matrix, column by column, to the upper one.
pub(crate) fn mirror(values: &mut [f64], n: usize) {
    // Block by block, since either the reads or the writes have the stride n.
    const SIDE: usize = 32;
    for first_column in (0..n).step_by(SIDE) {
        for first_row in (first_column..n).step_by(SIDE) {
            for column in first_column..n.min(first_column + SIDE) {
                for row in first_row.max(column + 1)..n.min(first_row + SIDE) {
                    values[row * n + column] = values[column * n + row];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::sparse::Symmetric;

    fn values(n: usize) -> Vec<f64> {
        (0..n * n).map(|k| (1.0 + 0.37 * k as f64).sin()).collect()
    }

    /// Creates a matrix from the entries of the lower triangle.
    fn sparse(dense: &DenseSymmetric) -> Symmetric {
        Symmetric::from_triplets(dense.order(), &dense.lower_entries().collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn products_are_those_of_a_sparse_matrix() {
        // The last has enough rows for several threads.
        for n in [1, 7, 40, 65, 400] {
            let dense = DenseSymmetric::from_lower(n, values(n)).unwrap().scaled(0.25);
            let sparse = sparse(&dense);
            let x: Vec<f64> = (0..n).map(|i| (2.0 + i as f64).cos()).collect();
            let close = |a: &[f64], b: &[f64]| {
                assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-15 * n as f64), "{n}: {a:?} {b:?}");
            };
            let (mut y, mut expected) = (vec![0.0; n], vec![0.0; n]);
            dense.mul(&x, &mut y);
            sparse.mul(&x, &mut expected);
            close(&y, &expected);
            let rows: Vec<usize> = (0..n).filter(|row| row % 3 != 1).collect();
            assert_eq!(dense.products(&rows, &x), rows.iter().map(|&row| y[row]).collect::<Vec<_>>());
            let (mut s, mut sizes) = (vec![1.0; n], vec![1.0; n]);
            dense.add_sizes(&x, &mut s);
            sparse.add_sizes(&x, &mut sizes);
            close(&s, &sizes);
            let (mut r, mut both) = (vec![0.0; n], vec![1.0; n]);
            dense.residual(&x, &mut r, &mut both);
            assert!(r.iter().zip(&y).all(|(r, y)| *r == -y) && both == s);
            let largest = sparse.entries().fold(0.0_f64, |m, entry| m.max(entry.2.abs()));
            assert_eq!(dense.largest_entry(), largest);
        }
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let n = 500;
        let dense = DenseSymmetric::from_lower(n, values(n)).unwrap();
        let x: Vec<f64> = (0..n).map(|i| (2.0 + i as f64).cos()).collect();
        let with = |threads: usize| {
            let (mut y, mut r, mut s) = (vec![0.0; n], vec![0.5; n], vec![0.5; n]);
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                dense.mul(&x, &mut y);
                dense.residual(&x, &mut r, &mut s);
            });
            [y, r, s]
        };
        assert!(n * n >= PARALLEL_ENTRIES);
        assert_eq!(with(1), with(2));
        assert_eq!(with(1), with(3));
    }

    #[test]
    fn clones_share_until_one_is_changed() {
        let a = DenseSymmetric::from_lower(2, vec![1.0, 2.0, f64::NAN, 3.0]).unwrap();
        let mut b = a.scaled(2.0);
        assert!(Arc::ptr_eq(&a.shared, &b.shared));
        assert_eq!((b.get(0, 1), b.largest_entry()), (4.0, 6.0));
        b.raise(1, 0, 5.0);
        assert_eq!([b.get(0, 1), b.get(1, 0), b.get(1, 1), b.largest_entry()], [9.0, 9.0, 6.0, 9.0]);
        assert_eq!([a.get(0, 1), a.get(1, 0), a.get(1, 1), a.largest_entry()], [2.0, 2.0, 3.0, 3.0]);
        let refused = DenseSymmetric::from_lower(2, vec![1.0, f64::NAN, 0.0, 1.0]);
        assert!(matches!(refused, Err(MatrixError::NotFinite { row: 1, column: 0, .. })));
        assert!(matches!(DenseSymmetric::from_lower(2, vec![1.0]), Err(MatrixError::Length { .. })));
    }
}
