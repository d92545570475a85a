//! Obstacles of triangles that approximate curved surfaces.

use serde::{Deserialize, Serialize};

use super::Model;
use crate::algebra::vector::median;
use crate::solver::problem::State;

/// The error of an obstacle of triangles that approximate a curved surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ObstacleChords {
    /// The number of the obstacle.
    pub obstacle: usize,
    /// The distance of the curved surface from the middle of the triangles, m: the median over the nodes that are pressed.
    pub beyond: f64,
}

impl Model {
    /// Returns the obstacle of triangles that is furthest from the curved surface that it stands for, of those pressed at
    /// time `t` (s).
    pub fn obstacle_chords(&self, t: f64, state: &State) -> Option<ObstacleChords> {
        let of_obstacle = |k: usize| {
            let (obstacle, motion) = &self.obstacles[k];
            obstacle.triangles()?;
            let pressed = (0..self.contacts.len()).filter(|&i| state.p_n[i] > 0.0);
            let place = |i: usize| {
                let (met, facing) = self.met(i, t)?;
                (met == k).then(|| motion.back(t, self.contacts[i].position, facing.normal))
            };
            let beyond = median(&mut obstacle.beyond_triangles(pressed.filter_map(place)))?;
            Some(ObstacleChords { obstacle: k, beyond })
        };
        (0..self.obstacles.len()).filter_map(of_obstacle).max_by(|a, b| a.beyond.total_cmp(&b.beyond))
    }
}
