//! The factor `L` by supernodes: neighbouring columns that share their rows below the diagonal.

// Without a backend nothing is factored.
#![cfg_attr(not(any(feature = "umfpack", feature = "faer")), allow(dead_code))]

use crate::algebra::linear::FactorInfo;

/// What a backend hands over: `L` of `P K Pᵀ = L Lᵀ`, from its first column to its last.
pub(in crate::algebra::linear) trait Supernodal: Send + Sync {
    /// How many supernodes there are.
    fn len(&self) -> usize;

    /// The supernode `k`.
    fn supernode(&self, k: usize) -> Supernode<'_>;

    /// Entries, operations and peak memory; the pivots are read off `L`.
    fn info(&self) -> FactorInfo;
}

/// A supernode.
pub(in crate::algebra::linear) struct Supernode<'a> {
    /// Its first column.
    pub first: usize,
    /// How many columns it has. They are dense, and so are their rows as far as the diagonal.
    pub columns: usize,
    /// The rows below the block on the diagonal, ascending.
    pub below: &'a [i64],
    /// Column after column, the rows of the block first; above the diagonal there may be anything.
    pub values: &'a [f64],
}

impl<'a> Supernode<'a> {
    /// The entries of its column `k` from the diagonal downwards.
    pub(super) fn column(&self, k: usize) -> &'a [f64] {
        let rows = self.columns + self.below.len();
        &self.values[k * rows + k..(k + 1) * rows]
    }

    /// Their rows in `L`.
    pub(super) fn rows(&self, k: usize) -> impl Iterator<Item = usize> {
        (self.first + k..self.first + self.columns).chain(self.below.iter().map(|&row| row as usize))
    }
}
