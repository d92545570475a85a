//! Normals at the nodes of a boundary, and the directions along which supports hold one side or both.

use std::collections::{BTreeMap, BTreeSet};

use super::cover::Cover;
use super::facet::Kind;
use super::{MortarFault, place};
use crate::algebra::vector::{across, cross, dot, minus, norm, unit};
use crate::body::constraints::SAME_DIRECTION;
use crate::body::fem::facet_normals;
use crate::body::mesh::{Boundary, Mesh};

/// If supports leave at least this length of a unit normal, the node is on a plane of symmetry; the rest is due to
/// rounding or the mesh.
const SYMMETRIC: f64 = 0.9;

/// A direction fixed on both sides counts as normal to a plane of symmetry if the component of the unit normal along it
/// is smaller than this.
const ALONG_SYMMETRY: f64 = 0.2;

/// A node is held along its normal if supports leave less than this length of the unit normal.
const FREE: f64 = 0.1;

/// Computes the unit normals of the nodes of `boundary`: sums over its facets at the node of
///
/// ```text
/// (a × b) / (|a|² |b|²)   a and b the edges of the facet that begin at the node (Max 1999),
/// ν / |edge|              in two dimensions,
/// ν / area                on faces of second order, ν their normal in the node:
/// ```
///
/// The first two sums give the normal of the sphere or circle on which the nodes lie. On a plane of symmetry the normal
/// has no component across the plane.
pub(super) fn nodal(
    mesh: &Mesh,
    boundary: &Boundary,
    still: &BTreeMap<usize, Vec<[f64; 3]>>,
) -> Result<BTreeMap<usize, [f64; 3]>, MortarFault> {
    let normal = |(node, sum): (usize, [f64; 3])| {
        let normal = unit(sum);
        if !normal.iter().all(|c| c.is_finite()) {
            let at = place(mesh, mesh.nodes[node]);
            return Err(MortarFault::NormalsCancel { boundary: boundary.name.clone(), at });
        }
        let projected = still.get(&node).into_iter().flatten().copied().fold(normal, across);
        Ok((node, if norm(projected) > SYMMETRIC { unit(projected) } else { normal }))
    };
    sums(mesh, boundary).into_iter().map(normal).collect()
}

/// Computes the sums over the facets without regard to supports.
pub(super) fn sums(mesh: &Mesh, boundary: &Boundary) -> BTreeMap<usize, [f64; 3]> {
    let mut sums = BTreeMap::<usize, [f64; 3]>::new();
    for facet in &boundary.facets {
        for (&node, part) in facet.iter().zip(corner_normals(mesh, facet)) {
            sums.entry(node).or_default().iter_mut().zip(part).for_each(|(sum, c)| *sum += c);
        }
    }
    sums
}

fn corner_normals(mesh: &Mesh, facet: &[usize]) -> Vec<[f64; 3]> {
    match Kind::of(mesh, facet) {
        Kind::Edge | Kind::BentEdge | Kind::BentTriangle | Kind::BentQuadrilateral => {
            let normals = facet_normals(mesh, facet);
            let size = norm(mesh.area_vector(facet));
            normals.into_iter().map(|n| n.map(|c| c / (size * size))).collect()
        }
        Kind::Triangle | Kind::Quadrilateral => (0..facet.len())
            .map(|k| {
                let to = |other: usize| minus(mesh.nodes[facet[other % facet.len()]], mesh.nodes[facet[k]]);
                let (a, b) = (to(k + 1), to(k + facet.len() - 1));
                let size = dot(a, a) * dot(b, b);
                cross(a, b).map(|c| c / size)
            })
            .collect(),
    }
}

/// Returns `true` if supports hold a node along `normal`.
pub(super) fn is_held(normal: [f64; 3], held: &[[f64; 3]]) -> bool {
    norm(held.iter().copied().fold(normal, across)) < FREE
}

/// Returns the mean of the slave's normal at a node and the reversed normal `opposite` of the master in front of it, as
/// a unit vector; `None` if they cancel. Neither side is preferred. On a plane of symmetry the mean has no component
/// across the plane, along `still`, see [`still`].
pub(super) fn common(normal: [f64; 3], opposite: [f64; 3], still: &[[f64; 3]]) -> Option<[f64; 3]> {
    let mean = unit(minus(normal, unit(opposite)));
    let symmetric = |n: [f64; 3], h: &[f64; 3]| if dot(n, h).abs() < ALONG_SYMMETRY { across(n, *h) } else { n };
    let normal = unit(still.iter().fold(mean, symmetric));
    // + 0.0 turns -0 into 0.
    normal.iter().all(|c| c.is_finite()).then(|| normal.map(|c| c + 0.0))
}

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
