//! Compares contact tractions on meshes of different size, point by point.

use std::collections::HashMap;
use stickslip::algebra::{dot, minus, norm};
use stickslip::body::ContactNode;
use stickslip::body::{ContactGraph, Model};
use stickslip::solver::State;

/// The number of elements left out at the rim of the contact boundary, because tractions are singular at edges and
/// corners of the body.
const OUTERMOST: usize = 2;

/// The rounding of a length, relative to the length of an element.
const ROUNDING: f64 = 1e-9;

/// The contact traction at a contact node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TractionNode {
    /// The position of the node, m.
    pub position: [f64; 3],
    /// Its integration weight `l`, m or m².
    pub weight: f64,
    /// The traction of the body on the obstacle (32), in the directions of space, Pa.
    pub value: [f64; 3],
    /// `true` if the contact boundary ends at the node. A symmetry plane is no such end.
    pub at_the_rim: bool,
}

/// The contact tractions on all contact boundaries.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tractions {
    /// The contact nodes, n_c.
    pub nodes: Vec<TractionNode>,
    /// The facets between the nodes: segments (two nodes) or triangles (three nodes), into which others are divided.
    pub pieces: Vec<Vec<usize>>,
}

/// The ends of a segment, or the corners of a triangle.
type Corners = Vec<[f64; 3]>;

/// The region in which tractions are compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Interior {
    inside: Vec<Corners>,
    outside: Vec<Corners>,
}

impl Interior {
    /// Returns `true` if the point lies in the region or on its rim.
    fn holds(&self, x: [f64; 3]) -> bool {
        let nearest = |all: &[Corners]| all.iter().map(|corners| share(corners, x).1).fold(f64::INFINITY, f64::min);
        let element = self.inside.first().map_or(0.0, |corners| norm(minus(corners[1], corners[0])));
        nearest(&self.inside) <= nearest(&self.outside) + ROUNDING * element
    }
}

impl Tractions {
    /// Returns the tractions of a `state` of `model`.
    pub(super) fn of(model: &Model, state: &State) -> Self {
        let force = |i: usize, k: usize| {
            let ([t, o], n) = (model.contact.nodes[i].facing.tangents, model.contact.nodes[i].facing.normal);
            let p = [state.p_n[i], state.p_t[i], state.p_o[i]];
            p[0] * n[k] + p[1] * t[k] + p[2] * o[k]
        };
        let graph = ContactGraph::new(model);
        let by_weights = || {
            let along = [0, 1, 2].map(|k| model.over_weights(|i| force(i, k)));
            (0..model.contact.nodes.len()).map(|i| [0, 1, 2].map(|k| along[k][i])).collect()
        };
        let values = model.recovered_tractions(state).unwrap_or_else(by_weights);
        let mut pieces = Vec::new();
        for boundary in &model.contact.boundaries {
            let index_of: HashMap<usize, usize> =
                boundary.nodes.iter().map(|&i| (model.contact.nodes[i].node, i)).collect();
            let facets = model.mesh.boundary(&boundary.name).map_or(&[][..], |boundary| &boundary.facets);
            for facet in facets.iter().flat_map(|facet| model.mesh.pieces_of(facet)) {
                // A node is no contact node if supports constrain its normal displacement or no obstacle is in reach.
                let Some(corners) = facet.iter().map(|node| index_of.get(node).copied()).collect::<Option<Vec<_>>>()
                else {
                    continue;
                };
                match corners[..] {
                    [a, b] => pieces.push(vec![a, b]),
                    [first, ref others @ ..] => {
                        pieces.extend(others.windows(2).map(|pair| vec![first, pair[0], pair[1]]));
                    }
                    [] => {}
                }
            }
        }
        let node = |(i, (contact, value)): (usize, (&ContactNode, [f64; 3]))| TractionNode {
            position: contact.position,
            weight: contact.weight,
            value,
            at_the_rim: graph.is_at_the_rim(i),
        };
        Tractions { nodes: model.contact.nodes.iter().zip(values).enumerate().map(node).collect(), pieces }
    }

    fn corners(&self, piece: &[usize]) -> Corners {
        piece.iter().map(|&i| self.nodes[i].position).collect()
    }

    /// Returns the part of the boundary on which the tractions of finer meshes are compared with these: without the two
    /// outermost elements along the rim, or all of it if nothing else remains.
    pub fn interior(&self) -> Interior {
        let mut outer: Vec<bool> = self.nodes.iter().map(|node| node.at_the_rim).collect();
        for _ in 1..OUTERMOST {
            let reached = outer.clone();
            for piece in self.pieces.iter().filter(|piece| piece.iter().any(|&i| reached[i])) {
                for &i in piece {
                    outer[i] = true;
                }
            }
        }
        let (outside, inside): (Vec<_>, Vec<_>) = self.pieces.iter().partition(|piece| piece.iter().any(|&i| outer[i]));
        let corners = |pieces: Vec<&Vec<usize>>| pieces.into_iter().map(|piece| self.corners(piece)).collect();
        if inside.is_empty() {
            return Interior { inside: corners(outside), outside: Vec::new() };
        }
        Interior { inside: corners(inside), outside: corners(outside) }
    }

    /// Returns the distance to the tractions of a `finer` mesh in the L2 norm of the part `within`, relative to the
    /// finer tractions. The coarser tractions are interpolated linearly at the nodes of the finer mesh, so that all
    /// meshes are evaluated at the same points. NaN if one of the two has no tractions there.
    pub fn distance(&self, finer: &Tractions, within: &Interior) -> f64 {
        let (mut difference, mut whole, mut points) = (0.0, 0.0, 0_usize);
        for &TractionNode { position, weight, value, .. } in &finer.nodes {
            if within.holds(position) {
                let Some(coarse) = self.at(position) else { return f64::NAN };
                difference += weight * dot(minus(coarse, value), minus(coarse, value));
                whole += weight * dot(value, value);
                points += 1;
            }
        }
        if points == 0 { f64::NAN } else { relative(difference.sqrt(), whole.sqrt()) }
    }

    /// Returns the traction at the point of the boundary nearest to `x`.
    fn at(&self, x: [f64; 3]) -> Option<[f64; 3]> {
        let shares = self.pieces.iter().map(|piece| (piece, share(&self.corners(piece), x)));
        let (piece, (shares, _)) = shares.min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
        let sum = |k: usize| piece.iter().zip(&shares).map(|(&i, share)| share * self.nodes[i].value[k]).sum();
        Some([0, 1, 2].map(sum))
    }
}

/// Returns the weights of the corners at the point of a segment or triangle near `x`, which is the nearest point if `x`
/// projects into it, and its distance from `x`.
fn share(corners: &[[f64; 3]], x: [f64; 3]) -> (Vec<f64>, f64) {
    let from_corner = minus(x, corners[0]);
    let mut shares = match corners[1..] {
        [b, c] => {
            let (b, c) = (minus(b, corners[0]), minus(c, corners[0]));
            let (bb, bc, cc, rb, rc) = (dot(b, b), dot(b, c), dot(c, c), dot(from_corner, b), dot(from_corner, c));
            let area = bb * cc - bc * bc;
            let [s, t] = [(rb * cc - rc * bc) / area, (rc * bb - rb * bc) / area];
            vec![1.0 - s - t, s, t]
        }
        [b, ..] => {
            let b = minus(b, corners[0]);
            let s = dot(from_corner, b) / dot(b, b);
            vec![1.0 - s, s]
        }
        [] => vec![1.0],
    };
    for share in &mut shares {
        *share = share.max(0.0);
    }
    let sum: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= sum;
    }
    let near = |k: usize| corners.iter().zip(&shares).map(|(corner, share)| share * corner[k]).sum::<f64>();
    let distance = norm(minus(x, [0, 1, 2].map(near)));
    (shares, distance)
}

/// Returns `|value| / scale`, and 0 if `value` is 0.
pub(super) fn relative(value: f64, scale: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.abs() / scale.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Divides a unit square into n × n squares of two triangles each, with a traction that is linear in space.
    fn square(n: usize) -> Tractions {
        let at = |k: usize| k as f64 / n as f64;
        let positions: Vec<[f64; 3]> = (0..=n).flat_map(|j| (0..=n).map(move |i| [at(i), at(j), 0.0])).collect();
        let node = |i: usize, j: usize| j * (n + 1) + i;
        let mut pieces = Vec::new();
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            pieces.push(vec![node(i, j), node(i + 1, j), node(i + 1, j + 1)]);
            pieces.push(vec![node(i, j), node(i + 1, j + 1), node(i, j + 1)]);
        }
        let traction = |position: [f64; 3]| {
            let [x, y, _] = position;
            let at_the_rim = [x, y].into_iter().any(|x| x == 0.0 || x == 1.0);
            TractionNode { position, weight: 1.0, value: [1.0 + x, 2.0 * y, x - y], at_the_rim }
        };
        Tractions { nodes: positions.into_iter().map(traction).collect(), pieces }
    }

    #[test]
    fn a_surface_is_compared_inside_its_rim() {
        let (coarse, mut fine) = (square(6), square(9));
        let within = coarse.interior();
        let count = coarse.nodes.iter().filter(|node| within.holds(node.position)).count();
        // Of 7 × 7 nodes, the middle 3 × 3 remain.
        assert_eq!(count, 9);
        assert!(coarse.distance(&fine, &within) < 1e-14);
        // Linear tractions are reproduced exactly at the finer nodes. An error at the rim has no influence.
        for node in &mut fine.nodes {
            if node.position.iter().take(2).any(|x| !(0.2..0.8).contains(x)) {
                node.value = [9.0; 3];
            }
        }
        assert!(coarse.distance(&fine, &within) < 1e-14);
        fine.nodes.iter_mut().for_each(|node| node.value = [0.0, 0.0, 2.0]);
        let inner: Vec<_> = fine.nodes.iter().map(|node| node.position).filter(|x| within.holds(*x)).collect();
        let apart = |[x, y, _]: [f64; 3]| (1.0 + x).powi(2) + (2.0 * y).powi(2) + (x - y - 2.0).powi(2);
        assert_eq!(inner.len(), 16);
        let expected = (inner.iter().map(|x| apart(*x)).sum::<f64>() / (4.0 * 16.0)).sqrt();
        assert!((coarse.distance(&fine, &within) / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn of_a_small_surface_all_counts() {
        let (coarse, fine) = (square(3), square(6));
        let within = coarse.interior();
        assert!(coarse.nodes.iter().all(|node| within.holds(node.position)));
        assert!(coarse.distance(&fine, &within) < 1e-14);
        assert!(coarse.distance(&Tractions::default(), &within).is_nan());
    }
}
