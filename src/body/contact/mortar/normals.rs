//! Normals of the nodes of a boundary, and what supports leave of them.

use std::collections::BTreeMap;

use super::error::{MortarFault, place};
use super::facet::Kind;
use crate::algebra::vector::{across, cross, dot, minus, norm, unit};
use crate::body::fem::facet_normals;
use crate::body::mesh::{Boundary, Mesh};

/// A unit normal that supports leave as much of is that of a node on a plane of symmetry, and rounding or the mesh.
const SYMMETRIC: f64 = 0.9;

/// A component of a unit normal along a direction in which neither side moves is as small as this on a plane of symmetry.
const ALONG_SYMMETRY: f64 = 0.2;

/// A unit normal that supports leave no more of is held.
const FREE: f64 = 0.1;

/// The unit normals of the nodes of `boundary`: sums over its facets at the node of
///
/// ```text
/// (a × b) / (|a|² |b|²)   a and b the edges of the facet that begin at the node (Max 1999),
/// ν / |edge|              in two dimensions,
/// ν / area                on triangles of six nodes, ν their normal in the node:
/// ```
///
/// what the first two give is the normal of the sphere or circle on which nodes lie. On a plane of symmetry it has no part across
/// that.
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
        let left = still.get(&node).into_iter().flatten().copied().fold(normal, across);
        Ok((node, if norm(left) > SYMMETRIC { unit(left) } else { normal }))
    };
    sums(mesh, boundary).into_iter().map(normal).collect()
}

/// The sums over facets alone.
pub(super) fn sums(mesh: &Mesh, boundary: &Boundary) -> BTreeMap<usize, [f64; 3]> {
    let mut sums = BTreeMap::<usize, [f64; 3]>::new();
    for facet in &boundary.facets {
        for (&node, part) in facet.iter().zip(parts(mesh, facet)) {
            sums.entry(node).or_default().iter_mut().zip(part).for_each(|(sum, c)| *sum += c);
        }
    }
    sums
}

fn parts(mesh: &Mesh, facet: &[usize]) -> Vec<[f64; 3]> {
    match Kind::of(mesh, facet) {
        Kind::Edge | Kind::BentEdge | Kind::BentTriangle => {
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

/// Whether supports hold a node along `normal`.
pub(super) fn is_held(normal: [f64; 3], held: &[[f64; 3]]) -> bool {
    norm(held.iter().copied().fold(normal, across)) < FREE
}

/// The mean of the normal of the slave in a node and the opposite of the master's in front of it, `opposite`, as a unit vector; `None`
/// where they cancel. Neither side is preferred. On a plane of symmetry it has no part across that: `still`, as of [`super::supports::still`].
pub(super) fn common(normal: [f64; 3], opposite: [f64; 3], still: &[[f64; 3]]) -> Option<[f64; 3]> {
    let mean = unit(minus(normal, unit(opposite)));
    let symmetric = |n: [f64; 3], h: &[f64; 3]| if dot(n, h).abs() < ALONG_SYMMETRY { across(n, *h) } else { n };
    let normal = unit(still.iter().fold(mean, symmetric));
    // + 0.0 turns -0 into 0.
    normal.iter().all(|c| c.is_finite()).then(|| normal.map(|c| c + 0.0))
}
