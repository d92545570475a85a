//! Detection of contacts that end at a corner, where the pressure is singular; on a smooth surface it is finite.

use std::collections::BTreeMap;

use super::graph::ContactGraph;
use crate::algebra::vector::{dot, minus, norm, unit};
use crate::body::mesh::Facet;
use crate::body::model::Model;

/// The least angle of a corner, rad. A rounded edge of 90 degrees with three elements turns by less at each node.
const CORNER: f64 = 40.0 / 180.0 * std::f64::consts::PI;

/// A side lies in a symmetry plane if the cosine between its normal and a held direction of its node exceeds this.
const IN_PLANE: f64 = 0.9;

/// The corners of the bodies, and the corners of the obstacles at a given time.
pub(super) struct Corners<'a> {
    model: &'a Model,
    graph: &'a ContactGraph,
    /// The distances of the contact nodes from their obstacles, m.
    gaps: Vec<f64>,
    /// The sides of the body at each contact node.
    sides: BTreeMap<usize, Vec<Facet>>,
}

impl<'a> Corners<'a> {
    /// Creates the corners at `time` (s).
    pub fn new(model: &'a Model, graph: &'a ContactGraph, time: f64) -> Self {
        let rows = model.loading.gaps_at(time);
        let gaps = (0..model.contacts.len()).map(|i| model.nodal_gap(i, time, &rows)).collect();
        let mut sides: BTreeMap<usize, Vec<Facet>> =
            model.contacts.iter().map(|contact| (contact.node, Vec::new())).collect();
        for (facet, _) in model.mesh.surface_at(|node| sides.contains_key(&node)) {
            for node in &facet {
                if let Some(of_node) = sides.get_mut(node) {
                    of_node.push(facet.clone());
                }
            }
        }
        Corners { model, graph, gaps, sides }
    }

    /// Returns `true` if the contact of the `closed` nodes ends at contact node `i` at a corner: at the end of the
    /// contact surface, at a corner of the body, or at a corner of the obstacle.
    pub fn is_at(&self, i: usize, closed: impl Fn(usize) -> bool) -> bool {
        self.graph.is_at_the_rim(i) || self.of_body(i) || self.of_obstacle(i, closed)
    }

    /// Returns `true` if two sides of the body form a corner at contact node `i`.
    fn of_body(&self, i: usize) -> bool {
        let Corners { model, graph, .. } = self;
        let node = model.contacts[i].node;
        let cut = |normal: [f64; 3]| {
            graph.is_mirrored(i) && model.dofs.held(node).any(|held| dot(held, normal).abs() > IN_PLANE)
        };
        let sides = self.sides.get(&node).into_iter().flatten();
        let normals: Vec<[f64; 3]> =
            sides.map(|facet| unit(model.mesh.area_vector(facet))).filter(|normal| !cut(*normal)).collect();
        normals.iter().any(|one| normals.iter().any(|other| dot(*one, *other) < CORNER.cos()))
    }

    /// Returns `true` if the obstacle turns away beyond contact node `i` by at least the angle of a corner.
    fn of_obstacle(&self, i: usize, closed: impl Fn(usize) -> bool) -> bool {
        let slope = |j: usize| {
            let length = norm(minus(self.model.contacts[j].position, self.model.contacts[i].position));
            ((self.gaps[j] - self.gaps[i]) / length).atan()
        };
        let neighbours = self.graph.neighbours(i).iter().copied();
        let (inside, beyond): (Vec<usize>, Vec<usize>) = neighbours.partition(|&j| closed(j));
        let falls = beyond.into_iter().map(slope).fold(f64::NEG_INFINITY, f64::max);
        let runs = inside.into_iter().map(|j| -slope(j)).fold(f64::NEG_INFINITY, f64::max);
        falls - runs.max(0.0) > CORNER
    }
}
