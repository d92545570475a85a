//! Solutions that are one of many.

use super::prelude::*;
use std::collections::BTreeSet;

use crate::body::constraints::RigidMotion;
use crate::solver::uniqueness::{NeutralMotion, neutral_motions};

kinds! {
    /// The body is free to move although forces balance: its place is one of many. Or one contact node can take over what
    /// others carry, as where glue and contact, two periodic pairs, or two obstacles share nodes: their forces are those
    /// that keep their friction and have the smallest pressures.
    NOT_UNIQUE("not-unique", "A free body: add a support. Shared nodes: [glue or contact, not \
        both](../method/existence.md#contact-rows-that-depend-on-each-other).",
        "only stresses and forces of a free body matter, or only sums over all contacts at shared nodes");
}

/// The first equilibrium whose displacements are not unique.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct NeutralEquilibrium {
    /// Its unconstrained motion and its time, s.
    first: Option<(NeutralMotion, f64)>,
    /// The largest normal force so far, N.
    largest_force: f64,
}

impl Check for NeutralEquilibrium {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        self.largest_force = step.state.p_n.iter().fold(self.largest_force, |most, p| most.max(*p));
        if self.first.is_none() {
            let IncrementView { increment, state, statuses, .. } = *step;
            let motions = neutral_motions(&model.problem, increment, state, statuses, self.largest_force);
            self.first = motions.into_iter().next().map(|motion| (motion, step.record.time));
        }
    }

    fn fits(&self, model: &Model) -> bool {
        let motions = model.constraints.rigid_motions.len();
        self.first.as_ref().is_none_or(|(motion, _)| motion.weights.len() == motions)
    }

    fn warning(&self, model: &Model, _: &SoFar) -> Option<Warning> {
        let (neutral, time) = self.first.as_ref()?;
        let time = six_digits(*time);
        let motion = RigidMotion::combination(&model.constraints.rigid_motions, &neutral.weights)?;
        // The body may move one way only.
        let room = match neutral.room[0].max(neutral.room[1]) {
            0.0 => return None,
            room if room.is_finite() => format!("by up to {}", model.units().rounded(Quantity::Length, room, 3)),
            _ => "by any distance".to_string(),
        };
        Some(WarningKind::NOT_UNIQUE.warning(format!(
            "at t = {time} s contact forces balance the loads, but nothing holds {}: displacements are one of many \
             solutions, which may differ {room} before another node touches, with the same stresses; add a support to \
             make them unique",
            motion.against(&model.units())
        )))
    }
}

/// Warns of contact nodes that touched and whose rows depend on each other.
pub(super) fn shared_forces(Solved { model, checks, .. }: &Solved<'_>) -> Option<Warning> {
    let touched = &checks.so_far.touched;
    let acts = |i: &usize| touched[*i] && !model.problem.c_n().row(*i).is_empty();
    let acting: Vec<usize> = (0..touched.len()).filter(acts).collect();
    let dependent = model.problem.of_nodes(&acting).dependent_nodes();
    let nodes: BTreeSet<usize> = dependent.into_iter().map(|k| model.contact.nodes[acting[k]].node).collect();
    let place = model.units().point(model.mesh.nodes[*nodes.first()?]);
    Some(WarningKind::NOT_UNIQUE.warning(format!(
        "the contact forces at {} nodes, the first at {place}, are not unique, because one contact can take over \
         what others carry: those that keep their friction and have the smallest pressures are told; the sums over \
         all contacts there and the rest of the body do not depend on that",
        nodes.len()
    )))
}
