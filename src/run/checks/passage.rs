//! Motions of obstacles within an increment.

use super::prelude::*;
use crate::body::model::PassedNode;
use crate::solver::problem::State;

kinds! {
    /// An obstacle moves along a curve within an increment: in between it presses a node more deeply than at both ends, or
    /// leaves a node that it touches at both ends. The difference exceeds the indentation. `events`: straight pieces of
    /// curved gaps are off by more than a millionth of the largest displacement.
    CURVED_GAPS("curved-gaps", "More increments, until the obstacle moves by less than the contact width.", "never");
}

/// The depth of an obstacle's passage within an increment above which it is reported, relative to the indentation. For
/// an obstacle that rolls on, the friction is then off by a few percent at most.
const PASSES: f64 = 1.0;

/// The error of gaps, relative to the displacements, above which a warning is given.
const OFF: f64 = 1e-6;

/// The deepest passage of an obstacle within an increment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Passage {
    deepest: Largest<PassedNode>,
    /// The end of the last increment, if the paths of obstacles are checked: its time, s, and its state.
    last: Option<(f64, State)>,
}

impl Check for Passage {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        if model.has_passing_obstacles() {
            let now = (step.record.time, step.state.clone());
            let (time, last) = self.last.replace(now).unwrap_or_else(|| (0.0, State::zero(&model.problem)));
            let found = model.passed_node([time, step.record.time], [&last, step.state]);
            self.deepest.add(step, found.map(|found| (found.distance.abs(), found)));
        }
    }

    fn fits(&self, model: &Model) -> bool {
        let last = self.last.as_ref().is_none_or(|(_, state)| state.check(&model.problem).is_ok());
        last && self.deepest.0.as_ref().is_none_or(|(.., found)| found.contact < model.contact.nodes.len())
    }

    fn warning(&self, model: &Model, so_far: &SoFar) -> Option<Warning> {
        let (depth, time, found) = self.deepest.above(PASSES * so_far.indentation)?;
        let passes = if found.distance < 0.0 { "goes through" } else { "leaves" };
        let place = model.units().point(model.contact.nodes[found.contact].position);
        let (depth, beside) = (model.units().rounded(Quantity::Length, depth, 3), so_far.beside(depth));
        Some(WarningKind::CURVED_GAPS.warning(format!(
            "within the increment that ends at t = {time} s an obstacle {passes} the contact node at {place}, by {depth}, \
             {beside}: friction between the ends of increments is neglected; take more increments"
        )))
    }
}

/// Warns that the exact path followed curved gaps along chords.
pub(super) fn along_chords(Solved { model, outcome, solver, .. }: &Solved<'_>) -> Option<Warning> {
    let off = model.loading.off_the_chords();
    let moved = outcome.state.u.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    if !solver.method.is_exact_path() || off <= OFF * moved {
        return None;
    }
    let (error, share) = (model.units().rounded(Quantity::Length, off, 2), off / moved);
    Some(WarningKind::CURVED_GAPS.warning(format!(
        "gaps in front of a moving obstacle are curved in time, and the exact path follows them along chords, with \
         errors up to {error} ({share:.1e} of the largest displacement); four times as many increments as chords \
         reduce them to a sixteenth"
    )))
}
