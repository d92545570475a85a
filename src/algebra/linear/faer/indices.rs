//! A pattern in faer's format.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

use crate::algebra::sparse::Pattern;

/// A square pattern with the unsigned indices of faer.
pub(super) struct Indices {
    pub(super) starts: Vec<usize>,
    pub(super) rows: Vec<usize>,
}

impl Indices {
    pub(super) fn new(pattern: &Pattern) -> Self {
        let unsigned = |indices: &[i64]| indices.iter().map(|&i| i as usize).collect();
        Indices { starts: unsigned(pattern.column_starts()), rows: unsigned(pattern.row_indices()) }
    }

    pub(super) fn n(&self) -> usize {
        self.starts.len() - 1
    }

    /// Returns the transposed pattern, and for each of its slots the one here.
    pub(super) fn transposed(&self) -> (Self, Vec<usize>) {
        let n = self.n();
        let mut starts = vec![0; n + 1];
        self.rows.iter().for_each(|&row| starts[row + 1] += 1);
        for row in 0..n {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let (mut rows, mut slots) = (vec![0; self.rows.len()], vec![0; self.rows.len()]);
        for column in 0..n {
            for slot in self.starts[column]..self.starts[column + 1] {
                let to = &mut next[self.rows[slot]];
                (rows[*to], slots[*to]) = (column, slot);
                *to += 1;
            }
        }
        (Indices { starts, rows }, slots)
    }

    pub(super) fn symbolic(&self) -> SymbolicSparseColMatRef<'_, usize> {
        SymbolicSparseColMatRef::new_checked(self.n(), self.n(), &self.starts, None, &self.rows)
    }

    pub(super) fn with<'a>(&'a self, values: &'a [f64]) -> SparseColMatRef<'a, usize, f64> {
        SparseColMatRef::new(self.symbolic(), values)
    }
}
