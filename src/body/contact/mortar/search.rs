//! Search for the master facets in front of a slave facet, and the distance between two boundaries.

use super::error::{MortarFault, place};
use crate::algebra::vector::{cross, dot, minus, unit};
use crate::body::contact::tree::{Bounds, Tree};
use crate::body::contact::triangles::nearest_of;
use crate::body::mesh::{Boundary, Mesh};

/// Two facets face each other if the cosine of the angle between their normals is below minus this.
const FACING: f64 = 0.1;

/// The default search distance, as a share of the size of the smaller boundary.
const SHARE_OF_SIZE: f64 = 0.1;

/// The facets of the master, in a tree.
pub(super) struct Masters {
    bounds: Vec<Bounds>,
    normals: Vec<[f64; 3]>,
    tree: Tree,
}

impl Masters {
    pub(super) fn new(mesh: &Mesh, master: &Boundary) -> Self {
        let bounds: Vec<Bounds> = master.facets.iter().map(|facet| Bounds::of(&mesh.points(facet))).collect();
        let normals = master.facets.iter().map(|facet| unit(mesh.area_vector(facet))).collect();
        Masters { tree: Tree::new(&bounds), bounds, normals }
    }

    /// Returns the facets within `search` (m) of a slave facet with nodes at `points` that face its `normal`, in
    /// ascending order.
    pub(super) fn facing(&self, points: &[[f64; 3]], normal: [f64; 3], search: f64) -> Vec<usize> {
        let around = Bounds::of(points).grown(search);
        let mut facing = Vec::new();
        self.tree.around(&around, |k| {
            if self.bounds[k].overlaps(&around) && dot(self.normals[k], normal) < -FACING {
                facing.push(k);
            }
        });
        facing.sort_unstable();
        facing
    }
}

/// Returns a tenth of the longest side of the bounding box of the smaller boundary, m.
pub(super) fn default_search(mesh: &Mesh, sides: [&Boundary; 2]) -> f64 {
    let size = |side: &Boundary| Bounds::of(&mesh.points(&side.facets.concat())).extent();
    SHARE_OF_SIZE * size(sides[0]).min(size(sides[1]))
}

/// Fails if a quadrilateral is not convex.
pub(super) fn convex(mesh: &Mesh, boundary: &Boundary) -> Result<(), MortarFault> {
    for facet in boundary.facets.iter().filter(|facet| mesh.dimension == 3 && matches!(facet.len(), 4 | 8)) {
        let corners: Vec<usize> = facet.iter().step_by(facet.len() / 4).copied().collect();
        let (normal, points) = (mesh.area_vector(facet), mesh.points(&corners));
        let turns = |k: usize| {
            let to = |other: usize| minus(points[other % 4], points[k]);
            dot(cross(to(k + 1), to(k + 3)), normal) > 0.0
        };
        if !(0..4).all(turns) {
            let centre = [0, 1, 2].map(|c| points.iter().map(|x| 0.25 * x[c]).sum());
            return Err(MortarFault::NotConvex { boundary: boundary.name.clone(), at: place(mesh, centre) });
        }
    }
    Ok(())
}

/// Returns the least distance (m) from a node of either boundary to the other boundary, and the position of that node.
pub(super) fn least_distance(mesh: &Mesh, sides: [&Boundary; 2]) -> (f64, [f64; 3]) {
    let mut least = (f64::INFINITY, [0.0; 3]);
    for [from, to] in [sides, [sides[1], sides[0]]] {
        let fan = |facet: &Vec<usize>| {
            let x = mesh.points(facet);
            let corners = move |k: usize| [x[0], x[k], x[(k + 1).min(x.len() - 1)]];
            (1..facet.len().max(3) - 1).map(corners).collect::<Vec<_>>()
        };
        let triangles: Vec<[[f64; 3]; 3]> = to.facets.iter().flat_map(fan).collect();
        let tree = Tree::new(&triangles.iter().map(|corners| Bounds::of(corners)).collect::<Vec<_>>());
        for node in from.nodes() {
            let x = mesh.nodes[node];
            tree.near(x, |k| {
                let away = minus(nearest_of(&triangles[k], x).0, x);
                let distance = dot(away, away);
                if distance.sqrt() < least.0 {
                    least = (distance.sqrt(), x);
                }
                distance
            });
        }
    }
    least
}
