//! Symmetric matrices: sparse ones, stored as their lower triangle, and dense ones.

use std::borrow::Cow;
use std::sync::Arc;

use super::{Csc, DenseSymmetric, MatrixError, Pattern, expect_length};

/// A symmetric matrix.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    stored: Stored,
}

#[derive(Debug, Clone, PartialEq)]
enum Stored {
    /// The lower triangle, including the diagonal.
    Lower(Csc),
    Dense(DenseSymmetric),
}

impl From<DenseSymmetric> for Symmetric {
    fn from(dense: DenseSymmetric) -> Self {
        Symmetric { stored: Stored::Dense(dense) }
    }
}

/// The largest difference of mirrored entries, relative to the diagonal entries of their row and column. It allows
/// only for rounding of sums in a different order.
const MIRRORED: f64 = 1e-10;

impl Symmetric {
    /// Creates the zero matrix of order `n` with the entries that `visit` reports in either triangle; see
    /// [`Pattern::from_entries`].
    ///
    /// # Errors
    /// As [`Pattern::from_entries`].
    pub fn from_entries(n: usize, visit: impl Fn(&mut dyn FnMut(usize, usize))) -> Result<Self, MatrixError> {
        let pattern = Pattern::from_entries(n, n, |take| {
            visit(&mut |row, column| take(row.max(column), row.min(column)));
        })?;
        Ok(Self::of_lower(Csc::zeros(Arc::new(pattern))))
    }

    /// Computes [`Symmetric::from_entries`] for entries from this crate's own matrices, which are valid.
    pub(crate) fn of(n: usize, visit: impl Fn(&mut dyn FnMut(usize, usize))) -> Self {
        Self::from_entries(n, visit).expect("entries of the crate's own matrices")
    }

    /// Creates the matrix with this lower triangle.
    ///
    /// # Errors
    /// If it is not square, or has an entry above the diagonal.
    pub fn from_lower(lower: Csc) -> Result<Self, MatrixError> {
        let (rows, columns) = (lower.pattern().rows(), lower.pattern().columns());
        if rows != columns {
            return Err(MatrixError::NotSquare { rows, columns });
        }
        let above = lower.entries().find(|(row, column, _)| row < column);
        above.map_or(Ok(()), |(row, column, _)| Err(MatrixError::AboveDiagonal { row, column }))?;
        Ok(Self::of_lower(lower))
    }

    pub(crate) fn of_lower(lower: Csc) -> Self {
        Symmetric { stored: Stored::Lower(lower) }
    }

    /// Creates the matrix from `whole`, which has both triangles, equal up to rounding, or only one of them.
    ///
    /// # Errors
    /// If it is not square, not symmetric, or if an entry is NaN or infinite.
    pub fn from_csc(whole: &Csc) -> Result<Self, MatrixError> {
        let pattern = whole.pattern();
        let (rows, columns) = (pattern.rows(), pattern.columns());
        if rows != columns {
            return Err(MatrixError::NotSquare { rows, columns });
        }
        let get = |row, column| pattern.slot(row, column).map_or(0.0, |slot| whole.values()[slot]);
        let below = whole.entries().any(|(row, column, _)| row > column);
        let above = whole.entries().any(|(row, column, _)| row < column);
        let mut entries = Vec::with_capacity(pattern.len());
        for (i, j, value) in whole.entries() {
            if !value.is_finite() {
                return Err(MatrixError::NotFinite { row: i, column: j, value });
            }
            let (row, column) = (i.max(j), i.min(j));
            if below && above && i != j {
                let (lower, upper) = (get(row, column), get(column, row));
                // NaN is refused above, or at its own place.
                let size = (get(row, row).abs() * get(column, column).abs()).sqrt().max(lower.abs());
                if (lower - upper).abs() > MIRRORED * size {
                    return Err(MatrixError::NotSymmetric { row, column, lower, upper });
                }
                if i < j {
                    continue;
                }
            }
            entries.push((row, column, value));
        }
        Ok(Self::of_lower(Csc::from_triplets(rows, columns, &entries)?))
    }

    /// Creates the matrix of order `n` with the entries `(row, column, value)`, in any order; entries at the same
    /// place are summed. They cover both triangles, which must be equal up to rounding, or only one of them.
    ///
    /// # Errors
    /// If an entry is outside the matrix, NaN or infinite, or if the triangles differ.
    pub fn from_triplets(n: usize, entries: &[(usize, usize, f64)]) -> Result<Self, MatrixError> {
        Self::from_csc(&Csc::from_triplets(n, n, entries)?)
    }

    /// Returns the order.
    pub fn order(&self) -> usize {
        match &self.stored {
            Stored::Lower(lower) => lower.pattern().columns(),
            Stored::Dense(dense) => dense.order(),
        }
    }

    /// Returns the lower triangle, including the diagonal: the stored entries, unless the matrix is dense.
    pub fn lower(&self) -> Cow<'_, Csc> {
        match &self.stored {
            Stored::Lower(lower) => Cow::Borrowed(lower),
            Stored::Dense(dense) => {
                let n = dense.order();
                let pattern = Pattern::of(n, n, |take| (0..n).for_each(|j| (j..n).for_each(|i| take(i, j))));
                let mut lower = Csc::zeros(Arc::new(pattern));
                lower.values_mut().iter_mut().zip(dense.lower_entries()).for_each(|(to, entry)| *to = entry.2);
                Cow::Owned(lower)
            }
        }
    }

    /// Returns the dense matrix, if it is one.
    pub fn dense(&self) -> Option<&DenseSymmetric> {
        match &self.stored {
            Stored::Dense(dense) => Some(dense),
            Stored::Lower(_) => None,
        }
    }

    /// Adds `value` at `(row, column)` and at `(column, row)`.
    ///
    /// # Errors
    /// If the matrix was created without the entry, or if the sum would not be finite.
    pub fn add(&mut self, row: usize, column: usize, value: f64) -> Result<(), MatrixError> {
        if !self.stores(row, column) {
            return Err(MatrixError::NotStored { row, column });
        }
        let sum = self.get(row, column) + value;
        if !sum.is_finite() {
            return Err(MatrixError::NotFinite { row, column, value: sum });
        }
        self.raise(row, column, value);
        Ok(())
    }

    /// Adds to an entry as [`Symmetric::add`] does, for entries that exist, as in this crate's own matrices.
    pub(crate) fn raise(&mut self, row: usize, column: usize, value: f64) {
        match &mut self.stored {
            Stored::Lower(lower) => {
                let slot = slot(lower, row, column).expect("an entry that was named");
                lower.values_mut()[slot] += value;
            }
            Stored::Dense(dense) => dense.raise(row, column, value),
        }
    }

    /// Returns `true` if the entry at `(row, column)` is stored, even as a zero.
    pub(crate) fn stores(&self, row: usize, column: usize) -> bool {
        match &self.stored {
            Stored::Lower(lower) => slot(lower, row, column).is_some(),
            Stored::Dense(dense) => row.max(column) < dense.order(),
        }
    }

    /// Iterates over all stored entries on and below the diagonal as `(row, column, value)`, column by column.
    pub(crate) fn lower_entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let (sparse, dense) = match &self.stored {
            Stored::Lower(lower) => (Some(lower.entries()), None),
            Stored::Dense(dense) => (None, Some(dense.lower_entries())),
        };
        sparse.into_iter().flatten().chain(dense.into_iter().flatten())
    }

    /// Iterates over all entries of both triangles as `(row, column, value)`.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.lower_entries().flat_map(|(row, column, value)| {
            let mirror = (row != column).then_some((column, row, value));
            std::iter::once((row, column, value)).chain(mirror)
        })
    }

    /// Returns the entry at `(row, column)`, or 0 if it is not stored.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        match &self.stored {
            Stored::Lower(lower) => slot(lower, row, column).map_or(0.0, |slot| lower.values()[slot]),
            Stored::Dense(dense) => dense.get(row, column),
        }
    }

    /// Returns the diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order()).map(|i| self.get(i, i)).collect()
    }

    /// Computes `A x`.
    ///
    /// # Errors
    /// If the length of `x` differs from the number of columns.
    pub fn times(&self, x: &[f64]) -> Result<Vec<f64>, MatrixError> {
        expect_length("vector", self.order(), x.len())?;
        let mut y = vec![0.0; x.len()];
        self.mul(x, &mut y);
        Ok(y)
    }

    /// Computes `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) {
        match &self.stored {
            Stored::Lower(lower) => {
                y.fill(0.0);
                accumulate(lower, x, y, |value, x| value * x);
            }
            Stored::Dense(dense) => dense.mul(x, y),
        }
    }

    /// Computes `y += |A| |x|`.
    pub(crate) fn add_sizes(&self, x: &[f64], y: &mut [f64]) {
        match &self.stored {
            Stored::Lower(lower) => accumulate(lower, x, y, |value, x| (value * x).abs()),
            Stored::Dense(dense) => dense.add_sizes(x, y),
        }
    }

    /// Multiplies all values by `factor`: the matrix in another unit.
    pub fn scale(&mut self, factor: f64) {
        match &mut self.stored {
            Stored::Lower(lower) => lower.values_mut().iter_mut().for_each(|value| *value *= factor),
            Stored::Dense(dense) => *dense = dense.scaled(factor),
        }
    }
}

/// Returns the slot of an entry of either triangle.
fn slot(lower: &Csc, row: usize, column: usize) -> Option<usize> {
    lower.pattern().slot(row.max(column), row.min(column))
}

/// Computes `y_i += Σ_j term(A_ij, x_j)`, one column of the lower triangle and its mirror image at a time.
fn accumulate(lower: &Csc, x: &[f64], y: &mut [f64], term: impl Fn(f64, f64) -> f64) {
    let (pattern, values) = (lower.pattern(), lower.values());
    for column in 0..pattern.columns() {
        let slots = pattern.column(column);
        let (factor, mut sum) = (x[column], 0.0);
        for (&row, &value) in pattern.row_indices()[slots.clone()].iter().zip(&values[slots]) {
            let row = row as usize;
            y[row] += term(value, factor);
            if row != column {
                sum += term(value, x[row]);
            }
        }
        y[column] += sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_it_is_enough() {
        // [ 2 1 0 ]
        // [ 1 3 4 ]
        // [ 0 4 5 ]
        let full = [(0, 0, 2.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 3.0), (1, 2, 4.0), (2, 1, 4.0), (2, 2, 5.0)];
        let a = Symmetric::from_triplets(3, &full).unwrap();
        assert_eq!(a.lower().pattern().len(), 5);
        assert_eq!(a.diagonal(), [2.0, 3.0, 5.0]);
        assert_eq!([a.get(1, 2), a.get(2, 1), a.get(0, 2)], [4.0, 4.0, 0.0]);
        let mut y = [0.0; 3];
        a.mul(&[1.0, -1.0, 2.0], &mut y);
        assert_eq!(y, [1.0, 6.0, 6.0]);
        let mut entries: Vec<_> = a.entries().collect();
        entries.sort_by_key(|&(i, j, _)| (i, j));
        assert_eq!(entries, full);
        let either = |part: fn(&(usize, usize, f64)) -> bool| {
            let half: Vec<_> = full.into_iter().filter(part).collect();
            Symmetric::from_triplets(3, &half).unwrap().entries().collect::<Vec<_>>()
        };
        assert_eq!(either(|(i, j, _)| i >= j), a.entries().collect::<Vec<_>>());
        assert_eq!(either(|(i, j, _)| i <= j), a.entries().collect::<Vec<_>>());
    }

    #[test]
    fn an_entry_of_either_triangle_is_one_of_both() {
        let mut a = Symmetric::from_entries(2, |take| take(0, 1)).unwrap();
        a.add(0, 1, 3.0).unwrap();
        a.add(1, 0, 1.0).unwrap();
        assert_eq!([a.get(0, 1), a.get(1, 0)], [4.0; 2]);
        assert_eq!(a.add(0, 0, 1.0), Err(MatrixError::NotStored { row: 0, column: 0 }));
    }

    #[test]
    fn a_dense_one_does_what_a_sparse_one_does() {
        let mut dense =
            Symmetric::from(DenseSymmetric::from_lower(3, vec![2.0, 1.0, 0.0, 9.0, 3.0, 4.0, 9.0, 9.0, 5.0]).unwrap());
        let full = [(0, 0, 2.0), (1, 0, 1.0), (2, 0, 0.0), (1, 1, 3.0), (2, 1, 4.0), (2, 2, 5.0)];
        let mut sparse = Symmetric::from_triplets(3, &full).unwrap();
        let same = |dense: &Symmetric, sparse: &Symmetric| {
            assert_eq!(dense.entries().collect::<Vec<_>>(), sparse.entries().collect::<Vec<_>>());
            assert_eq!(dense.lower().values(), sparse.lower().values());
            assert_eq!(dense.lower().pattern(), sparse.lower().pattern());
            assert_eq!(dense.diagonal(), sparse.diagonal());
            assert_eq!(dense.times(&[1.0, -1.0, 2.0]), sparse.times(&[1.0, -1.0, 2.0]));
            assert_eq!(dense.get(3, 0), sparse.get(3, 0));
        };
        same(&dense, &sparse);
        for a in [&mut dense, &mut sparse] {
            a.scale(0.5);
            a.add(0, 2, 7.0).unwrap();
            assert_eq!(a.add(0, 3, 1.0), Err(MatrixError::NotStored { row: 0, column: 3 }));
            assert!(matches!(a.add(0, 0, f64::NAN), Err(MatrixError::NotFinite { .. })));
        }
        same(&dense, &sparse);
    }
}
