//! The force of each pretension over a history: that of a bolt at its lock, and how it changes.

use serde::{Deserialize, Serialize};

use super::balance::BalanceRecord;
use crate::body::{Pretension, Tightening};

/// The force across a section with a pretension, positive for tension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct PretensionForce {
    /// The name of the pretension.
    pub name: String,
    /// The force when its shortening has become constant, as at its lock, N; `None` if its force is prescribed.
    pub locked_force: Option<f64>,
    /// The least and the largest force from the lock on, or from the first increment, N.
    pub force_range: [f64; 2],
}

impl PretensionForce {
    /// Takes the forces after an increment over into the records `so_far`.
    pub(in crate::run) fn observe(so_far: &mut Vec<Self>, balance: &BalanceRecord, given: &[Pretension]) {
        for (section, given) in balance.pretensions.iter().zip(given) {
            // A pretension that locks has its shortening until then as its history.
            let is_length = matches!(given.tightening, Tightening::Shortening(_));
            let lock = given.history.as_ref().and_then(|history| history.last()).filter(|_| is_length);
            if lock.is_some_and(|[lock, _]| balance.time < *lock) {
                continue;
            }
            let force = section.normal_force;
            match so_far.iter_mut().find(|of| of.name == section.at) {
                Some(of) => of.force_range = [of.force_range[0].min(force), of.force_range[1].max(force)],
                None => so_far.push(PretensionForce {
                    name: section.at.clone(),
                    locked_force: lock.map(|_| force),
                    force_range: [force; 2],
                }),
            }
        }
    }
}
