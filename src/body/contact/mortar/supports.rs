//! The effect of supports on the relative motion of two boundaries.

use std::collections::{BTreeMap, BTreeSet};

use super::cover::Cover;
use crate::algebra::vector::{across, norm};
use crate::body::constraints::SAME_DIRECTION;
use crate::body::mesh::Boundary;

/// The supports of the nodes of two boundaries. A closure that returns the held directions of a node implements it for
/// supports that do not move.
pub trait Supports {
    /// Returns the orthonormal directions along which supports hold a node, like `fem::Dofs::held`.
    fn held(&self, node: usize) -> Vec<[f64; 3]>;

    /// Returns the directions along which a node needs no row. By default these are the held ones; along those that are `still`,
    /// neither side can move.
    fn settled(&self, node: usize, still: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let _ = still;
        self.held(node)
    }

    /// Returns `true` if supports prescribe different displacements along the unit vector `n` for two nodes that are
    /// both held along it.
    fn move_apart(&self, nodes: [usize; 2], n: [f64; 3]) -> bool {
        let _ = (nodes, n);
        false
    }
}

impl<F: Fn(usize) -> Vec<[f64; 3]>> Supports for F {
    fn held(&self, node: usize) -> Vec<[f64; 3]> {
        self(node)
    }
}

/// Returns, for each node of `slave`, the directions along which neither side can move. In such a direction, supports
/// hold the node and at least one of the master nodes in front of it, with equal displacements. An example is a plane
/// of symmetry that cuts both bodies. If supports hold only the slave node, the other side can still move past it.
pub(super) fn still(slave: &Boundary, covers: &[Cover], supports: &dyn Supports) -> BTreeMap<usize, Vec<[f64; 3]>> {
    let mut fronts = BTreeMap::<usize, BTreeSet<usize>>::new();
    for (facet, cover) in slave.facets.iter().zip(covers) {
        for (i, node) in facet.iter().enumerate().filter(|(_, node)| !supports.held(**node).is_empty()) {
            let in_front = cover.cross.iter().filter(|(_, values)| values[i] != 0.0).map(|(k, _)| *k);
            fronts.entry(*node).or_default().extend(in_front);
        }
    }
    let of_node = |(node, front): (usize, BTreeSet<usize>)| {
        let other_is_held = |n: &[f64; 3]| {
            front.iter().any(|&k| {
                norm(supports.held(k).into_iter().fold(*n, across)) < SAME_DIRECTION
                    && !supports.move_apart([node, k], *n)
            })
        };
        (node, supports.held(node).into_iter().filter(other_is_held).collect())
    };
    fronts.into_iter().map(of_node).collect()
}
