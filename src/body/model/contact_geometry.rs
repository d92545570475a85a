//! The contact of a model as its history and its results see it: nodes, boundaries, obstacles, pairs.

use std::collections::BTreeMap;

use super::constraints::Constraints;
use super::contact::Contacts;
use super::motions::{self, Nearest};
use super::pair::Pair;
use super::recovery::{self, Recovery};
use crate::body::contact::{ContactBoundary, ContactNode, ObstacleMotion, Passages, PlacedObstacle};
use crate::body::mesh::Mesh;

/// The contact nodes with what is opposite.
#[derive(Debug, Clone)]
pub struct ContactGeometry {
    /// The contact nodes, in the order of `problem`'s rows.
    pub nodes: Vec<ContactNode>,
    /// The boundaries in contact.
    pub boundaries: Vec<ContactBoundary>,
    /// The obstacles in front of the boundaries, and their motions.
    pub obstacles: Vec<(PlacedObstacle, ObstacleMotion)>,
    /// The pairs of boundaries in contact with each other.
    pub pairs: Vec<Pair>,
    /// The obstacle that each contact node meets, where there are several.
    pub(super) nearest: Nearest,
    /// The recovery of tractions from contact forces, where dividing by the weights is not enough.
    pub(super) recovery: Option<Recovery>,
    /// For each contact node beyond the end of the other body: the contact nodes whose forces add up to the pressure
    /// there.
    pub(super) beside_the_end: BTreeMap<usize, Vec<usize>>,
    /// The search for bodies that pass through each other.
    pub(super) passages: Option<Passages>,
    /// For each contact node: `true` if the opposite side moves past it along a direction in which supports hold the
    /// node, so that friction is missing there.
    pub(super) passed_by: Vec<bool>,
}

impl ContactGeometry {
    pub(super) fn new(
        mesh: &Mesh,
        constraints: &Constraints,
        contacts: Contacts,
        nearest: Nearest,
        pairs: Vec<Pair>,
    ) -> Self {
        let Contacts { nodes, boundaries, obstacles, .. } = contacts;
        let past = |contact: &ContactNode| constraints.move_past(contact);
        let mortars = pairs.iter().filter(|pair| !pair.shifted).map(|pair| (&pair.mortar, &pair.gaps[..]));
        ContactGeometry {
            recovery: Recovery::new(mesh, &nodes, &boundaries, &pairs),
            beside_the_end: recovery::beside_the_end(mesh, &nodes, &boundaries),
            passages: Passages::new(mesh, mortars),
            passed_by: nodes.iter().map(|node| motions::passes(node, mesh.components(), &obstacles, past)).collect(),
            nodes,
            boundaries,
            obstacles,
            pairs,
            nearest,
        }
    }
}
