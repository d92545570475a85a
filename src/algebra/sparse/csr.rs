//! Matrices in compressed rows.

use super::{DoubleDouble, MatrixError, expect_length};

/// A matrix in compressed rows, for maps with few entries per row.
#[derive(Debug, Clone, PartialEq)]
pub struct Csr {
    columns: usize,
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl Csr {
    /// Creates the matrix with these rows of `(column, value)` pairs. Zeros are omitted, and pairs with the same
    /// column are summed.
    ///
    /// # Errors
    /// If an entry is outside the matrix, NaN or infinite.
    pub fn from_rows<R>(columns: usize, rows: impl IntoIterator<Item = R>) -> Result<Self, MatrixError>
    where
        R: IntoIterator<Item = (usize, f64)>,
    {
        let mut matrix = Csr { columns, starts: vec![0], entries: Vec::new() };
        for (row, entries) in rows.into_iter().enumerate() {
            let first = matrix.entries.len();
            for (column, value) in entries {
                if column >= columns {
                    return Err(MatrixError::Column { row, column, columns });
                }
                if !value.is_finite() {
                    return Err(MatrixError::NotFinite { row, column, value });
                }
                match matrix.entries[first..].iter_mut().find(|entry| entry.0 == column) {
                    Some((_, sum)) => {
                        *sum += value;
                        if !sum.is_finite() {
                            return Err(MatrixError::NotFinite { row, column, value: *sum });
                        }
                    }
                    None if value != 0.0 => matrix.entries.push((column, value)),
                    None => {}
                }
            }
            matrix.starts.push(matrix.entries.len());
        }
        Ok(matrix)
    }

    /// Computes [`Csr::from_rows`] for rows from this crate's own matrices, which are valid.
    pub(crate) fn of_rows<R>(columns: usize, rows: impl IntoIterator<Item = R>) -> Self
    where
        R: IntoIterator<Item = (usize, f64)>,
    {
        Self::from_rows(columns, rows).expect("rows of the crate's own matrices")
    }

    /// Creates the matrix with these rows, each with distinct columns, as fast as they are read, even if they are
    /// dense. Zeros are kept.
    ///
    /// # Errors
    /// [`MatrixError::Column`] if a column is not below `columns`.
    pub fn from_distinct_rows(columns: usize, rows: Vec<Vec<(usize, f64)>>) -> Result<Self, MatrixError> {
        let mut matrix = Csr { columns, starts: vec![0], entries: Vec::with_capacity(rows.iter().map(Vec::len).sum()) };
        for (row, entries) in rows.into_iter().enumerate() {
            if let Some(&(column, _)) = entries.iter().find(|(column, _)| *column >= columns) {
                return Err(MatrixError::Column { row, column, columns });
            }
            matrix.entries.extend(entries);
            matrix.starts.push(matrix.entries.len());
        }
        Ok(matrix)
    }

    /// Creates the matrix with this number of rows, all of them empty.
    ///
    /// # Errors
    /// [`MatrixError::TooLarge`] if there is not enough memory for the rows.
    pub fn empty(rows: usize, columns: usize) -> Result<Self, MatrixError> {
        let mut starts = Vec::new();
        let count = rows.checked_add(1).filter(|count| starts.try_reserve_exact(*count).is_ok());
        starts.resize(count.ok_or(MatrixError::TooLarge { rows, columns })?, 0);
        Ok(Csr { columns, starts, entries: Vec::new() })
    }

    /// Returns the matrix of this size with empty rows.
    pub(crate) fn emptied(&self) -> Self {
        Csr { columns: self.columns, starts: vec![0; self.starts.len()], entries: Vec::new() }
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Returns row `i` as `(column, value)` pairs; empty beyond the last row.
    pub fn row(&self, i: usize) -> &[(usize, f64)] {
        self.starts.get(i + 1).map_or(&[], |&end| &self.entries[self.starts[i]..end])
    }

    /// Computes `A x`.
    ///
    /// # Errors
    /// If the length of `x` differs from the number of columns.
    pub fn times(&self, x: &[f64]) -> Result<Vec<f64>, MatrixError> {
        expect_length("vector", self.columns, x.len())?;
        Ok(self.mul(x))
    }

    /// Returns the product of row `i` with `x`.
    pub(crate) fn dot(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).iter().map(|&(column, value)| value * x[column]).sum()
    }

    /// Returns the product of row `i` with `x + x_lo`, minus `y`, in twice the working precision; `x_lo` may be
    /// empty.
    pub(crate) fn difference(&self, i: usize, x: &[f64], x_lo: &[f64], y: f64) -> f64 {
        let mut sum = DoubleDouble::default();
        for &(column, value) in self.row(i) {
            sum.add_product(value, x[column]);
            sum.add(value * x_lo.get(column).copied().unwrap_or(0.0));
        }
        sum.add(-y);
        sum.value()
    }

    /// Computes `A x`.
    pub(crate) fn mul(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|i| self.dot(i, x)).collect()
    }

    /// Computes `y += A^T x`.
    pub(crate) fn add_transposed(&self, x: &[f64], y: &mut [f64]) {
        for (i, &factor) in x.iter().enumerate() {
            for &(column, value) in self.row(i) {
                y[column] += value * factor;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_their_transposed() {
        let c = Csr::from_rows(3, [vec![(0, 2.0), (1, 0.0)], vec![(2, -1.0), (0, 0.25), (0, 0.75)]]).unwrap();
        assert_eq!(c.row(0), [(0, 2.0)]);
        assert_eq!(c.row(2), []);
        assert_eq!(c.times(&[1.0, 5.0, 3.0]).unwrap(), [2.0, -2.0]);
        let mut y = [0.0; 3];
        c.add_transposed(&[1.0, 10.0], &mut y);
        assert_eq!(y, [12.0, 0.0, -10.0]);
    }
}
