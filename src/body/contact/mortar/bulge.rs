//! By how much the surface that a mesh stands for bulges out of its facets.
//!
//! Nodes of a mesh are on the surface, and straight facets between them are its chords. Where facets turn little by little, the normals of
//! the nodes tell how far the surface is beyond the facet,
//!
//! ```text
//! b = ½ Σ_{i<j} N_i N_j (n_j - n_i) · (x_j - x_i),
//! ```
//!
//! out of the body where that is convex. On a circle and a sphere that is exact to the square of the angle that a facet spans: `l² / 8 R` in
//! the middle of an edge.

use std::collections::BTreeMap;

use super::facet::Values;
use super::normals::sums;
use crate::algebra::vector::{dot, minus, unit};
use crate::body::mesh::{Boundary, Mesh};

/// Where the normal of a facet and that of its node have a smaller cosine, by 30°, there is an edge of the body and no bulge.
const SMOOTH: f64 = 0.866;

/// The unit normals of the nodes of a boundary that is not flat.
pub(super) struct Bulges(BTreeMap<usize, [f64; 3]>);

impl Bulges {
    /// Those of `boundary`. Facets of the second order follow the surface themselves and have none.
    pub(super) fn new(mesh: &Mesh, boundary: &Boundary) -> Self {
        let mut straight = boundary.facets.iter().filter(|facet| !mesh.is_quadratic(facet));
        let first = straight.next().map(|facet| unit(mesh.area_vector(facet)));
        let turns = first.is_some_and(|first| straight.any(|facet| unit(mesh.area_vector(facet)) != first));
        let normals = if turns { sums(mesh, boundary) } else { BTreeMap::new() };
        Bulges(normals.into_iter().map(|(node, sum)| (node, unit(sum))).collect())
    }

    /// How far the surface is beyond `facet` at the point with these shape functions, m.
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
