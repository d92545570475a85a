//! Boundaries and the directions that they face.

use std::collections::BTreeMap;

use crate::algebra::vector::{dot, unit};
use crate::body::mesh::{Boundary, Mesh};

/// The least cosine of the angle, 44°, between facets of one smooth surface; beyond it is an edge of the body.
pub(super) const SMOOTH: f64 = 0.7193;

/// Facets are in one plane if the cosine of the angle between them is larger: 1e-5.
const FLAT: f64 = 1.0 - 5e-11;

/// The sine of the largest angle at which facets at the end of a round surface may lean away from the normal there: in refined
/// meshes of half ellipses and half balls, whose surface ends along the normal, it is up to 0.054.
const LEAN: f64 = 0.1;

/// Finds the first node of `boundary` at which a `normal` does not point out of the body on every facet there. At the end of a
/// round surface facets may lean away from it, a little.
pub(super) fn faces_away(mesh: &Mesh, boundary: &Boundary, normal: impl Fn(usize) -> [f64; 3]) -> Option<usize> {
    let outwards: Vec<[f64; 3]> = boundary.facets.iter().map(|facet| unit(mesh.area_vector(facet))).collect();
    let mut around = BTreeMap::<usize, Vec<usize>>::new();
    for (f, facet) in boundary.facets.iter().enumerate() {
        for &node in facet {
            around.entry(node).or_default().push(f);
        }
    }
    let cosine = |f: usize, node: usize| dot(outwards[f], normal(node));
    let any_faces = around.iter().any(|(node, facets)| facets.iter().any(|f| cosine(*f, *node) > 0.0));
    let is_round = |f: usize| {
        let beside = boundary.facets[f].iter().flat_map(|node| &around[node]);
        let least = beside.map(|&g| dot(outwards[f], outwards[g])).fold(1.0, f64::min);
        (SMOOTH..FLAT).contains(&least)
    };
    let leans = |f: usize, node: usize| any_faces && cosine(f, node) > -LEAN && is_round(f);
    let faces = |f: usize, node: usize| cosine(f, node) > 0.0 || leans(f, node);
    let of_facet = |(f, facet): (usize, &Vec<usize>)| facet.iter().copied().find(|node| !faces(f, *node));
    boundary.facets.iter().enumerate().find_map(of_facet)
}
