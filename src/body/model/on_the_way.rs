//! Obstacles that pass through the body, or leave it, within an increment.

use serde::{Deserialize, Serialize};

use super::Model;
use crate::body::contact::{ContactBoundary, outsides};
use crate::solver::problem::State;

/// Where an obstacle is inside the body on the way through an increment, or leaves a node that it touches at both ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OnTheWay {
    /// The number of the contact node.
    pub contact: usize,
    /// The end of the increment, s.
    pub time: f64,
    /// The distance of the obstacle from the node on the way, m, from where the node is at the end that is nearer; negative inside.
    pub distance: f64,
}

/// The shares of an increment at which obstacles are looked at. They are unequal, so that no turn has them all in step.
const SHARES: [f64; 7] = [0.11, 0.24, 0.37, 0.5, 0.62, 0.77, 0.9];

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

    /// Where an obstacle goes furthest through a node, or leaves one that it touches at both ends, on the way between two times (s) with their states.
    /// A motion in one direction does neither, however curved its path is: the obstacle stays between the two positions of the node.
    pub fn on_the_way(&self, times: [f64; 2], states: [&State; 2]) -> Option<OnTheWay> {
        let mut worst: Option<OnTheWay> = None;
        for boundary in self.contact_boundaries.iter().filter(|boundary| self.may_pass(boundary)) {
            let Some(facets) = self.mesh.boundary(&boundary.name) else { continue };
            let outsides = outsides(&self.mesh, facets);
            let [before, after] = [0, 1].map(|end| self.strained(times[end], &states[end].u));
            for share in SHARES {
                let t = times[0] + share * (times[1] - times[0]);
                for &i in &boundary.nodes {
                    let (node, x) = (self.contacts[i].node, self.contacts[i].position);
                    let Some(outside) = outsides.get(&node) else { continue };
                    let [first, last] = [&before, &after].map(|u| self.see(boundary, t, x, u[node], *outside).distance);
                    let touches = states.iter().all(|state| state.p_n[i] > 0.0);
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
