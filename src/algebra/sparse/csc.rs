//! Matrices in compressed columns.

use std::sync::Arc;

use super::{MatrixError, Pattern, expect_length};

/// A matrix in compressed columns: values on a shared [`Pattern`].
#[derive(Debug, Clone, PartialEq)]
pub struct Csc {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
}

impl Csc {
    /// Creates the matrix with these `values`, one for each slot of the pattern; explicit zeros are entries.
    ///
    /// # Errors
    /// If the number of values is different.
    pub fn new(pattern: Arc<Pattern>, values: Vec<f64>) -> Result<Self, MatrixError> {
        expect_length("values of the matrix", pattern.len(), values.len())?;
        Ok(Csc { pattern, values })
    }

    /// Creates the zero matrix on `pattern`.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.len()];
        Csc { pattern, values }
    }

    /// Creates the matrix with the entries `(row, column, value)`, in any order; entries at the same place are
    /// summed.
    ///
    /// # Errors
    /// If an entry is outside the matrix, NaN or infinite.
    pub fn from_triplets(rows: usize, columns: usize, entries: &[(usize, usize, f64)]) -> Result<Self, MatrixError> {
        if let Some(&(row, column, value)) = entries.iter().find(|(_, _, value)| !value.is_finite()) {
            return Err(MatrixError::NotFinite { row, column, value });
        }
        let pattern = Pattern::from_entries(rows, columns, |take| entries.iter().for_each(|&(i, j, _)| take(i, j)))?;
        let mut matrix = Csc::zeros(Arc::new(pattern));
        for &(row, column, value) in entries {
            let slot = matrix.pattern.slot(row, column).ok_or(MatrixError::NotStored { row, column })?;
            let sum = &mut matrix.values[slot];
            *sum += value;
            if !sum.is_finite() {
                return Err(MatrixError::NotFinite { row, column, value: *sum });
            }
        }
        Ok(matrix)
    }

    /// Creates the matrix with `rows` rows whose column `j` has `values[starts[j]..starts[j + 1]]` in the rows at the
    /// same places of `indices`, as in SciPy's `csc_array`. They may be in any order; entries at the same place are
    /// summed.
    ///
    /// # Errors
    /// If the arrays do not fit each other, or a value is NaN or infinite.
    pub fn from_parts(rows: usize, starts: &[usize], indices: &[usize], values: &[f64]) -> Result<Self, MatrixError> {
        Pattern::check_parts(rows, starts, indices)?;
        expect_length("values of the matrix", indices.len(), values.len())?;
        let column = |j: usize| (starts[j]..starts[j + 1]).map(move |k| (indices[k], j, values[k]));
        let columns = starts.len() - 1;
        Self::from_triplets(rows, columns, &(0..columns).flat_map(column).collect::<Vec<_>>())
    }

    /// Returns the pattern of the entries.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Returns the entries, one for each slot of the pattern.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Returns the entries for changing them.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Returns the pattern, and the entries for changing them.
    pub(crate) fn parts_mut(&mut self) -> (&Pattern, &mut [f64]) {
        (&self.pattern, &mut self.values)
    }

    /// Iterates over all stored entries as `(row, column, value)`, column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.pattern.columns()).flat_map(move |column| {
            self.pattern.column(column).map(move |k| (self.pattern.row_indices()[k] as usize, column, self.values[k]))
        })
    }

    /// Computes `A x`.
    ///
    /// # Errors
    /// If the length of `x` differs from the number of columns.
    pub fn times(&self, x: &[f64]) -> Result<Vec<f64>, MatrixError> {
        expect_length("vector", self.pattern.columns(), x.len())?;
        let mut y = vec![0.0; self.pattern.rows()];
        self.add_product(x, &mut y);
        Ok(y)
    }

    /// Computes `y += A x`.
    pub(crate) fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (column, &factor) in x.iter().enumerate() {
            let range = self.pattern.column(column);
            for (&row, &value) in self.pattern.row_indices()[range.clone()].iter().zip(&self.values[range]) {
                y[row as usize] += value * factor;
            }
        }
    }

    /// Computes `r -= A x` and `s += |A| |x|`.
    pub(crate) fn subtract_product(&self, x: &[f64], r: &mut [f64], s: &mut [f64]) {
        for (column, &factor) in x.iter().enumerate() {
            let range = self.pattern.column(column);
            for (&row, &value) in self.pattern.row_indices()[range.clone()].iter().zip(&self.values[range]) {
                let term = value * factor;
                r[row as usize] -= term;
                s[row as usize] += term.abs();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Csc {
        // [ 1 0 2 ]
        // [ 3 4 0 ]
        Csc::from_triplets(2, 3, &[(1, 0, 3.0), (0, 0, 0.5), (1, 1, 4.0), (0, 2, 2.0), (0, 0, 0.5)]).unwrap()
    }

    #[test]
    fn repeated_entries_are_stored_once_and_sorted() {
        let a = example();
        assert_eq!(a.pattern.column_starts(), [0, 2, 3, 4]);
        assert_eq!(a.pattern.row_indices(), [0, 1, 1, 0]);
        assert_eq!(a.values, [1.0, 3.0, 4.0, 2.0]);
        assert_eq!(a.pattern.slot(1, 1), Some(2));
        assert_eq!(a.pattern.slot(1, 2), None);
        assert_eq!(a.pattern.slot(0, 9), None);
        let same = Csc::from_parts(2, &[0, 3, 4, 5], &[1, 0, 0, 1, 0], &[3.0, 0.5, 0.5, 4.0, 2.0]).unwrap();
        assert_eq!((&same.pattern, &same.values), (&a.pattern, &a.values));
    }

    #[test]
    fn sums_that_overflow_are_refused() {
        let error = Csc::from_triplets(1, 1, &[(0, 0, 1e308), (0, 0, 1e308)]).unwrap_err();
        assert_eq!(error.to_string(), "the entry (0, 0) is inf, but must be finite");
    }

    #[test]
    fn products() {
        let a = example();
        let (mut r, mut s) = ([1.0; 2], [1.0; 2]);
        assert_eq!(a.times(&[1.0, -1.0, 2.0]).unwrap(), [5.0, -1.0]);
        a.subtract_product(&[1.0, -1.0, 2.0], &mut r, &mut s);
        assert_eq!(r, [-4.0, 2.0]);
        assert_eq!(s, [6.0, 8.0]);
    }
}
