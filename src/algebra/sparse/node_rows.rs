//! A matrix of finite elements by its nodes, so that each of several processes can make rows of its own.

use super::Symmetric;

/// What can make the rows of a symmetric matrix at any nodes of a mesh, and leaves out all others.
pub trait NodeRows {
    /// 2 or 3: as many rows a node has at most.
    fn dimension(&self) -> usize;

    /// How many nodes there are.
    fn nodes(&self) -> usize;

    /// How many rows there are.
    fn order(&self) -> usize;

    /// The rows of `node`, by their direction.
    fn places(&self, node: usize) -> [Option<usize>; 3];

    /// Names the nodes of each cell: rows of nodes that are in no cell together have no entries for each other.
    fn each_cell(&self, take: &mut dyn FnMut(&[usize]));

    /// A number that two of these have in common only if they stand for the same matrix.
    fn fingerprint(&self) -> u64;

    /// The matrix without the entries of which neither row nor column is at `nodes`; none where it cannot be made.
    fn rows(&self, nodes: &[bool]) -> Option<Symmetric>;
}
