//! What a state does to bodies in front of each other.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Model;
use crate::body::contact::{ContactBoundary, Passed};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// A contact node that has slid past the facets that were in front of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slid {
    /// The number of the contact node.
    pub contact: usize,
    /// How far it has slid since the beginning, m.
    pub slip: f64,
    /// The same over the shortest edge of the facets in front of it.
    pub share: f64,
}

/// What the facets of curved boundaries do to the measured gaps of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Faceted {
    /// The number of the pair.
    pub pair: usize,
    /// The sum of the normal forces, N.
    pub force: f64,
    /// By how much gaps between the curved surfaces differ from those between the facets, m: the median of the nodes that are pressed.
    pub bulge: f64,
    /// How large the gaps are that contact has closed, in the mean over the normal forces, m.
    pub closed: f64,
}

impl Model {
    /// What the facets of curved boundaries do to each pair whose gaps are measured and that is pressed.
    pub fn faceted(&self, state: &State) -> Vec<Faceted> {
        let of_pair = |pair: usize| {
            let rows = &self.pairs[pair].mortar.rows;
            if rows.iter().all(|row| row.bulge == 0.0) || !self.pairs[pair].is_measured() {
                return None;
            }
            let (mut force, mut closed, mut bulges) = (0.0, 0.0, Vec::new());
            for (contact, p_n) in self.contacts.iter().zip(&state.p_n).filter(|(_, p_n)| **p_n > 0.0) {
                let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == pair) else { continue };
                force += p_n;
                closed += p_n * contact.facing.gap.abs();
                bulges.push(coupled.bulge.abs());
            }
            // Not the mean: where flats end in a curve, the largest forces are at its first facet, and nothing else of the contact is curved.
            let middle = bulges.len() / 2;
            if bulges.is_empty() {
                return None;
            }
            let bulge = *bulges.select_nth_unstable_by(middle, f64::total_cmp).1;
            Some(Faceted { pair, force, bulge, closed: closed / force })
        };
        (0..self.pairs.len()).filter_map(of_pair).collect()
    }

    /// The share of the largest possible friction of each contact boundary at nodes that supports hold along a direction in which what is in
    /// front moves past them, the largest with the number of the boundary; `mu` are the coefficients of the nodes.
    pub fn friction_left_out(&self, state: &State, mu: &[f64]) -> Option<(usize, f64)> {
        if !self.passed_by.contains(&true) {
            return None;
        }
        let share = |(k, boundary): (usize, &ContactBoundary)| {
            let friction = |i: &usize| mu[*i] * state.p_n[*i];
            let all: f64 = boundary.nodes.iter().map(friction).sum();
            let lost: f64 = boundary.nodes.iter().filter(|i| self.passed_by[**i]).map(friction).sum();
            (k, if all > 0.0 { lost / all } else { 0.0 })
        };
        self.contact_boundaries.iter().enumerate().map(share).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Where a body has come into another, or a boundary into the one in front of it, without a contact row, by the displacements `u` (m).
    pub fn passed(&self, u: &[[f64; 3]]) -> Option<Passed> {
        self.passages.as_ref()?.deepest(&self.mesh, u)
    }

    /// How much the slave of a pair leans at contact node `i` against the direction that is given for it; NaN where none is.
    pub(super) fn slope_in_pair(&self, i: usize) -> f64 {
        let contact = &self.contacts[i];
        let slope = contact.coupled().and_then(|coupled| self.pairs[coupled.pair].slopes.get(&contact.node));
        slope.copied().unwrap_or(f64::NAN)
    }

    /// The share of the normal forces of each pair on nodes beyond the end of the other body, the largest with the number of the pair.
    /// The row of such a node extends the displacement of the other body beyond its end: it presses the nodes at the end with more than the
    /// whole force and pulls those behind them.
    pub fn beyond_the_end(&self, state: &State) -> Option<(usize, f64)> {
        let share = |k: usize| {
            let (mut all, mut beyond) = (0.0, 0.0);
            for (contact, p_n) in self.contacts.iter().zip(&state.p_n) {
                let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == k) else { continue };
                all += p_n;
                beyond += if coupled.beyond_the_end { *p_n } else { 0.0 };
            }
            (k, if all > 0.0 { beyond / all } else { 0.0 })
        };
        (0..self.pairs.len()).map(share).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The closed contact node that has slid furthest past the body in front of it until time `t` (s), by the size of the facets there:
    /// which nodes are in front of it is settled in the undeformed state.
    pub fn slid(&self, t: f64, state: &State, statuses: &[ContactStatus]) -> Option<Slid> {
        let drift = [0, 1].map(|k| self.loading.drift_at(t, k));
        let closed = (0..self.contacts.len()).filter(|&i| statuses[i] != ContactStatus::Open);
        let slid = |i: usize| {
            let coupled = self.contacts[i].coupled()?;
            let [w_t, w_o] = self.problem.tangential_maps().map(|map| map.dot(i, &state.u));
            let slip = (w_t - drift[0][i]).hypot(w_o - drift[1][i]);
            let edge = self.pairs[coupled.pair].edges.get(&self.contacts[i].node)?;
            Some(Slid { contact: i, slip, share: slip / edge })
        };
        closed.filter_map(slid).max_by(|a, b| a.share.total_cmp(&b.share))
    }

    /// The tractions (Pa) of the masters of all pairs on what is in front of them: pairs of a node and a vector.
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
