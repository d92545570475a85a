//! The positions of the entries of a matrix.

use super::{MatrixError, expect_length};

/// The positions of the stored entries of a matrix in compressed columns, sorted by row.
///
/// The indices are signed with 64 bits, because the direct solvers take these without a copy.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    rows: usize,
    column_starts: Vec<i64>,
    row_indices: Vec<i64>,
}

impl Pattern {
    /// Collects the entries that `visit` reports, in any order and with repetitions.
    ///
    /// `visit` is called twice, once for counting and once for filling, and must report the same entries
    /// `(row, column)` both times.
    ///
    /// # Errors
    /// If the matrix is too large for the memory, if an entry is outside of it, or if the second call reports other
    /// entries than the first.
    pub fn from_entries(
        rows: usize,
        columns: usize,
        visit: impl Fn(&mut dyn FnMut(usize, usize)),
    ) -> Result<Self, MatrixError> {
        let mut fault = None;
        let mut starts = Vec::new();
        // Rows are stored as the i64 of SuiteSparse; usize::MAX exceeds any memory.
        if i64::try_from(rows).is_err() || starts.try_reserve_exact(columns.saturating_add(1)).is_err() {
            return Err(MatrixError::TooLarge { rows, columns });
        }
        starts.resize(columns + 1, 0_usize);
        visit(&mut |row, column| {
            if row >= rows {
                fault.get_or_insert(MatrixError::Row { row, rows });
            } else if column >= columns {
                fault.get_or_insert(MatrixError::Column { row, column, columns });
            } else {
                starts[column + 1] += 1;
            }
        });
        for column in 0..columns {
            starts[column + 1] += starts[column];
        }
        let mut next = starts.clone();
        // This array is far larger than the columns, so that lack of memory shows here first for large meshes.
        let mut found = Vec::new();
        found.try_reserve_exact(starts[columns]).map_err(|_| MatrixError::TooLarge { rows, columns })?;
        found.resize(starts[columns], 0_i64);
        visit(&mut |row, column| {
            if fault.is_some() {
                return;
            }
            if row >= rows || column >= columns || next[column] == starts[column + 1] {
                fault = Some(MatrixError::Unsteady { column });
                return;
            }
            found[next[column]] = row as i64;
            next[column] += 1;
        });
        if let (None, Some(column)) = (&fault, (0..columns).find(|&column| next[column] != starts[column + 1])) {
            fault = Some(MatrixError::Unsteady { column });
        }
        if let Some(fault) = fault {
            return Err(fault);
        }
        // Sort each column and remove repetitions, in place.
        let mut count = 0;
        let mut column_starts = Vec::with_capacity(columns + 1);
        column_starts.push(0);
        for column in 0..columns {
            let (from, to) = (starts[column], starts[column + 1]);
            found[from..to].sort_unstable();
            let first = count;
            for k in from..to {
                if count == first || found[count - 1] != found[k] {
                    found[count] = found[k];
                    count += 1;
                }
            }
            column_starts.push(count as i64);
        }
        found.truncate(count);
        found.shrink_to_fit();
        Ok(Pattern { rows, column_starts, row_indices: found })
    }

    /// Computes [`Pattern::from_entries`] for entries from this crate's own matrices, which are valid.
    pub(crate) fn of(rows: usize, columns: usize, visit: impl Fn(&mut dyn FnMut(usize, usize))) -> Self {
        Self::from_entries(rows, columns, visit).expect("entries of the crate's own matrices")
    }

    /// Checks the starts of compressed columns and their rows. `starts` has one entry more than there are columns,
    /// and column `j` has the rows `indices[starts[j]..starts[j + 1]]`.
    pub(super) fn check_parts(rows: usize, starts: &[usize], indices: &[usize]) -> Result<(), MatrixError> {
        let columns = starts.len().checked_sub(1);
        let Some(columns) = columns.filter(|_| starts[0] == 0) else {
            return Err(MatrixError::Starts { place: 0, start: starts.first().copied().unwrap_or(0) });
        };
        if let Some(k) = (0..columns).find(|&k| starts[k + 1] < starts[k]) {
            return Err(MatrixError::Starts { place: k + 1, start: starts[k + 1] });
        }
        expect_length("row indices", starts[columns], indices.len())?;
        indices.iter().find(|&&row| row >= rows).map_or(Ok(()), |&row| Err(MatrixError::Row { row, rows }))
    }

    /// Returns the number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the number of columns.
    pub fn columns(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Returns the number of stored entries.
    pub fn len(&self) -> usize {
        self.row_indices.len()
    }

    /// Returns `true` if no entry is stored.
    pub fn is_empty(&self) -> bool {
        self.row_indices.is_empty()
    }

    /// Returns the start of each column in [`Pattern::row_indices`], one more than there are columns.
    pub fn column_starts(&self) -> &[i64] {
        &self.column_starts
    }

    /// Returns the rows of the stored entries, column by column, ascending within a column.
    pub fn row_indices(&self) -> &[i64] {
        &self.row_indices
    }

    /// Returns the range of storage slots of `column`, which must be below [`Pattern::columns`].
    pub(crate) fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.column_starts[column] as usize..self.column_starts[column + 1] as usize
    }

    /// Returns the storage slot of the entry `(row, column)`, if it is stored.
    pub fn slot(&self, row: usize, column: usize) -> Option<usize> {
        if column >= self.columns() {
            return None;
        }
        let range = self.column(column);
        let start = range.start;
        self.row_indices[range].binary_search(&(row as i64)).ok().map(|k| start + k)
    }
}
