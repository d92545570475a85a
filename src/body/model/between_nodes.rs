//! Overlaps with obstacles that contact nodes miss: obstacles that they do not meet, obstacles between nodes, and obstacles
//! that pass through the body, or leave it, within an increment.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Model;
use crate::algebra::vector::{dot, minus, norm, plus, unit};
use crate::body::contact::{ContactBoundary, outsides};
use crate::body::mesh::Facet;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// A contact node inside an obstacle that it does not meet.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overlap {
    /// The number of the contact node.
    pub contact: usize,
    /// The number of the obstacle.
    pub obstacle: usize,
    /// The depth of the node inside the obstacle, m.
    pub depth: f64,
}

/// A place where the distance of an obstacle between nodes differs from that interpolated from the nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BetweenNodes {
    /// The name of the contact boundary.
    pub boundary: String,
    /// The position in the undeformed body, m.
    pub position: [f64; 3],
    /// The difference between the distance there and the interpolated distance, or the depth inside the obstacle, m.
    pub missed: f64,
    /// The nodes of the facet, if none of them touches.
    pub untouched: Option<Facet>,
    /// The longest edge of the facet, m.
    pub size: f64,
}

/// The error of a distance of 0 in a solution, as a share of the largest displacement.
const SOLVED: f64 = 1e-10;

/// The rounding error of a distance, as a share of the coordinates that are subtracted.
const DISTANCE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A direction points out of the body if its cosine with the outward normal exceeds this.
const OUT: f64 = 1e-9;

/// The factor of uncertainty of the height of an arc computed from the normals at its ends.
const ARC: f64 = 1.5;

/// The points examined on an edge, as shares of its length. They are unequally spaced so that no period of a surface is
/// in phase with the nodes and all points.
const PLACES: [f64; 8] = [0.07, 0.14, 0.26, 0.38, 0.5, 0.62, 0.73, 0.87];

/// The nearest obstacle as seen from a point of a boundary.
pub(crate) struct NearestObstacle {
    /// The distance, m; NaN if no obstacle is in front.
    pub distance: f64,
    /// A vector into the obstacle, normal to its surface.
    inward: [f64; 3],
}

/// A point of a facet: the nodes with their shares.
type Place = Vec<(usize, f64)>;

impl Model {
    /// Returns the largest indentation (m) by contact forces of all obstacles, see [`Model::range_left`].
    pub fn pressed(&self, t: f64, state: &State) -> f64 {
        (0..self.contact.obstacles.len()).map(|k| self.pressed_in(k, t, state)).fold(0.0, f64::max)
    }

    /// Returns the contact node that is deepest inside an obstacle that it does not meet at time `t` (s).
    ///
    /// The obstacle belongs to its boundary, or is a bounded one that has come from another boundary. Depths within the
    /// error of a solution or rounding do not count.
    pub fn overlap(&self, t: f64, state: &State) -> Option<Overlap> {
        if self.contact.obstacles.len() < 2 {
            return None;
        }
        let displacements = self.constraints.strained(t, &state.u);
        let noise = SOLVED * displacements.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        let mut deepest: Option<Overlap> = None;
        for boundary in self.contact.boundaries.iter().filter(|boundary| boundary.pair.is_none()) {
            let outsides = self.mesh.boundary(&boundary.name).map(|facets| outsides(&self.mesh, facets));
            for &i in &boundary.nodes {
                let (node, x) = (self.contact.nodes[i].node, self.contact.nodes[i].position);
                let assigned = self.assigned(i, t).map(|(k, _)| k);
                let Some(outside) = outsides.as_ref().and_then(|outsides| outsides.get(&node)) else { continue };
                for (k, (obstacle, motion)) in
                    self.contact.obstacles.iter().enumerate().filter(|(k, _)| Some(*k) != assigned)
                {
                    let own = boundary.obstacles.contains(&k);
                    let may_come = obstacle.is_bounded() && self.is_carried_along(k, node);
                    if !(own || may_come) {
                        continue;
                    }
                    let depth_at = |t: f64, moved: [f64; 3]| {
                        let (back, out) = motion.back(t, moved, *outside);
                        let (distance, normal) = obstacle.nearest(back, x);
                        (distance < 0.0 && dot(out, normal) > OUT * norm(out)).then_some((-distance, back))
                    };
                    let Some((depth, back)) = depth_at(t, plus(x, 1.0, displacements[node])) else { continue };
                    let small = depth <= noise + DISTANCE_ROUNDING * (norm(x) + norm(back));
                    if !small && deepest.is_none_or(|last| depth > last.depth) && (own || depth_at(0.0, x).is_none()) {
                        deepest = Some(Overlap { contact: i, obstacle: k, depth });
                    }
                }
            }
        }
        deepest
    }

    /// Returns `true` if the motion of obstacle `k` is relative to the rigid offset of the body at `node`.
    fn is_carried_along(&self, k: usize, node: usize) -> bool {
        let boundary = self.contact.boundaries.iter().find(|boundary| boundary.obstacles.contains(&k));
        let first = boundary.and_then(|boundary| boundary.nodes.first()).map(|&i| self.contact.nodes[i].node);
        first.is_some_and(|first| self.constraints.groups.of_node[first] == self.constraints.groups.of_node[node])
    }

    /// Returns the point of a contact facet at which the distance of the obstacle differs most from the interpolated
    /// nodal distances, at time `t` (s).
    ///
    /// On a facet with a closed node, the measure is the difference; on any other facet, the depth of the point inside
    /// the obstacle beyond that of the nodes. Arcs that follow from the normals at the nodes are subtracted: arcs that straight facets
    /// cut off a curved boundary, and beside a closed node those of the obstacle, which the nodes resolve as far as possible.
    pub fn between_nodes(&self, t: f64, state: &State, statuses: &[ContactStatus]) -> Option<BetweenNodes> {
        let curved = |boundary: &&ContactBoundary| {
            self.contact.obstacles[boundary.obstacles.clone()].iter().any(|(obstacle, _)| !obstacle.is_plane())
        };
        let boundaries: Vec<&ContactBoundary> = self.contact.boundaries.iter().filter(curved).collect();
        if boundaries.is_empty() {
            return None;
        }
        let displacements = self.constraints.strained(t, &state.u);
        let noise = SOLVED * displacements.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        let mut worst: Option<BetweenNodes> = None;
        for boundary in boundaries {
            let Some(facets) = self.mesh.boundary(&boundary.name) else { continue };
            let outsides = outsides(&self.mesh, facets);
            let closed: BTreeMap<usize, bool> = boundary
                .nodes
                .iter()
                .map(|&i| (self.contact.nodes[i].node, statuses[i] != ContactStatus::Open))
                .collect();
            let mut at_nodes: BTreeMap<usize, NearestObstacle> = BTreeMap::new();
            for facet in facets.facets.iter().filter(|facet| facet.iter().any(|node| closed.contains_key(node))) {
                let outward = self.mesh.area_vector(facet);
                let mean = |point: &[(usize, f64)], of: &dyn Fn(usize) -> [f64; 3]| {
                    point.iter().fold([0.0; 3], |sum, (node, share)| plus(sum, *share, of(*node)))
                };
                let nearest_at = |point: &[(usize, f64)]| {
                    let x = mean(point, &|node| self.mesh.nodes[node]);
                    self.nearest_obstacle(boundary, t, x, mean(point, &|node| displacements[node]), outward)
                };
                let touches = facet.iter().any(|node| closed.get(node) == Some(&true));
                for node in facet {
                    at_nodes.entry(*node).or_insert_with(|| nearest_at(&[(*node, 1.0)]));
                }
                for (edges, places) in pieces(facet, self.mesh.dimension) {
                    let along = |[a, b]: [usize; 2]| minus(self.mesh.nodes[b], self.mesh.nodes[a]);
                    let arc = |edge: [usize; 2]| {
                        let of = |[from, to]: [[f64; 3]; 2]| dot(minus(unit(to), unit(from)), along(edge)).abs() / 8.0;
                        // A node without an obstacle in front contributes no arc.
                        let of_obstacle = of(edge.map(|node| at_nodes[&node].inward)).max(0.0);
                        of(edge.map(|node| outsides[&node])) + if touches { of_obstacle } else { 0.0 }
                    };
                    // Across a facet in three dimensions, the arcs of its sides add up, each counted twice.
                    let twice = if edges.len() > 1 { 2.0 } else { 1.0 };
                    let arcs = edges.iter().map(|edge| arc(*edge)).sum::<f64>() / twice;
                    let size = edges.iter().map(|edge| norm(along(*edge))).fold(0.0, f64::max);
                    for place in places {
                        let there = nearest_at(&place).distance;
                        let linear: f64 = place.iter().map(|(node, share)| share * at_nodes[node].distance).sum();
                        // Rounded or inclined, an obstacle may be as far inside at nodes that do not touch.
                        let at_nodes = place.iter().map(|(node, _)| at_nodes[node].distance).fold(0.0, f64::min);
                        let missed =
                            if touches && !linear.is_nan() { (there - linear).abs() } else { at_nodes - there };
                        let position = mean(&place, &|node| self.mesh.nodes[node]);
                        let missed = missed - ARC * arcs - noise - DISTANCE_ROUNDING * norm(position);
                        if missed > 0.0 && worst.as_ref().is_none_or(|worst| missed > worst.missed) {
                            let untouched = (!touches).then(|| facet.clone());
                            let boundary = boundary.name.clone();
                            worst = Some(BetweenNodes { boundary, position, missed, untouched, size });
                        }
                    }
                }
            }
        }
        worst
    }

    /// Returns the nearest obstacle at time `t` (s) as seen from a point at `x` displaced by `u` (m), on a facet of
    /// `boundary` with the outward vector `outward`.
    pub(crate) fn nearest_obstacle(
        &self,
        boundary: &ContactBoundary,
        t: f64,
        x: [f64; 3],
        u: [f64; 3],
        outward: [f64; 3],
    ) -> NearestObstacle {
        let moved = plus(x, 1.0, u);
        let mut nearest = NearestObstacle { distance: f64::NAN, inward: [f64::NAN; 3] };
        for (obstacle, motion) in &self.contact.obstacles[boundary.obstacles.clone()] {
            let (back, out) = motion.back(t, moved, outward);
            let (distance, normal) = if obstacle.has_one_normal() {
                let normal = motion.back(t, moved, obstacle.normal).1;
                (obstacle.distance(back, normal, x), normal)
            } else {
                obstacle.nearest(back, x)
            };
            let is_nearer = nearest.distance.is_nan() || distance < nearest.distance;
            if is_nearer && dot(out, normal) > OUT * norm(out) {
                let inward = motion.forth(t, obstacle.at(back).inward);
                nearest = NearestObstacle { distance, inward };
            }
        }
        nearest
    }

    /// Returns `true` if an obstacle may pass within an increment. Only a single plane that does not turn never does.
    pub fn has_passing_obstacles(&self) -> bool {
        self.contact.boundaries.iter().any(|boundary| self.may_pass(boundary))
    }

    fn may_pass(&self, boundary: &ContactBoundary) -> bool {
        let obstacles = &self.contact.obstacles[boundary.obstacles.clone()];
        let moves = obstacles.iter().any(|(obstacle, motion)| motion.moves() || motion.turns(obstacle));
        let is_flat = matches!(obstacles, [(obstacle, motion)] if obstacle.is_plane() && !motion.turns(obstacle));
        boundary.pair.is_none() && moves && !is_flat
    }

    /// Finds the node that an obstacle penetrates or leaves furthest within the increment between two times (s) with
    /// their states; a node that the obstacle leaves touches it at both ends.
    ///
    /// A motion in one direction along any path does neither, since the obstacle stays between the two positions of the
    /// node.
    pub fn passed_node(&self, times: [f64; 2], states: [&State; 2]) -> Option<PassedNode> {
        let mut worst: Option<PassedNode> = None;
        for boundary in self.contact.boundaries.iter().filter(|boundary| self.may_pass(boundary)) {
            let Some(facets) = self.mesh.boundary(&boundary.name) else { continue };
            let outsides = outsides(&self.mesh, facets);
            let pressed = states.map(|state| ROUNDING * state.p_n.iter().fold(0.0, |most: f64, p_n| most.max(*p_n)));
            let ends = [0, 1].map(|end| self.constraints.strained(times[end], &states[end].u));
            let rows = [0, 1].map(|end| (self.loading.gaps_at(times[end]), self.problem.c_n().mul(&states[end].u)));
            for share in SHARES {
                let t = times[0] + share * (times[1] - times[0]);
                for &i in &boundary.nodes {
                    let (node, x) = (self.contact.nodes[i].node, self.contact.nodes[i].position);
                    let Some(outside) = outsides.get(&node) else { continue };
                    // Displacements that are not small change the distance, but not that of the contact row.
                    let [first, last] = [0, 1].map(|end| {
                        let at = |t: f64| self.nearest_obstacle(boundary, t, x, ends[end][node], *outside).distance;
                        let (gap, w_n) = &rows[end];
                        at(t) - at(times[end]) + gap[i] - w_n[i]
                    });
                    let touches = states.iter().zip(pressed).all(|(state, least)| state.p_n[i] > least);
                    let distance = if first < 0.0 && last < 0.0 {
                        first.max(last)
                    } else if touches && first > 0.0 && last > 0.0 {
                        first.min(last)
                    } else {
                        continue;
                    };
                    if worst.is_none_or(|worst| distance.abs() > worst.distance.abs()) {
                        worst = Some(PassedNode { contact: i, time: times[1], distance });
                    }
                }
            }
        }
        worst
    }
}

/// Returns the parts of a facet, each with its edges and points on it: in two dimensions the lines from node to node,
/// in three dimensions the whole facet.
fn pieces(facet: &[usize], dimension: usize) -> Vec<(Vec<[usize; 2]>, Vec<Place>)> {
    let on_edge = |[a, b]: [usize; 2]| PLACES.map(|share| vec![(a, 1.0 - share), (b, share)]);
    if dimension == 2 {
        return facet
            .windows(2)
            .map(|edge| [edge[0], edge[1]])
            .map(|edge| (vec![edge], on_edge(edge).to_vec()))
            .collect();
    }
    let count = facet.len();
    let edges: Vec<[usize; 2]> = (0..count).map(|k| [facet[k], facet[(k + 1) % count]]).collect();
    let inwards = |place: Place, share: f64| -> Place {
        let own = place.into_iter().map(|(node, of_edge)| (node, (1.0 - share) * of_edge));
        own.chain(facet.iter().map(|&node| (node, share / count as f64))).collect()
    };
    let places = edges.iter().flat_map(|edge| on_edge(*edge).into_iter().zip(PLACES));
    let mut places: Vec<Place> = places.flat_map(|(place, share)| [place.clone(), inwards(place, share)]).collect();
    places.push(inwards(Vec::new(), 1.0));
    vec![(edges, places)]
}

/// A node that an obstacle passes through within an increment, or leaves although it touches the node at both ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PassedNode {
    /// The number of the contact node.
    pub contact: usize,
    /// The end of the increment, s.
    pub time: f64,
    /// The distance of the obstacle from the node within the increment, m, for the position of the node at the nearer
    /// end; negative inside.
    pub distance: f64,
}

/// The fractions of an increment at which obstacles are examined. They are unequally spaced so that no rotation is in
/// phase with all of them.
const SHARES: [f64; 7] = [0.11, 0.24, 0.37, 0.5, 0.62, 0.77, 0.9];

/// A node touches an obstacle if its normal force is a larger share of the largest normal force; a smaller share is the
/// rounding of a node that opens.
const ROUNDING: f64 = 1e-9;
