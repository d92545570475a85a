//! Where a body comes to rest that contact alone holds.

use super::Path;
use crate::problem::ContactProblem;
use crate::solvability::{Landing, Load, landing};

/// The share of its terms that `K r` may leave of a free motion `r` along which a body is carried: ten times what rounding
/// makes of rotations of bodies with a thousand elements a side.
const UNSTRAINED: f64 = 1e-12;

/// A contact node that is nearer to its obstacle, relative to its gap, touches it.
const NEGLIGIBLE: f64 = 1e-10;

impl Path<'_> {
    /// Carries a body that contact alone holds to where it comes to rest under the load of the part that ends at `time`; the
    /// nodes that touch there, if it has not been there before. `None` for a body that supports hold, and where nothing can be said.
    pub(super) fn land(&mut self, time: f64, sizes: &[f64]) -> Option<Vec<usize>> {
        if !self.may_be_carried {
            return None;
        }
        // As near as what the load deforms, Newton's method finds what closes better than a rigid body does.
        let force = self.held.response(self.loading, None, time).contact_force * self.settings.scaling.force;
        let reach = |(gap, k): (&f64, &f64)| (force / k).max(NEGLIGIBLE * gap.abs());
        let reach: Vec<f64> = self.gap.iter().zip(&self.settings.contact_stiffness).map(reach).collect();
        let moved = self.at.carried.w_n.iter().zip(&self.at.w_n).map(|(carried, w)| carried + w);
        let distance: Vec<f64> = self.gap.iter().zip(moved).map(|(gap, w)| gap - w).collect();
        let load = Load { force: &self.force, sizes };
        let Landing { weights, nodes } = landing(self.problem, &self.mu, &load, &distance, &reach)?;
        self.at.carried = self.at.carried.by(self.problem, &weights);
        let stays = weights.iter().all(|weight| *weight == 0.0);
        (self.at.reached.is_none() || !stays).then_some(nodes)
    }
}

/// Whether a body has free motions, and they strain it no more than rounding does.
pub(super) fn is_carried_without_strain(problem: &ContactProblem) -> bool {
    let unstrained = |motion: &Vec<f64>| {
        let (mut force, mut sizes) = (vec![0.0; motion.len()], vec![0.0; motion.len()]);
        problem.stiffness().mul(motion, &mut force);
        problem.stiffness().add_sizes(motion, &mut sizes);
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        largest(&force) <= UNSTRAINED * largest(&sizes)
    };
    let motions = problem.free_motions();
    !motions.is_empty() && motions.iter().all(unstrained)
}
