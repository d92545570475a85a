//! Where a state leaves the range of the linearised gaps.

use super::Model;
use crate::contact::{ContactStatus, DeformedNode, RangeLeft, range_left};

impl Model {
    /// For the displacements `u` (n_u, m) at time `t` (s) with the gaps `gap` (n_c, m) and the statuses of the
    /// contact nodes: the node whose linearised distance from its obstacle is most wrong, if that is too much;
    /// see [`range_left`].
    pub fn range_left(&self, t: f64, u: &[f64], gap: &[f64], statuses: &[ContactStatus]) -> Option<RangeLeft> {
        let displacements = self.strained(t, u);
        let interference = self.loading.largest_interference();
        let worst = self.obstacles.iter().enumerate().filter_map(|(k, (obstacle, motion))| {
            let met = (0..self.contacts.len()).filter(|&i| self.contacts[i].obstacle == k);
            let deformed = met.map(|i| DeformedNode {
                node: self.contacts[i].node,
                position: self.contacts[i].position,
                displacement: displacements[self.contacts[i].node],
                normal: self.contacts[i].facing.normal,
                gap: self.nodal_gap(i, t, gap[i]) + self.beyond(i, t),
                closed: statuses[i] != ContactStatus::Open,
            });
            range_left(obstacle, motion, t, interference, &deformed.collect::<Vec<_>>())
        });
        worst.max_by(|a, b| a.share.total_cmp(&b.share))
    }
}
