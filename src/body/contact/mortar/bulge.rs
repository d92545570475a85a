//! The bulge of the surface that a mesh approximates, beyond its facets.
//!
//! The nodes of a mesh are on the surface; straight facets between them are chords. If the facets turn gradually, the
//! nodal normals give the distance of the surface beyond the facet,
//!
//! ```text
//! b = ½ Σ_{i<j} N_i N_j (n_j - n_i) · (x_j - x_i),
//! ```
//!
//! positive out of the body where it is convex. On a circle and a sphere, b is exact to the square of the angle that a
//! facet spans: `l² / 8 R` in the middle of an edge.

use std::collections::BTreeMap;

use super::facet::Values;
use super::normals::sums;
use crate::algebra::vector::{dot, minus, unit};
use crate::body::mesh::{Boundary, Mesh};

/// The least cosine, that of 30°, between the normals of a facet and of its node; below it the node is on an edge of
/// the body, without bulge.
const SMOOTH: f64 = 0.866;

/// The unit normals of the nodes of a boundary that is not flat.
pub(super) struct Bulges(BTreeMap<usize, [f64; 3]>);

impl Bulges {
    /// Computes the normals of `boundary`. Facets of second order follow the surface and have no bulge.
    pub(super) fn new(mesh: &Mesh, boundary: &Boundary) -> Self {
        let mut straight = boundary.facets.iter().filter(|facet| !mesh.is_quadratic(facet));
        let first = straight.next().map(|facet| unit(mesh.area_vector(facet)));
        let turns = first.is_some_and(|first| straight.any(|facet| unit(mesh.area_vector(facet)) != first));
        let normals = if turns { sums(mesh, boundary) } else { BTreeMap::new() };
        Bulges(normals.into_iter().map(|(node, sum)| (node, unit(sum))).collect())
    }

    /// Returns the distance of the surface beyond `facet` at the point with the shape functions `shape`, m.
    pub(super) fn at(&self, mesh: &Mesh, facet: &[usize], shape: &Values) -> f64 {
        if self.0.is_empty() || mesh.is_quadratic(facet) {
            return 0.0;
        }
        let own = unit(mesh.area_vector(facet));
        let normal = |node: usize| self.0.get(&node).copied().filter(|n| dot(*n, own) > SMOOTH).unwrap_or(own);
        let mut bulge = 0.0;
        for (i, &a) in facet.iter().enumerate() {
            for (j, &b) in facet.iter().enumerate().skip(i + 1) {
                let apart = minus(mesh.nodes[b], mesh.nodes[a]);
                bulge += 0.5 * shape[i] * shape[j] * dot(minus(normal(b), normal(a)), apart);
            }
        }
        bulge
    }
}
