//! The factor `L` by supernodes: neighbouring columns that share their rows below the diagonal.

// Without a backend nothing is factored.
#![cfg_attr(not(any(feature = "umfpack", feature = "faer")), allow(dead_code))]

use crate::algebra::linear::FactorInfo;

/// The interface of a backend's factors: `L` of `P K Pᵀ = L Lᵀ`, from its first column to its last.
pub(in crate::algebra::linear) trait Supernodal: Send + Sync {
    /// Returns the number of supernodes.
    fn len(&self) -> usize;

    /// Returns the supernode `k`.
    fn supernode(&self, k: usize) -> Supernode<'_>;

    /// Returns entries, operations and peak memory; the pivots are read from `L`.
    fn info(&self) -> FactorInfo;
}

/// A supernode: a dense block of columns.
pub(in crate::algebra::linear) struct Supernode<'a> {
    /// The first column.
    pub first: usize,
    /// The number of columns. They are dense, and so are their rows down to the diagonal block.
    pub columns: usize,
    /// The rows below the block on the diagonal, ascending.
    pub below: &'a [i64],
    /// The values, column by column, the rows of the block first; those above the diagonal are unspecified.
    pub values: &'a [f64],
}

impl<'a> Supernode<'a> {
    /// Returns the entries of column `k` from the diagonal downwards.
    pub(super) fn column(&self, k: usize) -> &'a [f64] {
        let rows = self.columns + self.below.len();
        &self.values[k * rows + k..(k + 1) * rows]
    }

    /// Returns their rows in `L`.
    pub(super) fn rows(&self, k: usize) -> impl Iterator<Item = usize> {
        (self.first + k..self.first + self.columns).chain(self.below.iter().map(|&row| row as usize))
    }
}
