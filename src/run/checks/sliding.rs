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

/// The slip above which a warning is given, relative to the shortest edge of the facets in front of the node.
const FAR: f64 = 0.25;

/// The motion above which a warning is given, as a share of half the width of the pressed zone. Pressures shift by about
/// this share.
const LARGE: f64 = 0.1;

/// Warns of the closed contact node with the largest slip since the beginning relative to the facets in front of it, which
/// are those of the undeformed state.
pub(super) fn slid(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Warning)> {
    let (time, contacts) = (step.record.time, &model.contact.nodes);
    let drift = [0, 1].map(|k| model.loading.drift_at(time, k));
    let is_revolved = model.mesh.geometry.is_revolved();
    let closed = (0..contacts.len()).filter(|&i| step.statuses[i] != ContactStatus::Open);
    let slid = |i: usize| {
        let coupled = contacts[i].coupled()?;
        let [w_t, w_o] = model.problem.tangential_maps().map(|map| map.dot(i, &step.state.u));
        // Around its axis a body of revolution meets the same facets.
        let across = contacts[i].facing.tangents.map(|tangent| if is_revolved { 1.0 - tangent[2].abs() } else { 1.0 });
        let slip = (across[0] * (w_t - drift[0][i])).hypot(across[1] * (w_o - drift[1][i]));
        let edge = model.contact.pairs[coupled.pair].edges.get(&contacts[i].node)?;
        Some((slip / edge, slip, i))
    };
    let farthest = closed.filter_map(slid).max_by(|a, b| a.0.total_cmp(&b.0));
    let (share, slip, i) = farthest.filter(|(share, ..)| *share > FAR)?;
    let (place, slip) = (model.units().point(contacts[i].position), model.units().rounded(Quantity::Length, slip, 3));
    let warning = WarningKind::SLID_ACROSS_FACETS.warning(format!(
        "the contact node at {place} has slid by {slip} at t = {} s, {:.0} % of the opposing facet, but remains paired \
         with its initial nodes; pressures may be off by as much as they change over that distance",
        six_digits(time),
        100.0 * share
    ));
    Some((share, warning))
}

/// Warns of a rigid body that moves far along its contact.
pub(super) fn large_motion(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Warning)> {
    let motion = model.large_motion(step.record.time, step.state);
    let LargeMotion { coupling, moved, share } = motion.filter(|motion| motion.share > LARGE)?;
    let (name, moved) =
        (&model.description().couplings[coupling].name, model.units().rounded(Quantity::Length, moved, 3));
    let warning = WarningKind::LARGE_MOTION.warning(format!(
        "the rigid body `{name}` has moved by {moved} along its contact at t = {} s, {:.0} % of half the width of the \
         pressed zone: forces act where they were, so that moments about the contact are off by force times motion, and \
         a body does not roll; hold its rotation, or let it move less",
        six_digits(step.record.time),
        100.0 * share
    ));
    Some((share, warning))
}
