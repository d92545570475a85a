//! Motions along the contact that are not small.

use super::prelude::*;
use crate::body::model::LargeMotion;
use crate::solver::laws::ContactStatus;

kinds! {
    /// A closed node slid by more than a quarter of the shortest facet edge in front of it.
    SLID_ACROSS_FACETS("slid-across-facets", "Slide less; a coarser master.",
        "pressure hardly changes over that distance");
    /// A rigid body that can turn moved along its contact by more than a tenth of half the pressed width. Forces act where
    /// they were, so moments about the contact are off by force times motion; a body does not roll.
    LARGE_MOTION("large-motion", "Hold its rotation; move it less.", "rotation and pressures do not matter");
}

/// The closed contact node with the largest slip since the beginning relative to the facets in front of it, which are
/// those of the undeformed state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Slid {
    contact: usize,
    /// The slip, m.
    slip: f64,
}

impl Finding for Slid {
    const KIND: WarningKind = WarningKind::SLID_ACROSS_FACETS;
    /// Relative to the shortest edge of the facets in front of the node.
    const LIMIT: f64 = 0.25;

    fn measure(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Self)> {
        let drift = [0, 1].map(|k| model.loading.drift_at(step.record.time, k));
        let closed = (0..model.contact.nodes.len()).filter(|&i| step.statuses[i] != ContactStatus::Open);
        let slid = |i: usize| {
            let coupled = model.contact.nodes[i].coupled()?;
            let [w_t, w_o] = model.problem.tangential_maps().map(|map| map.dot(i, &step.state.u));
            let slip = (w_t - drift[0][i]).hypot(w_o - drift[1][i]);
            let edge = model.contact.pairs[coupled.pair].edges.get(&model.contact.nodes[i].node)?;
            Some((slip / edge, Slid { contact: i, slip }))
        };
        closed.filter_map(slid).max_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn fits(&self, model: &Model) -> bool {
        self.contact < model.contact.nodes.len()
    }

    fn sentence(&self, model: &Model, share: f64, time: f64) -> String {
        format!(
            "the contact node at {} has slid by {} at t = {time} s, {:.0} % of the opposing facet, but remains paired \
             with its initial nodes; pressures may be off by as much as they change over that distance",
            model.units().point(model.contact.nodes[self.contact].position),
            model.units().rounded(Quantity::Length, self.slip, 3),
            100.0 * share
        )
    }
}

impl Finding for LargeMotion {
    const KIND: WarningKind = WarningKind::LARGE_MOTION;
    /// As a share of half the width of the pressed zone. Pressures shift by about this share.
    const LIMIT: f64 = 0.1;

    fn measure(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Self)> {
        model.large_motion(step.record.time, step.state).map(|motion| (motion.share, motion))
    }

    fn fits(&self, model: &Model) -> bool {
        self.coupling < model.description().couplings.len()
    }

    fn sentence(&self, model: &Model, share: f64, time: f64) -> String {
        format!(
            "the rigid body `{}` has moved by {} along its contact at t = {time} s, {:.0} % of half the width of the \
             pressed zone: forces act where they were, so that moments about the contact are off by force times \
             motion, and a body does not roll; hold its rotation, or let it move less",
            model.description().couplings[self.coupling].name,
            model.units().rounded(Quantity::Length, self.moved, 3),
            100.0 * share
        )
    }
}
