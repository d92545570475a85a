//! Friction that is left out.

use super::prelude::*;

kinds! {
    /// More than 1 % of the possible friction is in no result: it is at nodes supported in the sliding direction, or,
    /// with `events`, at nodes in two contacts.
    FRICTION_LEFT_OUT("friction-left-out", "End the support at a distance, or exchange the sides; use `bn`.", "never");
}

/// The share of the possible friction that may be neglected without a warning.
const NEGLIGIBLE: f64 = 0.01;

/// Warns of the boundary with the largest share of neglected friction: at nodes that supports constrain, and at nodes
/// that have no friction on the exact path.
pub(super) fn left_out(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Warning)> {
    let left_out = model.friction_left_out(step.state, step.increment.mu);
    let (k, share) = left_out.filter(|(_, share)| *share > NEGLIGIBLE)?;
    let (time, name) = (six_digits(step.record.time), &model.contact.boundaries[k].name);
    let warning = WarningKind::FRICTION_LEFT_OUT.warning(format!(
        "at t = {time} s {:.0} % of the possible friction of `{name}` is neglected, because supports hold its nodes in \
         the direction of sliding, or the exact path has none where two contacts meet; end the support at some \
         distance from the contact, make the other side the slave, or take solver.method = \"bn\" in place of \"events\"",
        100.0 * share
    ));
    Some((share, warning))
}
