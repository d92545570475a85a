//! Contact that never comes about, or along a wrong direction.

use super::displacements::NOT_SMALL;
use super::prelude::*;
use crate::body::contact::ContactBoundary;
use crate::solver::laws::ContactStatus;

kinds! {
    /// A boundary never touched what is in front of it.
    NO_CONTACT("no-contact", "See positions and motions in `check`.", "it is a stop that need not be reached");
    /// A touched obstacle, or with `direction` a boundary, is inclined to the contact normal by a slope above a tenth.
    LEANING_OBSTACLE("leaning-obstacle", "`direction = \"nearest\"` or another `normal`; between bodies no `direction`.",
        "never");
}

/// Warns of the first boundary that never touched what is in front of it.
pub(super) fn no_contact(Solved { model, checks, .. }: &Solved<'_>) -> Option<Warning> {
    // Without a converged increment, nothing is known of the contact.
    let mut boundaries = model.contact.boundaries.iter().filter(|_| checks.so_far.increments > 0);
    // An obstacle inside the body between nodes touches, unseen.
    let inside = checks.between_nodes.0.as_ref().filter(|(found, _)| found.untouched.is_some());
    let is_unseen = |boundary: &ContactBoundary| inside.is_some_and(|(found, _)| found.boundary == boundary.name);
    let boundary = boundaries.find(|b| !is_unseen(b) && !b.nodes.iter().any(|&i| checks.so_far.touched[i]))?;
    let name = &boundary.name;
    let message = match boundary.pair.map(|k| &model.contact.pairs[k].master.name) {
        None => format!(
            "`{name}` never touched its obstacle; `stickslip check` shows where the obstacle is and how it moves"
        ),
        Some(master) => format!("`{name}` never touched `{master}`; `stickslip check` shows how far apart they are"),
    };
    Some(WarningKind::NO_CONTACT.warning(message))
}

/// The contact node that touched the obstacle with the largest slope against the node's normal, and the slope.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct LeaningObstacle(pub(super) Option<(usize, f64)>);

impl Check for LeaningObstacle {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        for (i, _) in step.statuses.iter().enumerate().filter(|(_, status)| **status != ContactStatus::Open) {
            // The slope is that of the moving obstacle when it touches. The last of equal slopes counts.
            let slope = model.slope(i, step.record.time);
            if !slope.is_nan() && self.0.is_none_or(|(_, steepest)| slope >= steepest) {
                self.0 = Some((i, slope));
            }
        }
    }

    fn fits(&self, model: &Model) -> bool {
        self.0.is_none_or(|(i, _)| i < model.contact.nodes.len())
    }

    fn warning(&self, model: &Model, _: &SoFar) -> Option<Warning> {
        let (i, slope) = self.0.filter(|(_, slope)| *slope > NOT_SMALL)?;
        let (place, degrees) = (model.units().point(model.contact.nodes[i].position), slope.atan().to_degrees());
        let message = if model.contact.nodes[i].coupled().is_some() {
            format!(
                "at the node {place} the surface is inclined by {degrees:.0} degrees to the direction of its contact; \
                 remove `direction`"
            )
        } else {
            format!(
                "at the node {place} the obstacle is inclined by {degrees:.0} degrees to the normal along which it \
                 presses; use direction = \"nearest\", or another normal"
            )
        };
        Some(WarningKind::LEANING_OBSTACLE.warning(message))
    }
}
