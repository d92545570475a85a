//! The obstacle that each node of a boundary meets, and holes of a surface of triangles in front of it. Nodes that no
//! obstacle ever reaches are left out.

use std::collections::HashMap;

use super::motion::ObstacleMotion;
use super::obstacle::{Facing, PlacedObstacle};
use super::tree::Bounds;
use super::triangles::Hole;
use crate::algebra::vector::{dot, minus, norm, plus};
use crate::body::mesh::{Boundary, Mesh};

/// A node of a boundary in front of an obstacle.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeObstacle {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The number of the obstacle among those in front of the boundary.
    pub obstacle: usize,
    /// The obstacle as seen from the node.
    pub facing: Facing,
    /// The other obstacles that press the node along the same normal. The node meets the nearest one at each time.
    pub others: Vec<usize>,
}

/// A node with an undefined distance from an obstacle, at the beginning or later.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unclear {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The number of the obstacle.
    pub obstacle: usize,
    /// The time, s, if the obstacle moves.
    pub time: Option<f64>,
    /// The reason and the correction, in words.
    pub why: (&'static str, &'static str),
}

/// A normal counts as pointing out of the body if its cosine with the node's outward normal exceeds this, to allow for
/// rounding.
const ALONG: f64 = 1e-9;

/// A distance counts as shorter only if the difference exceeds this share of the size of the boundary; smaller
/// differences are rounding.
const EQUAL_DISTANCE: f64 = 1e-12;

impl NodeObstacle {
    /// Returns the obstacle that is nearest to the node at `x` (m) at time `t` (s), and the gap, m.
    pub fn nearest(&self, obstacles: &[(PlacedObstacle, ObstacleMotion)], x: [f64; 3], t: f64) -> (usize, f64) {
        nearest(obstacles, (self.obstacle, &self.facing), &self.others, x, t)
    }
}

/// Returns the obstacle that is nearest to a node at `x` (m) at time `t` (s), and the gap, m.
///
/// The result is the obstacle `own`, unless one of the `others` is nearer. If an obstacle is not in front of the
/// node, its gap is the size of the boundary.
pub fn nearest(
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    (own, facing): (usize, &Facing),
    others: &[usize],
    x: [f64; 3],
    t: f64,
) -> (usize, f64) {
    let gap = |k: usize, facing: &Facing| {
        let (obstacle, motion) = &obstacles[k];
        let is_in_front = obstacle.is_plane() || motion.is_in_front(obstacle, t, x, facing);
        if is_in_front { motion.exact_gap(obstacle, t, x, facing) } else { obstacle.extent() }
    };
    others.iter().fold((own, gap(own, facing)), |(nearest, distance), &k| {
        let other = gap(k, &obstacles[k].0.seen_from(x));
        if other < distance - EQUAL_DISTANCE * obstacles[k].0.extent() { (k, other) } else { (nearest, distance) }
    })
}

/// Returns the nodes of `boundary` that an obstacle of `obstacles` reaches between 0 and the end, each with the
/// obstacle that it meets.
///
/// Among the obstacles that the node's outside faces, this is the nearest at the beginning of the history. If none
/// reaches the node then, it is the one that comes nearest at `times` (s) or at a kink of a motion. Among obstacles
/// with the same normal, a node meets the nearest at each time. Nodes that no obstacle ever reaches are left out; they
/// stay open.
///
/// # Errors
/// A node that no obstacle reaches and whose distance from one is undefined, or a node inside an obstacle that has
/// turned its back to it or moved over it.
pub fn meetings(
    mesh: &Mesh,
    boundary: &Boundary,
    obstacles: &[(PlacedObstacle, ObstacleMotion)],
    times: &[f64],
) -> Result<Vec<NodeObstacle>, Unclear> {
    // A single obstacle must be in front of the whole boundary, which is checked facet by facet.
    let outsides = if obstacles.len() > 1 { outsides(mesh, boundary) } else { HashMap::new() };
    let mut assigned = Vec::new();
    for node in boundary.nodes() {
        let x = mesh.nodes[node];
        let is_in_front = |facing: &Facing| {
            outsides.get(&node).is_none_or(|outside| dot(*outside, facing.normal) > ALONG * norm(*outside))
        };
        let facings: Vec<(usize, Facing)> = (obstacles.iter().enumerate())
            .map(|(k, (obstacle, _))| (k, obstacle.at(x)))
            .filter(|(_, facing)| is_in_front(facing))
            .collect();
        let nearest = |distance: &dyn Fn(usize, &Facing) -> f64| {
            let distances = facings.iter().map(|(k, facing)| (distance(*k, facing), *k, *facing));
            distances.filter(|(distance, ..)| distance.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let at_first = nearest(&|k, facing| obstacles[k].1.exact_gap(&obstacles[k].0, 0.0, x, facing));
        let later = || {
            nearest(&|k, facing| match &obstacles[k] {
                (obstacle, _) if obstacle.out_of_reach().is_some() => f64::NAN,
                (obstacle, motion) => motion.nearest_approach(obstacle, x, facing, times),
            })
        };
        let swallowed = |(k, facing): &(usize, Facing)| {
            let (obstacle, motion) = &obstacles[*k];
            let time = motion.swallows(obstacle, x, facing, times)?;
            let why = if obstacle.surrounds() {
                ("the bore or socket moves over", "let it move less far aside, or use direction = \"nearest\"")
            } else {
                ("the obstacle turns its back to the body and covers", "let it turn less far, or beside the body")
            };
            Some(Unclear { node, obstacle: *k, time: Some(time), why })
        };
        let Some((_, obstacle, facing)) = at_first.or_else(later) else {
            if let Some(unclear) = facings.iter().find_map(swallowed) {
                return Err(unclear);
            }
            let unclear = facings.iter().find_map(|(k, _)| Some((*k, obstacles[*k].0.out_of_reach()?)));
            if let Some((obstacle, why)) = unclear {
                return Err(Unclear { node, obstacle, time: None, why });
            }
            continue;
        };
        if let Some(unclear) = swallowed(&(obstacle, facing)) {
            return Err(unclear);
        }
        let facing = obstacles[obstacle].0.in_front(facing);
        let presses_alike = |k: &usize| *k != obstacle && obstacles[*k].0.presses_as(&obstacles[obstacle].0);
        let others = facings.iter().map(|(k, _)| *k).filter(presses_alike).collect();
        assigned.push(NodeObstacle { node, obstacle, facing, others });
    }
    Ok(assigned)
}

/// Returns the sum of the area vectors of the facets at each node of `boundary`.
pub(crate) fn outsides(mesh: &Mesh, boundary: &Boundary) -> HashMap<usize, [f64; 3]> {
    let mut sums: HashMap<usize, [f64; 3]> = HashMap::new();
    for facet in &boundary.facets {
        let area = mesh.area_vector(facet);
        for node in facet {
            sums.entry(*node).or_default().iter_mut().zip(area).for_each(|(sum, c)| *sum += c);
        }
    }
    sums
}

/// Returns the holes of `obstacle`, if that is a surface of triangles, that are in front of `boundary` at 0 or at
/// `times` (s) as the obstacle moves by `motion`.
///
/// Holes that another part of the surface hides from the boundary are left out.
pub fn holes_in_front_of(
    mesh: &Mesh,
    boundary: &Boundary,
    (obstacle, motion): &(PlacedObstacle, ObstacleMotion),
    times: &[f64],
) -> Vec<Hole> {
    let Some(triangles) = obstacle.surface_of_triangles() else { return Vec::new() };
    let facets: Vec<Vec<[f64; 3]>> = boundary.facets.iter().map(|facet| mesh.points(facet)).collect();
    let longest = facets.iter().map(|points| Bounds::of(points).extent()).fold(0.0, f64::max);
    let mut holes = triangles.holes(longest);
    let is_seen_at = |hole: &Hole, t: f64| {
        let place = |x: &[f64; 3]| motion.back(t, *x, obstacle.normal).0;
        let [low, high] = hole.bounds;
        if !obstacle.has_one_normal() {
            return facets.iter().any(|points| {
                let points: Vec<[f64; 3]> = points.iter().map(place).collect();
                let around = Bounds::of(&points);
                let distances = points.iter().map(|x| obstacle.nearest(*x, *x).0.abs());
                let distance = distances.filter(|distance| distance.is_finite()).fold(0.0, f64::max);
                around.grown(distance + around.extent()).overlaps(&Bounds { low, high })
            });
        }
        let [normal, first, second] =
            [obstacle.normal, obstacle.tangents[0], obstacle.tangents[1]].map(|axis| motion.back(t, [0.0; 3], axis).1);
        let before = plus(hole.middle, -2.0 * triangles.extent, normal);
        let depth = dot(minus(hole.middle, before), normal);
        if triangles.entry(before, normal).is_some_and(|entry| entry.distance < depth - hole.size) {
            return false;
        }
        let shadow = |points: Vec<[f64; 3]>| {
            Bounds::of(&points.iter().map(|x| [dot(*x, first), dot(*x, second), 0.0]).collect::<Vec<_>>())
        };
        let corner = |k: usize| [0, 1, 2].map(|c| if k >> c & 1 == 0 { low[c] } else { high[c] });
        let of_hole = shadow((0..8).map(corner).collect());
        facets.iter().any(|points| shadow(points.iter().map(place).collect()).overlaps(&of_hole))
    };
    holes.retain(|hole| [0.0].iter().chain(times).any(|t| is_seen_at(hole, *t)));
    holes
}
