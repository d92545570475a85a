//! Where a state leaves the range of the linearised gaps.

use super::Model;
use crate::body::contact::{DeformedNode, RangeLeft, range_left};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

impl Model {
    /// For the `state` at time `t` (s) with the gaps `gap` (n_c, m) and the statuses of the contact nodes: the node whose
    /// linearised distance from its obstacle is most wrong, if that is too much; see [`range_left`]. The indentation is at least
    /// the deepest interference of the history, and what the contact forces press in: where body and obstacle fit, nodes that
    /// are pressed do not move along the normal.
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

    /// How far (m) the contact forces on obstacle `k` press the body in, if rather less: their sum over the stiffness of a node with
    /// all others held. In two dimensions that is about E, as of a contact of any width; in three it grows with the width, that is
    /// with the root of the number of nodes.
    pub(super) fn pressed_in(&self, k: usize, t: f64, state: &State) -> f64 {
        let on_this = |i: usize| self.met(i, t).is_some_and(|(met, _)| met == k);
        let pressed = (0..self.contacts.len()).filter(|&i| state.p_n[i] > 0.0 && on_this(i));
        let shares: Vec<f64> = pressed.map(|i| state.p_n[i] / self.problem.own_stiffness(i)).collect();
        let width = if self.mesh.dimension == 3 { (shares.len() as f64).sqrt() } else { 1.0 };
        let sum: f64 = shares.iter().filter(|share| share.is_finite()).sum();
        if sum > 0.0 { sum / width } else { 0.0 }
    }

    /// The slope of its obstacle in front of contact node `i` at time `t` (s), against the node's normal: the tangent of the angle; in
    /// front of a body that of its own surface where a direction is given, otherwise NaN.
    pub fn slope(&self, i: usize, t: f64) -> f64 {
        let contact = &self.contacts[i];
        let Some((k, facing)) = self.met(i, t) else { return self.slope_in_pair(i) };
        let (obstacle, motion) = &self.obstacles[k];
        motion.slope(obstacle, t, contact.position, &facing)
    }
}
