//! Checks of pairs of boundaries in a state.

use std::collections::BTreeMap;

use super::Model;
use crate::body::contact::{ContactBoundary, Passed};
use crate::solver::problem::State;

impl Model {
    /// Returns the largest share of missing friction of the contact boundaries, with the number of the boundary.
    ///
    /// The share is that of the possible friction at nodes that supports hold along a direction in which the opposite
    /// side moves past them, and at those to which a method gives none; `mu` are the friction coefficients of the nodes.
    pub fn friction_left_out(&self, state: &State, mu: &[f64]) -> Option<(usize, f64)> {
        let own = if self.loading.friction().is_none() { self.problem.mu() } else { mu };
        let lacks = |i: &usize| self.passed_by[*i] || mu[*i] < own[*i];
        if !(0..mu.len()).any(|i| lacks(&i)) {
            return None;
        }
        let share = |(k, boundary): (usize, &ContactBoundary)| {
            let friction = |i: &usize| own[*i] * state.p_n[*i];
            let all: f64 = boundary.nodes.iter().map(friction).sum();
            let lost: f64 = boundary.nodes.iter().filter(|i| lacks(i)).map(friction).sum();
            (k, if all > 0.0 { lost / all } else { 0.0 })
        };
        self.contact_boundaries.iter().enumerate().map(share).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns the place where a body has entered another, or a boundary the one in front of it, without a contact row,
    /// for the displacements `u` (m).
    pub fn passed(&self, u: &[[f64; 3]]) -> Option<Passed> {
        self.passages.as_ref()?.deepest(&self.mesh, u)
    }

    /// Returns the slope of the slave of a pair at contact node `i` relative to the given direction; NaN if none is
    /// given.
    pub(super) fn slope_in_pair(&self, i: usize) -> f64 {
        let contact = &self.contacts[i];
        let slope = contact.coupled().and_then(|coupled| self.pairs[coupled.pair].slopes.get(&contact.node));
        slope.copied().unwrap_or(f64::NAN)
    }

    /// Returns the tractions (Pa) of the masters of all pairs on their slaves, as pairs of a node and a vector.
    pub fn master_tractions(&self, state: &State) -> Vec<(usize, [f64; 3])> {
        let mut all = Vec::new();
        for (k, pair) in self.pairs.iter().enumerate().filter(|(_, pair)| !pair.glued) {
            let own = (0..self.contacts.len()).filter(|&i| self.contacts[i].coupled().is_some_and(|own| own.pair == k));
            let forces: BTreeMap<usize, [f64; 3]> =
                own.map(|i| (self.contacts[i].node, self.contact_force(state, i))).collect();
            let of_rows = pair.mortar.rows.iter().map(|row| forces.get(&row.node).copied().unwrap_or_default());
            all.extend(pair.mortar.on_master(&self.mesh, &of_rows.collect::<Vec<_>>()));
        }
        all
    }
}
