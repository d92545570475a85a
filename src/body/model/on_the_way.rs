//! Obstacles that pass through the body, or leave it, within an increment.

use serde::{Deserialize, Serialize};

use super::Model;
use crate::body::contact::{ContactBoundary, outsides};
use crate::solver::problem::State;

/// A node that an obstacle passes through within an increment, or leaves although it touches the node at both ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnTheWay {
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

impl Model {
    /// Returns `true` if an obstacle may pass within an increment. Only a single plane that does not turn never does.
    pub fn has_passing_obstacles(&self) -> bool {
        self.contact_boundaries.iter().any(|boundary| self.may_pass(boundary))
    }

    fn may_pass(&self, boundary: &ContactBoundary) -> bool {
        let obstacles = &self.obstacles[boundary.obstacles.clone()];
        let moves = obstacles.iter().any(|(obstacle, motion)| motion.moves() || motion.turns(obstacle));
        let is_flat = matches!(obstacles, [(obstacle, motion)] if obstacle.is_plane() && !motion.turns(obstacle));
        boundary.pair.is_none() && moves && !is_flat
    }

    /// Finds the node that an obstacle penetrates or leaves furthest within the increment between two times (s) with
    /// their states; a node that the obstacle leaves touches it at both ends.
    ///
    /// A motion in one direction along any path does neither, since the obstacle stays between the two positions of the
    /// node.
    pub fn on_the_way(&self, times: [f64; 2], states: [&State; 2]) -> Option<OnTheWay> {
        let mut worst: Option<OnTheWay> = None;
        for boundary in self.contact_boundaries.iter().filter(|boundary| self.may_pass(boundary)) {
            let Some(facets) = self.mesh.boundary(&boundary.name) else { continue };
            let outsides = outsides(&self.mesh, facets);
            let pressed = states.map(|state| ROUNDING * state.p_n.iter().fold(0.0, |most: f64, p_n| most.max(*p_n)));
            let ends = [0, 1].map(|end| self.strained(times[end], &states[end].u));
            let rows = [0, 1].map(|end| (self.loading.gaps_at(times[end]), self.problem.c_n().mul(&states[end].u)));
            for share in SHARES {
                let t = times[0] + share * (times[1] - times[0]);
                for &i in &boundary.nodes {
                    let (node, x) = (self.contacts[i].node, self.contacts[i].position);
                    let Some(outside) = outsides.get(&node) else { continue };
                    // Displacements that are not small change the distance, but not that of the contact row.
                    let [first, last] = [0, 1].map(|end| {
                        let see = |t: f64| self.see(boundary, t, x, ends[end][node], *outside).distance;
                        let (gap, w_n) = &rows[end];
                        see(t) - see(times[end]) + gap[i] - w_n[i]
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
                        worst = Some(OnTheWay { contact: i, time: times[1], distance });
                    }
                }
            }
        }
        worst
    }
}
