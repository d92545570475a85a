//! Sparse matrices: an immutable [`Pattern`] that many value arrays share, compressed columns
//! ([`Csc`]) for what is factored, half of them ([`Symmetric`]) for the stiffness, compressed rows ([`Csr`]) for the short rows of the contact maps.

mod symmetric;
mod twofold;

use std::sync::Arc;

pub use symmetric::Symmetric;
pub use twofold::{Twofold, sum};

/// The positions of the stored entries of a matrix in compressed columns, sorted by row.
///
/// 64-bit signed indices, because that is what the direct solvers take without a copy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    rows: usize,
    column_starts: Vec<i64>,
    row_indices: Vec<i64>,
}

impl Pattern {
    /// Collects the entries that `visit` names, in any order and with repetitions.
    ///
    /// `visit` is called twice, once to count and once to fill, and must name the same entries
    /// `(row, column)` both times.
    pub fn from_entries(rows: usize, columns: usize, visit: impl Fn(&mut dyn FnMut(usize, usize))) -> Self {
        let mut starts = vec![0_usize; columns + 1];
        visit(&mut |_, column| starts[column + 1] += 1);
        for column in 0..columns {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        let mut found = vec![0_i64; starts[columns]];
        visit(&mut |row, column| {
            found[next[column]] = row as i64;
            next[column] += 1;
        });
        // Sort each column and close the gaps that repetitions leave, in place.
        let mut kept = 0;
        let mut column_starts = Vec::with_capacity(columns + 1);
        column_starts.push(0);
        for column in 0..columns {
            let (from, to) = (starts[column], starts[column + 1]);
            found[from..to].sort_unstable();
            let first = kept;
            for k in from..to {
                if kept == first || found[kept - 1] != found[k] {
                    found[kept] = found[k];
                    kept += 1;
                }
            }
            column_starts.push(kept as i64);
        }
        found.truncate(kept);
        found.shrink_to_fit();
        Pattern { rows, column_starts, row_indices: found }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.row_indices.len()
    }

    /// Whether no entry is stored.
    pub fn is_empty(&self) -> bool {
        self.row_indices.is_empty()
    }

    /// Where each column starts in [`Pattern::row_indices`]; one more than there are columns.
    pub fn column_starts(&self) -> &[i64] {
        &self.column_starts
    }

    /// The rows of the stored entries, column after column, ascending within a column.
    pub fn row_indices(&self) -> &[i64] {
        &self.row_indices
    }

    /// The range of storage slots of `column`.
    pub fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.column_starts[column] as usize..self.column_starts[column + 1] as usize
    }

    /// The storage slot of the entry `(row, column)`, if it is stored.
    pub fn slot(&self, row: usize, column: usize) -> Option<usize> {
        let range = self.column(column);
        let start = range.start;
        self.row_indices[range].binary_search(&(row as i64)).ok().map(|k| start + k)
    }
}

/// A matrix in compressed columns: values on a shared [`Pattern`].
#[derive(Debug, Clone)]
pub struct Csc {
    /// Where the entries stand.
    pub pattern: Arc<Pattern>,
    /// The entries, one for each slot of the pattern; explicit zeros are entries.
    pub values: Vec<f64>,
}

impl Csc {
    /// The zero matrix on `pattern`.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![0.0; pattern.len()];
        Csc { pattern, values }
    }

    /// All stored entries as `(row, column, value)`, column after column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.pattern.columns()).flat_map(move |column| {
            self.pattern.column(column).map(move |k| (self.pattern.row_indices[k] as usize, column, self.values[k]))
        })
    }

    /// `y = A x`.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for (column, &factor) in x.iter().enumerate() {
            let range = self.pattern.column(column);
            for (&row, &value) in self.pattern.row_indices[range.clone()].iter().zip(&self.values[range]) {
                y[row as usize] += value * factor;
            }
        }
    }

    /// `r = b - A x` and `s = |A| |x| + |b|`, what a residual is to be judged against.
    pub fn residual(&self, x: &[f64], b: &[f64], r: &mut [f64], s: &mut [f64]) {
        for (i, &value) in b.iter().enumerate() {
            r[i] = value;
            s[i] = value.abs();
        }
        for (column, &factor) in x.iter().enumerate() {
            let range = self.pattern.column(column);
            for (&row, &value) in self.pattern.row_indices[range.clone()].iter().zip(&self.values[range]) {
                let term = value * factor;
                r[row as usize] -= term;
                s[row as usize] += term.abs();
            }
        }
    }
}

/// A matrix in compressed rows, for maps whose rows hold a handful of entries.
#[derive(Debug, Clone, PartialEq)]
pub struct Csr {
    columns: usize,
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl Csr {
    /// An empty matrix with `columns` columns, to which rows are appended.
    pub fn new(columns: usize) -> Self {
        Csr { columns, starts: vec![0], entries: Vec::new() }
    }

    /// Appends a row; zero coefficients are left out.
    pub fn push_row(&mut self, row: impl IntoIterator<Item = (usize, f64)>) {
        self.entries.extend(row.into_iter().filter(|&(_, value)| value != 0.0));
        self.starts.push(self.entries.len());
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Row `i` as `(column, value)` pairs.
    pub fn row(&self, i: usize) -> &[(usize, f64)] {
        &self.entries[self.starts[i]..self.starts[i + 1]]
    }

    /// The product of row `i` with `x`.
    pub fn dot(&self, i: usize, x: &[f64]) -> f64 {
        self.row(i).iter().map(|&(column, value)| value * x[column]).sum()
    }

    /// The product of row `i` with `x + rest`, less `y`, in twice the working precision; `rest` may be empty.
    pub fn difference(&self, i: usize, x: &[f64], rest: &[f64], y: f64) -> f64 {
        let mut sum = Twofold::default();
        for &(column, value) in self.row(i) {
            sum.add_product(value, x[column]);
            sum.add(value * rest.get(column).copied().unwrap_or(0.0));
        }
        sum.add(-y);
        sum.value()
    }

    /// `A x`.
    pub fn mul(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|i| self.dot(i, x)).collect()
    }

    /// `y += A^T x`.
    pub fn add_transposed(&self, x: &[f64], y: &mut [f64]) {
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

    fn example() -> Csc {
        // [ 1 0 2 ]
        // [ 3 4 0 ]
        let entries = [(1, 0), (0, 0), (1, 1), (0, 2), (0, 0)];
        let pattern = Pattern::from_entries(2, 3, |take| entries.iter().for_each(|&(i, j)| take(i, j)));
        Csc { pattern: Arc::new(pattern), values: vec![1.0, 3.0, 4.0, 2.0] }
    }

    #[test]
    fn repeated_entries_are_stored_once_and_sorted() {
        let a = example();
        assert_eq!(a.pattern.column_starts(), [0, 2, 3, 4]);
        assert_eq!(a.pattern.row_indices(), [0, 1, 1, 0]);
        assert_eq!(a.pattern.slot(1, 1), Some(2));
        assert_eq!(a.pattern.slot(1, 2), None);
    }

    #[test]
    fn products() {
        let a = example();
        let (mut y, mut r, mut s) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        a.mul(&[1.0, -1.0, 2.0], &mut y);
        assert_eq!(y, [5.0, -1.0]);
        a.residual(&[1.0, -1.0, 2.0], &[1.0, 1.0], &mut r, &mut s);
        assert_eq!(r, [-4.0, 2.0]);
        assert_eq!(s, [6.0, 8.0]);
    }

    #[test]
    fn rows_and_their_transposed() {
        let mut c = Csr::new(3);
        c.push_row([(0, 2.0), (1, 0.0)]);
        c.push_row([(2, -1.0), (0, 1.0)]);
        assert_eq!(c.row(0), [(0, 2.0)]);
        assert_eq!(c.mul(&[1.0, 5.0, 3.0]), [2.0, -2.0]);
        let mut y = [0.0; 3];
        c.add_transposed(&[1.0, 10.0], &mut y);
        assert_eq!(y, [12.0, 0.0, -10.0]);
    }
}
