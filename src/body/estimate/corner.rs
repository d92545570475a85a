//! Detection of contacts that end at a corner, where the pressure is singular; on a smooth surface it is finite.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::{CORNER, ContactGraph};
use crate::algebra::vector::{dot, minus, norm, plus, unit};
use crate::body::mesh::{Facet, sorted};
use crate::body::model::Model;

/// The least angle of an edge of an obstacle, rad: tables and triangles have small ones along a rounding.
const EDGE: f64 = 10.0 / 180.0 * std::f64::consts::PI;

/// At an edge, the obstacle turns by more than this share of its turn over two elements.
const MAX_OF: f64 = 0.5;

/// The pieces of an element's side in which the turn of an obstacle is examined.
const PIECES: u32 = 16;

/// A side lies in a symmetry plane if the cosine between its normal and a held direction of its node exceeds this.
const IN_PLANE: f64 = 0.9;

/// The corners of the bodies, and the corners of the obstacles at a given time.
pub(super) struct Corners<'a> {
    model: &'a Model,
    graph: &'a ContactGraph,
    /// The time, s.
    time: f64,
    /// The distances of the contact nodes from their obstacles, m.
    gaps: Vec<f64>,
    /// The sides of the body at each contact node.
    sides: BTreeMap<usize, Vec<Facet>>,
}

impl<'a> Corners<'a> {
    /// Creates the corners at `time` (s).
    pub fn new(model: &'a Model, graph: &'a ContactGraph, time: f64) -> Self {
        let rows = model.loading.gaps_at(time);
        let gaps = (0..model.contact.nodes.len()).map(|i| model.nodal_gap(i, time, &rows)).collect();
        let mut sides: BTreeMap<usize, Vec<Facet>> =
            model.contact.nodes.iter().map(|contact| (contact.node, Vec::new())).collect();
        let glued = model.contact.pairs.iter().filter(|pair| pair.glued).flat_map(|pair| pair.mortar.sides().concat());
        let glued: BTreeSet<Facet> = glued.map(|facet| sorted(&facet)).collect();
        let surface = model.mesh.surface_at(|node| sides.contains_key(&node)).into_iter();
        for (facet, _) in surface.filter(|(facet, _)| !glued.contains(&sorted(facet))) {
            for node in &facet {
                if let Some(of_node) = sides.get_mut(node) {
                    of_node.push(facet.clone());
                }
            }
        }
        Corners { model, graph, time, gaps, sides }
    }

    /// Returns `true` if the contact of the `closed` nodes ends at contact node `i` at a corner: at the end of the
    /// contact surface, at a corner of the body, or at a corner of the obstacle.
    pub fn is_at(&self, i: usize, closed: impl Fn(usize) -> bool) -> bool {
        self.graph.is_at_the_rim(i) || self.of_body(i) || self.of_obstacle(i, closed)
    }

    /// Returns `true` if two sides of the body form a corner at contact node `i`.
    fn of_body(&self, i: usize) -> bool {
        let Corners { model, graph, .. } = self;
        let node = model.contact.nodes[i].node;
        let cut = |normal: [f64; 3]| {
            graph.mirrored[i] && model.constraints.dofs.held(node).any(|held| dot(held, normal).abs() > IN_PLANE)
        };
        let sides = self.sides.get(&node).into_iter().flatten();
        let normals: Vec<[f64; 3]> =
            sides.map(|facet| unit(model.mesh.area_vector(facet))).filter(|normal| !cut(*normal)).collect();
        normals.iter().any(|one| normals.iter().any(|other| dot(*one, *other) < CORNER.cos()))
    }

    /// Returns `true` if the obstacle has an edge at contact node `i`, where it turns away. A rounded edge turns between
    /// the nodes, too; there the pressure is finite, and a finer mesh helps.
    fn of_obstacle(&self, i: usize, closed: impl Fn(usize) -> bool) -> bool {
        let slope = |j: usize| {
            let length = norm(minus(self.model.contact.nodes[j].position, self.model.contact.nodes[i].position));
            ((self.gaps[j] - self.gaps[i]) / length).atan()
        };
        let neighbours = self.graph.neighbours[i].iter().copied();
        let (inside, outside): (Vec<usize>, Vec<usize>) = neighbours.partition(|&j| closed(j));
        let steepest =
            |nodes: &[usize], sign: f64| nodes.iter().map(|&j| (j, sign * slope(j))).max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((outer, falls)) = steepest(&outside, 1.0) else { return false };
        let (inner, runs) = steepest(&inside, -1.0).map_or((None, 0.0), |(inner, runs)| (Some(inner), runs));
        let turns = falls - runs.max(0.0);
        match self.sharpest_turn(i, inner, outer) {
            Some(edge) => edge > EDGE && edge > MAX_OF * turns,
            None => turns > CORNER,
        }
    }

    /// Returns the largest turn of the obstacle, rad, between neighbouring pieces of the line from contact node `inner`
    /// over `i` to `outer`; `None` if the obstacle is not in front of all of it.
    fn sharpest_turn(&self, i: usize, inner: Option<usize>, outer: usize) -> Option<f64> {
        let Corners { model, time, .. } = self;
        let boundary = model.contact.boundaries.iter().find(|boundary| boundary.nodes.contains(&i))?;
        let at = model.contact.nodes[i].position;
        let beside = |j: usize, share: f64| plus(at, share, minus(model.contact.nodes[j].position, at));
        let shares = || (1..=PIECES).map(|piece| f64::from(piece) / f64::from(PIECES));
        let before = inner.into_iter().flat_map(|j| shares().rev().map(move |share| (j, share)));
        let line =
            before.map(|(j, share)| beside(j, share)).chain([at]).chain(shares().map(|share| beside(outer, share)));
        let points: Vec<[f64; 3]> = line.collect();
        let outward = model.contact.nodes[i].facing.normal;
        let gap = |x: &[f64; 3]| model.nearest_obstacle(boundary, *time, *x, [0.0; 3], outward).distance;
        let gaps: Vec<f64> = points.iter().map(gap).collect();
        let slopes: Vec<f64> = (points.windows(2).zip(gaps.windows(2)))
            .map(|(x, gap)| ((gap[1] - gap[0]) / norm(minus(x[1], x[0]))).atan())
            .collect();
        let turns = slopes.windows(2).map(|pair| pair[1] - pair[0]);
        slopes.iter().all(|slope| slope.is_finite()).then(|| turns.fold(0.0, f64::max))
    }
}
