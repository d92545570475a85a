//! Checks of pairs of boundaries in a state.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Model;
use crate::body::contact::{ContactBoundary, Passed};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// Facets whose bulge is smaller than this share of the size of the mesh are flat: coordinates are rounded.
const FLAT: f64 = 1e-12;

/// A contact node that has slid past the facets that were in front of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slid {
    /// The number of the contact node.
    pub contact: usize,
    /// The slip since the beginning, m.
    pub slip: f64,
    /// The slip divided by the shortest edge of the facets in front of the node.
    pub share: f64,
}

/// The error of measured gaps of a pair if facets that count as apart, because they turn so much, are of one curved surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Faceted {
    /// The number of the pair.
    pub pair: usize,
    /// The sum of the normal forces, N.
    pub force: f64,
    /// The reduction of the gaps by curved surfaces, m: the mean, weighted by the normal forces; without a force over the nodes at
    /// which curved surfaces overlap at the beginning.
    pub bulge: f64,
    /// The overlap at the beginning in the same mean, m; negative where contact has closed gaps.
    pub closed: f64,
}

impl Model {
    /// Returns the error by facets for each pressed pair with measured gaps.
    pub fn faceted(&self, state: &State) -> Vec<Faceted> {
        let of_pair = |pair: usize| {
            let (mut by_force, mut without) = ([0.0; 3], [0.0; 3]);
            for (contact, p_n) in self.contacts.iter().zip(&state.p_n) {
                let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == pair) else { continue };
                let gap = contact.facing.gap;
                // Facets may hold nodes apart that the curved surfaces press.
                let overlaps = if gap < coupled.edges { 1.0 } else { 0.0 };
                for (sums, weight) in [(&mut by_force, p_n.max(0.0)), (&mut without, overlaps)] {
                    let terms = [1.0, coupled.edges, -gap];
                    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += weight * term);
                }
            }
            let [weight, bulge, closed] = if by_force[0] > 0.0 { by_force } else { without };
            let differs = bulge.abs() > FLAT * self.mesh.size() * weight;
            differs.then(|| Faceted { pair, force: by_force[0], bulge: bulge / weight, closed: closed / weight })
        };
        (0..self.pairs.len()).filter_map(of_pair).collect()
    }

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

    /// Returns the largest share, over all pairs, of the normal force on nodes beyond the end of the other body, with
    /// the number of the pair.
    ///
    /// The row of such a node extrapolates the displacement of the other body beyond its end: it presses the nodes at
    /// the end with more than the whole force and pulls the nodes behind them.
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

    /// Returns the closed contact node with the largest slip until time `t` (s) relative to the size of the facets in
    /// front of it. The nodes in front of a contact node are determined in the undeformed state.
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
