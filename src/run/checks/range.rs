//! Contact that leaves the range of the linearised gaps.

use super::prelude::*;
use crate::body::model::RangeLeft;

kinds! {
    /// The contact left the range of linearised gaps.
    GAPS_OUT_OF_RANGE("gaps-out-of-range", "Place the obstacle nearer to where it presses; move it less; see \
        [gaps](scene/obstacle.md#gaps-and-normals).", "never");
}

/// The largest error of the linearised gaps, if they were out of their range.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct GapsOutOfRange(pub(super) Option<RangeLeft>);

impl Check for GapsOutOfRange {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        if let Some(left) = model.range_left(step.record.time, step.state, step.increment.gap, step.statuses)
            && self.0.is_none_or(|worst| left.share.is_nan() || left.share > worst.share)
        {
            self.0 = Some(left);
        }
    }

    fn warning(&self, model: &Model, _: &SoFar) -> Option<Warning> {
        let RangeLeft { position, time, linearised, exact, share, .. } = self.0?;
        let (units, time) = (model.units(), six_digits(time));
        let place = units.point(position);
        let remedy = "pressures may be equally wrong; place the obstacle of the scene nearer to where it presses, or let \
             it move less";
        let off =
            if share < 10.0 { format!(", off by {:.0} % of the indentation", 100.0 * share) } else { String::new() };
        let [linearised, shown] = [linearised, exact].map(|distance| units.rounded(Quantity::Length, distance, 3));
        let message = if exact.is_nan() {
            format!("the obstacle is no longer in front of the contact node at {place} at t = {time} s: {remedy}")
        } else {
            format!(
                "gaps are linearised in the undeformed state, and the contact leaves the range of this approximation: \
                 at the node {place} at t = {time} s the distance is {shown}, not {linearised}{off}; {remedy}"
            )
        };
        Some(WarningKind::GAPS_OUT_OF_RANGE.warning(message))
    }
}
