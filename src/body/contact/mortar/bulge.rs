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
//! convex, `l² / 8 R` in the middle of an edge, and exact on circles and spheres, along their normal. The cosine of the
//! angle between that and ν is `n · ν / √(1 - 2 κ c)`. The normals are those of [`Surface`].

use super::facet::Values;
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
        let of_facet = |(f, facet): (usize, &Vec<usize>)| {
            let corners = surface.corners(f);
            let normals: Vec<[f64; 3]> = corners.iter().map(|&node| surface.normal(node, f)).collect();
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
    let mut linear = [0.0; super::facet::MOST];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::vector::norm;
    use crate::body::mesh::block;
    use std::f64::consts::FRAC_PI_2;

    /// The largest relative error of the bulge at the middle of each facet of `boundary`, whose distance from the surface is known.
    fn error(mesh: &Mesh, boundary: &str, distance: impl Fn([f64; 3]) -> f64) -> f64 {
        let boundary = mesh.boundary(boundary).unwrap();
        let bulges = Bulges::new(mesh, boundary);
        let of_facet = |(f, facet): (usize, &Vec<usize>)| {
            let mut shape = [0.0; 8];
            shape[..facet.len()].fill(1.0 / facet.len() as f64);
            let points = mesh.points(facet);
            let middle = [0, 1, 2].map(|c| points.iter().map(|x| x[c]).sum::<f64>() / points.len() as f64);
            (bulges.at(mesh, f, facet, &shape).distance / distance(middle) - 1.0).abs()
        };
        boundary.facets.iter().enumerate().map(of_facet).fold(0.0, f64::max)
    }

    /// A quarter of a ring of radius 1 with `n` facets of sizes that alternate by `uneven`.
    fn ring(n: usize, uneven: f64, radii: [f64; 2]) -> Mesh {
        let mut mesh = block(&[1.0, 1.0], &[1, n]);
        for x in &mut mesh.nodes {
            let t = x[1] + uneven * (7.0 * x[1] * n as f64).sin() * (x[1] * (1.0 - x[1])).min(1.0 / n as f64);
            let (r, angle) = (radii[0] + x[0] * (radii[1] - radii[0]), FRAC_PI_2 * t);
            *x = [r * angle.cos(), r * angle.sin(), 0.0];
        }
        mesh
    }

    /// On circles, also at their ends and between facets of different sizes.
    #[test]
    fn of_circles() {
        for n in [3, 4, 8, 16] {
            for uneven in [0.0, 0.3] {
                let outer = error(&ring(n, uneven, [0.5, 1.0]), "right", |x| 1.0 - norm(x));
                let inner = error(&ring(n, uneven, [1.0, 1.5]), "left", |x| norm(x) - 1.0);
                assert!(outer < 1e-6 && inner < 1e-6, "{n} {uneven}: {outer:e} {inner:e}");
            }
        }
    }
}
