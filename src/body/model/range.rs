//! Checks of a state: the range of the linearised gaps, missing friction, bodies that pass through each other.
//!
//! Gaps and normals are those of the undeformed body. The error is checked afterwards: the exact distance of the
//! deformed node from the moved obstacle, along the node's normal, is compared with the linearised distance.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Model;
use crate::algebra::vector::{dot, norm};
use crate::body::contact::{ContactBoundary, ObstacleMotion, Passed, PlacedObstacle};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

impl Model {
    /// Returns the node with the largest error of the linearised distance from its obstacle, if the error is too large,
    /// see [`range_left`]. The `state` is that at time `t` (s), with the gaps `gap` (n_c, m) and the statuses of the
    /// contact nodes. The indentation is at least the deepest interference of the history and the indentation by the
    /// contact forces: if body and obstacle fit, pressed nodes do not move along the normal.
    pub fn range_left(&self, t: f64, state: &State, gap: &[f64], statuses: &[ContactStatus]) -> Option<RangeLeft> {
        let displacements = self.constraints.strained(t, &state.u);
        let interference = self.loading.largest_interference();
        let worst = self.contact.obstacles.iter().enumerate().filter_map(|(k, (obstacle, motion))| {
            let assigned =
                (0..self.contact.nodes.len()).filter(|&i| self.assigned(i, t).is_some_and(|(own, _)| own == k));
            let deformed = assigned.map(|i| DeformedNode {
                node: self.contact.nodes[i].node,
                position: self.contact.nodes[i].position,
                displacement: displacements[self.contact.nodes[i].node],
                normal: self.contact.nodes[i].facing.normal,
                gap: self.nodal_gap(i, t, gap) + self.normal_deviation(i, t),
                closed: statuses[i] != ContactStatus::Open,
            });
            let deformed: Vec<_> = deformed.collect();
            range_left(obstacle, motion, t, interference.max(self.pressed_in(k, t, state)), &deformed)
        });
        worst.max_by(|a, b| a.share.total_cmp(&b.share))
    }

    /// Estimates the indentation (m) of the body by the contact forces on obstacle `k`, rather too small: the sum of
    /// the forces divided by the stiffness of a node with all others held. In two dimensions this stiffness is about E,
    /// like that of a contact of any width; in three dimensions the stiffness of a contact grows with its width, the
    /// square root of the number of nodes.
    pub(super) fn pressed_in(&self, k: usize, t: f64, state: &State) -> f64 {
        let on_this = |i: usize| self.assigned(i, t).is_some_and(|(own, _)| own == k);
        let pressed = (0..self.contact.nodes.len()).filter(|&i| state.p_n[i] > 0.0 && on_this(i));
        let shares: Vec<f64> = pressed.map(|i| state.p_n[i] / self.problem.own_stiffness(i)).collect();
        let width = if self.mesh.dimension == 3 { (shares.len() as f64).sqrt() } else { 1.0 };
        let sum: f64 = shares.iter().filter(|share| share.is_finite()).sum();
        if sum > 0.0 { sum / width } else { 0.0 }
    }

    /// Returns the slope of the obstacle in front of contact node `i` at time `t` (s), relative to the node's normal:
    /// the tangent of the angle.
    ///
    /// In front of a body, the slope is that of the node's surface if a direction is given, otherwise NaN.
    pub fn slope(&self, i: usize, t: f64) -> f64 {
        let contact = &self.contact.nodes[i];
        let Some((k, facing)) = self.assigned(i, t) else { return self.slope_in_pair(i) };
        let (obstacle, motion) = &self.contact.obstacles[k];
        motion.slope(obstacle, t, contact.position, &facing)
    }

    /// Returns the largest share of missing friction of the contact boundaries, with the number of the boundary.
    ///
    /// The share is that of the possible friction at nodes that supports hold along a direction in which the opposite
    /// side moves past them, and at those to which a method gives none; `mu` are the friction coefficients of the nodes.
    pub fn friction_left_out(&self, state: &State, mu: &[f64]) -> Option<(usize, f64)> {
        let own = if self.loading.friction().is_none() { self.problem.mu() } else { mu };
        let lacks = |i: &usize| self.contact.passed_by[*i] || mu[*i] < own[*i];
        if !(0..mu.len()).any(|i| lacks(&i)) {
            return None;
        }
        let share = |(k, boundary): (usize, &ContactBoundary)| {
            let friction = |i: &usize| own[*i] * state.p_n[*i];
            let all: f64 = boundary.nodes.iter().map(friction).sum();
            let lost: f64 = boundary.nodes.iter().filter(|i| lacks(i)).map(friction).sum();
            (k, if all > 0.0 { lost / all } else { 0.0 })
        };
        self.contact.boundaries.iter().enumerate().map(share).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the place where a body has entered another, or a boundary the one in front of it, without a contact row,
    /// for the displacements `u` (m).
    pub fn passed(&self, u: &[[f64; 3]]) -> Option<Passed> {
        self.contact.passages.as_ref()?.deepest(&self.mesh, u)
    }

    /// Returns the slope of the slave of a pair at contact node `i` relative to the given direction; NaN if none is
    /// given.
    fn slope_in_pair(&self, i: usize) -> f64 {
        let contact = &self.contact.nodes[i];
        let slope = contact.coupled().and_then(|coupled| self.contact.pairs[coupled.pair].slopes.get(&contact.node));
        slope.copied().unwrap_or(f64::NAN)
    }

    /// Returns the tractions (Pa) of the masters of all pairs on their slaves, as pairs of a node and a vector.
    pub fn master_tractions(&self, state: &State) -> Vec<(usize, [f64; 3])> {
        let mut all = Vec::new();
        for (k, pair) in self.contact.pairs.iter().enumerate().filter(|(_, pair)| !pair.glued) {
            let own = (0..self.contact.nodes.len())
                .filter(|&i| self.contact.nodes[i].coupled().is_some_and(|own| own.pair == k));
            let forces: BTreeMap<usize, [f64; 3]> =
                own.map(|i| (self.contact.nodes[i].node, self.contact_force(state, i))).collect();
            let of_rows = pair.mortar.rows.iter().map(|row| forces.get(&row.node).copied().unwrap_or_default());
            all.extend(pair.mortar.on_master(&self.mesh, &of_rows.collect::<Vec<_>>()));
        }
        all
    }
}

/// The largest tolerated error of the linearisation, as a share of the indentation. Since pressures follow from the
/// indentation, about this share of a pressure is then wrong, which is more than the usual error of a mesh.
pub const TOLERATED_SHARE: f64 = 0.1;

/// The error of a distance of 0 in a solution, as a share of the largest displacement: the usual bound of the error
/// measure.
const SOLVED: f64 = 1e-10;

/// The rounding error of a distance, as a share of the coordinates that are subtracted: a few units in the last place.
const DISTANCE_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A contact node whose linearised distance from the obstacle is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct RangeLeft {
    /// The number of the node in the mesh, from 0.
    pub node: usize,
    /// The position of the node, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
    /// The linearised distance of the node from the obstacle, as computed, m.
    pub linearised: f64,
    /// The distance of the node along the normal without linearisation, m; null if the obstacle is no longer in front
    /// of it.
    pub exact: f64,
    /// The difference of the two distances divided by the largest indentation.
    pub share: f64,
}

/// A contact node in its deformed state.
#[derive(Debug, Clone, Copy)]
pub struct DeformedNode {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The position of the node before the deformation, m.
    pub position: [f64; 3],
    /// The displacement of the node, m.
    pub displacement: [f64; 3],
    /// The normal along which the gap is measured.
    pub normal: [f64; 3],
    /// The gap of the node at this time, m.
    pub gap: f64,
    /// `true` if the node is in contact.
    pub closed: bool,
}

/// Returns the node of `nodes`, in front of `obstacle` at time `t` (s), with the largest error of the linearised
/// distance, if the error exceeds `TOLERATED_SHARE` of the indentation.
///
/// The indentation is the larger of `indentation` (m), a lower bound known beforehand, and the largest normal
/// displacement of a closed node; if no node is closed, the largest displacement. An open node counts only if it is
/// inside the obstacle by its exact distance. Differences within rounding and the tolerance of a solution are ignored:
/// on a plane that touches from the start, nothing is indented.
pub fn range_left(
    obstacle: &PlacedObstacle,
    motion: &ObstacleMotion,
    t: f64,
    indentation: f64,
    nodes: &[DeformedNode],
) -> Option<RangeLeft> {
    let normal_displacement = |node: &DeformedNode| dot(node.normal, node.displacement);
    let largest = nodes.iter().fold(0.0_f64, |m, node| m.max(norm(node.displacement)));
    let closed = nodes.iter().filter(|node| node.closed).map(|node| normal_displacement(node).abs());
    let indentation = indentation.max(closed.reduce(f64::max).unwrap_or(largest));
    let mut worst: Option<RangeLeft> = None;
    for node in nodes {
        let DeformedNode { position, displacement, normal, .. } = *node;
        let moved = [0, 1, 2].map(|c| position[c] + displacement[c]);
        let (x, n) = motion.back(t, moved, normal);
        let exact = obstacle.distance(x, n, position);
        let linearised = node.gap - normal_displacement(node);
        let missed = if node.closed { (exact - linearised).abs() } else { (-exact).max(0.0) };
        let share = missed / indentation;
        let noise = SOLVED * largest + DISTANCE_ROUNDING * (norm(position) + norm(x));
        // A closed node that no longer has the obstacle in front of it is the worst case.
        let is_left = missed > noise && share > TOLERATED_SHARE || node.closed && exact.is_nan();
        if is_left && worst.is_none_or(|worst| share.is_nan() || share > worst.share) {
            worst = Some(RangeLeft { node: node.node, position, time: t, linearised, exact, share });
        }
    }
    worst
}
