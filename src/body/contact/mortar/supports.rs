//! What supports leave of the motion of two boundaries past each other.

use std::collections::{BTreeMap, BTreeSet};

use super::cover::Cover;
use crate::algebra::vector::{across, norm};
use crate::body::fem::SAME_DIRECTION;
use crate::body::mesh::Boundary;

/// What supports do to the nodes of two boundaries. A closure that gives the held directions of a node is one whose supports do not move.
pub trait Supports {
    /// Orthonormal directions along which supports hold a node, as of `fem::Dofs::held`.
    fn held(&self, node: usize) -> Vec<[f64; 3]>;

    /// Whether supports move two nodes, both held along the unit vector `n`, by different displacements along it.
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

/// The directions along which neither side can move at each node of `slave`: supports hold the node and at least one of the nodes of the
/// other side in front of it, and do not move the two apart. A plane of symmetry that cuts both bodies is such a support. Where supports
/// hold the node alone, the other side still moves past it.
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
