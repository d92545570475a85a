//! The bulge of the surface that a mesh approximates, beyond its facets.
//!
//! The nodes of a mesh are on the surface; straight facets between them are chords. With the normals n of the surface
//! in the corners of a facet and the normal ν of the facet, its distance beyond the facet is
//!
//! ```text
//! b = 2 c / (1 + √(1 - 2 κ c)),   c = ½ Σ_{i<j} N_i N_j e_ij,   e_ij = (n_j - n_i) · (x_j - x_i),
//! ```
//!
//! with the curvature κ, the largest `e_ij / |x_j - x_i|²` of the facet. It is positive out of the body where it is
//! convex, `l² / 8 R` in the middle of an edge, and exact on circles and spheres with exact normals, along the normal.
//! The cosine of the
//! angle between that and ν is `n · ν / √(1 - 2 κ c)`. The normals are those of [`Surface`].

use std::collections::BTreeMap;

use super::facet::{MOST, Values};
use super::surface::Surface;
use crate::algebra::vector::{dot, minus, unit};
use crate::body::mesh::{Boundary, Mesh};

/// The ratio of the curvatures at the two ends of an edge above which the smaller one counts: the surface begins to
/// turn there, as at the end of a flat. The limiter is that of van Leer (1977).
const LIMIT: f64 = 3.0;

/// The bulges of the facets of a boundary; `None` for those without one.
pub(super) struct Bulges(Vec<Option<Bulge>>);

/// The curved surface beyond a facet.
struct Bulge {
    /// `e_ij` (m) of two corners, by their places in the facet.
    turns: Vec<([usize; 2], f64)>,
    /// κ, 1/m.
    curvature: f64,
    /// `n · ν`, the mean over the corners.
    slope: f64,
}

/// The distance of a surface beyond a facet.
pub(super) struct Beyond {
    /// Along the normal of the surface, m.
    pub distance: f64,
    /// The cosine of the angle between the normals of the surface and of the facet.
    pub cosine: f64,
}

impl Bulges {
    /// Computes the bulges of `boundary`. Facets of second order that follow the surface have none.
    pub(super) fn new(mesh: &Mesh, boundary: &Boundary) -> Self {
        let mut normals = boundary.facets.iter().map(|facet| unit(mesh.area_vector(facet)));
        let first = normals.next();
        if normals.all(|normal| Some(normal) == first) {
            return Bulges(Vec::new());
        }
        let surface = Surface::new(mesh, boundary);
        let mut known = BTreeMap::new();
        let of_facet = |(f, facet): (usize, &Vec<usize>)| {
            let corners = surface.corners(f);
            let normal = |&node: &usize| {
                let fan = surface.fan(node, f);
                let first = fan.first().copied().unwrap_or(f);
                *known.entry((node, first)).or_insert_with(|| surface.normal(node, &fan))
            };
            let normals: Vec<[f64; 3]> = corners.iter().map(normal).collect();
            let pairs = (0..corners.len()).flat_map(|i| (i + 1..corners.len()).map(move |j| [i, j]));
            let turn =
                |pair: [usize; 2]| (pair, limited(surface.turns(pair.map(|k| corners[k]), pair.map(|k| normals[k]))));
            let turns: Vec<([usize; 2], f64)> = pairs.map(turn).filter(|(_, turn)| *turn != 0.0).collect();
            let curvature = |&([i, j], turn): &([usize; 2], f64)| {
                let apart = minus(mesh.nodes[corners[j]], mesh.nodes[corners[i]]);
                turn / dot(apart, apart)
            };
            let curvature = turns.iter().map(curvature).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
            let normal = unit(mesh.area_vector(facet));
            let slope = normals.iter().map(|n| dot(*n, normal)).sum::<f64>() / normals.len() as f64;
            Some(Bulge { turns, curvature, slope })
        };
        Bulges(boundary.facets.iter().enumerate().map(of_facet).collect())
    }

    /// Returns the distance of the surface beyond the facet with the number `f` and the nodes `facet`, at the point with
    /// the shape functions `shape`.
    pub(super) fn at(&self, mesh: &Mesh, f: usize, facet: &[usize], shape: &Values) -> Beyond {
        let Some(Some(bulge)) = self.0.get(f) else { return Beyond { distance: 0.0, cosine: 1.0 } };
        let shape = on_corners(mesh, facet, shape);
        let square = bulge.turns.iter().map(|([i, j], turn)| 0.5 * shape[*i] * shape[*j] * turn).sum::<f64>();
        // 1 on a flat; on a sphere the distance of the facet from its centre, relative to the radius.
        let inside = (1.0 - 2.0 * bulge.curvature * square).max(0.0).sqrt();
        Beyond { distance: 2.0 * square / (1.0 + inside), cosine: (bulge.slope / inside).min(1.0) }
    }
}

/// Returns the linear shape functions of the corners of a facet with straight edges.
fn on_corners(mesh: &Mesh, facet: &[usize], shape: &Values) -> Values {
    if !mesh.is_quadratic(facet) {
        return *shape;
    }
    let mut linear = [0.0; MOST];
    for (k, n) in shape.iter().enumerate().take(facet.len()) {
        if k % 2 == 0 {
            linear[k / 2] += n;
        } else {
            linear[k / 2] += 0.5 * n;
            linear[(k + 1) % facet.len() / 2] += 0.5 * n;
        }
    }
    linear
}

/// Adds the parts of `e_ij` that both ends of an edge contribute. They are alike where the curvature changes gradually.
fn limited([a, b]: [f64; 2]) -> f64 {
    if a * b <= 0.0 {
        return 0.0;
    }
    let most = (1.0 + LIMIT) * a.abs().min(b.abs());
    (a + b).clamp(-most, most)
}
