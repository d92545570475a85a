//! A finite element matrix by its nodes, so that each of several processes can assemble rows of its own.

use super::Symmetric;

/// A source of the rows of a symmetric matrix at any selection of mesh nodes.
pub trait NodeRows {
    /// Returns the dimension, 2 or 3, which is the largest number of rows of a node.
    fn dimension(&self) -> usize;

    /// Returns the number of nodes.
    fn nodes(&self) -> usize;

    /// Returns the number of rows.
    fn order(&self) -> usize;

    /// Returns the rows of `node`, by their direction.
    fn places(&self, node: usize) -> [Option<usize>; 3];

    /// Calls `take` with the nodes of each cell. Rows of nodes without a common cell have no entries for each other.
    fn each_cell(&self, take: &mut dyn FnMut(&[usize]));

    /// Returns a number that is equal for two sources only if their matrices are equal.
    fn fingerprint(&self) -> u64;

    /// Assembles all entries whose row or column is at `nodes`, or returns `None` if that is not possible.
    fn rows(&self, nodes: &[bool]) -> Option<Symmetric>;
}
