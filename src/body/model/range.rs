//! Check that a state stays within the range of the linearised gaps.

use super::Model;
use crate::body::contact::{DeformedNode, RangeLeft, range_left};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

impl Model {
    /// Returns the node with the largest error of the linearised distance from its obstacle, if the error is too large,
    /// see [`range_left`]. The `state` is that at time `t` (s), with the gaps `gap` (n_c, m) and the statuses of the
    /// contact nodes. The indentation is at least the deepest interference of the history and the indentation by the
    /// contact forces: if body and obstacle fit, pressed nodes do not move along the normal.
    pub fn range_left(&self, t: f64, state: &State, gap: &[f64], statuses: &[ContactStatus]) -> Option<RangeLeft> {
        let displacements = self.strained(t, &state.u);
        let interference = self.loading.largest_interference();
        let worst = self.obstacles.iter().enumerate().filter_map(|(k, (obstacle, motion))| {
            let met = (0..self.contacts.len()).filter(|&i| self.met(i, t).is_some_and(|(met, _)| met == k));
            let deformed = met.map(|i| DeformedNode {
                node: self.contacts[i].node,
                position: self.contacts[i].position,
                displacement: displacements[self.contacts[i].node],
                normal: self.contacts[i].facing.normal,
                gap: self.nodal_gap(i, t, gap) + self.beyond(i, t),
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
        let on_this = |i: usize| self.met(i, t).is_some_and(|(met, _)| met == k);
        let pressed = (0..self.contacts.len()).filter(|&i| state.p_n[i] > 0.0 && on_this(i));
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
        let contact = &self.contacts[i];
        let Some((k, facing)) = self.met(i, t) else { return self.slope_in_pair(i) };
        let (obstacle, motion) = &self.obstacles[k];
        motion.slope(obstacle, t, contact.position, &facing)
    }
}
