//! What a state does to bodies in front of each other.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Model;
use crate::contact::ContactStatus;
use crate::problem::State;

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

/// A row with a larger coefficient of a master node is that of a node beyond the end of the master: functions that only overlap
/// stay below.
const BEYOND: f64 = 1.25;

impl Model {
    /// How much the slave of a pair leans at contact node `i` against the direction that is given for it; NaN where none is.
    pub(super) fn slope_in_pair(&self, i: usize) -> f64 {
        let contact = &self.contacts[i];
        let slope = contact.coupled().and_then(|coupled| self.pairs[coupled.pair].slopes.get(&contact.node));
        slope.copied().unwrap_or(f64::NAN)
    }

    /// The share of the normal forces of each pair on nodes beyond the end of the other body, the largest with the number of the pair.
    /// There a row holds nodes of the other body with more than the whole of the force and others that are pulled, so that the force acts
    /// where the node is.
    pub fn beyond_the_end(&self, state: &State) -> Option<(usize, f64)> {
        let share = |k: usize| {
            let (mut all, mut beyond) = (0.0, 0.0);
            for (contact, p_n) in self.contacts.iter().zip(&state.p_n) {
                let Some(coupled) = contact.coupled().filter(|coupled| coupled.pair == k) else { continue };
                let largest = coupled.master.iter().fold(0.0_f64, |m, (.., c)| m.max(-c));
                all += p_n;
                beyond += if largest > BEYOND { *p_n } else { 0.0 };
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
    pub(crate) fn master_tractions(&self, state: &State) -> Vec<(usize, [f64; 3])> {
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
