//! Where a body comes to rest that contact alone holds.

use super::IncrementDriver;
use crate::solver::solvability::{Landing, Load, NEARBY, landing};

impl IncrementDriver<'_> {
    /// Carries a body that contact alone holds to where it comes to rest under the load of the part that ends at `time`; the
    /// nodes that touch there, if it has not been there before. `None` for a body that supports hold, and where nothing can be said.
    pub(super) fn find_rest_position(&mut self, time: f64, sizes: &[f64]) -> Option<Vec<usize>> {
        if !self.may_move_rigidly {
            return None;
        }
        // As near as what the load deforms, Newton's method finds what closes better than a rigid body does.
        let force = self.held.response(self.loading, None, time).contact_force * self.settings.scaling.force;
        let reach = |(gap, k): (&f64, &f64)| (force / k).max(NEARBY * gap.abs());
        let reach: Vec<f64> = self.gap.iter().zip(&self.settings.contact_stiffness).map(reach).collect();
        let moved = self.at.offset.w_n.iter().zip(&self.at.w_n).map(|(offset, w)| offset + w);
        let distance: Vec<f64> = self.gap.iter().zip(moved).map(|(gap, w)| gap - w).collect();
        let load = Load { force: &self.force, sizes };
        let Landing { weights, nodes } = landing(self.problem, &self.mu, &load, &distance, &reach)?;
        self.at.offset = self.at.offset.by(self.problem, &weights);
        let stays = weights.iter().all(|weight| *weight == 0.0);
        (self.at.reached.is_none() || !stays).then_some(nodes)
    }
}
