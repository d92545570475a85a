//! Friction that is left out.

use super::prelude::*;

kinds! {
    /// More than 1 % of the possible friction is in no result: it is at nodes supported in the sliding direction, or,
    /// with `events`, at nodes in two contacts.
    FRICTION_LEFT_OUT("friction-left-out", "End the support at a distance, or exchange the sides; use `bn`.", "never");
}

/// The boundary with the largest share of neglected friction: at nodes that supports constrain, and at nodes that have
/// no friction on the exact path.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct LeftOut(usize);

impl Finding for LeftOut {
    const KIND: WarningKind = WarningKind::FRICTION_LEFT_OUT;
    const LIMIT: f64 = 0.01;

    fn measure(model: &Model, step: &IncrementView<'_>) -> Option<(f64, Self)> {
        model.friction_left_out(step.state, step.increment.mu).map(|(k, share)| (share, LeftOut(k)))
    }

    fn fits(&self, model: &Model) -> bool {
        self.0 < model.contact.boundaries.len()
    }

    fn sentence(&self, model: &Model, share: f64, time: f64) -> String {
        format!(
            "at t = {time} s {:.0} % of the possible friction of `{}` is neglected, because supports hold its nodes in \
             the direction of sliding, or the exact path has none where two contacts meet; end the support at some \
             distance from the contact, make the other side the slave, or take solver.method = \"bn\" in place of \"events\"",
            100.0 * share,
            model.contact.boundaries[self.0].name
        )
    }
}
