//! The friction of each contact that is in use, and the times at which it slips.

use serde::{Deserialize, Serialize};

use super::explain::ChangingLoad;
use super::largest::is_as_large;
use super::resultant::{ContactSlip, ForceRecord};
use crate::body::model::Model;

/// The friction of a contact over a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct FrictionUse {
    /// The boundary.
    pub boundary: String,
    /// The largest limit of the friction, `Σ μ p_n`, N. Increments with less than a hundredth of it count as without
    /// friction.
    pub friction_limit: f64,
    /// The largest share in use, `|(Σ p_t, Σ p_o)| / Σ μ p_n`: the contact slips as a whole in one direction at 1.
    pub largest: f64,
    /// The time at which it is in use, s.
    pub time: f64,
    /// The end of the first increment after which some nodes slip, s; `None` if all stick.
    pub slips_from: Option<f64>,
    /// The end of the first increment after which all nodes that touch slip, s.
    pub slips_wholly_from: Option<f64>,
    /// The loads that change at one of these times, with their factors at both; if not all slip, twice that at the first.
    #[serde(default)]
    pub factors: Vec<ChangingLoad>,
    /// The slip at the end.
    pub end: ContactSlip,
}

/// The time before slip at which a load that changes has another factor, as a share of the time since the beginning.
const BEFORE: f64 = 1e-6;

/// A friction limit below this share of the largest one counts as none, as in a fit that is assembled without friction.
const NO_FRICTION: f64 = 0.01;

impl FrictionUse {
    /// Returns it with the loads that change just before some nodes slip, or all.
    pub(super) fn with_factors(&self, model: &Model) -> Self {
        let Some(first) = self.slips_from else { return self.clone() };
        let times = [first, self.slips_wholly_from.unwrap_or(first)];
        let factors = ChangingLoad::all(model, times, &times.map(|t| [t, (1.0 - BEFORE) * t]));
        FrictionUse { factors, ..self.clone() }
    }

    /// Takes the `forces` after an increment over into the records `so_far`.
    pub(super) fn observe(so_far: &mut Vec<Self>, forces: &[ForceRecord]) {
        for ForceRecord { time, resultant, slip_state, friction_used, friction_limit: limit, .. } in forces {
            let (Some(slip), Some(used)) = (*slip_state, *friction_used) else { continue };
            let new = || FrictionUse {
                boundary: resultant.boundary.clone(),
                friction_limit: *limit,
                largest: 0.0,
                time: *time,
                slips_from: None,
                slips_wholly_from: None,
                factors: Vec::new(),
                end: slip,
            };
            let known = so_far.iter().position(|of| of.boundary == resultant.boundary);
            let k = known.unwrap_or(so_far.len());
            if known.is_none() {
                so_far.push(new());
            }
            let of = &mut so_far[k];
            if of.friction_limit < NO_FRICTION * limit {
                *of = new();
            }
            of.friction_limit = of.friction_limit.max(*limit);
            of.end = slip;
            if *limit < NO_FRICTION * of.friction_limit {
                continue;
            }
            if !is_as_large(of.largest, used) {
                (of.largest, of.time) = (used, *time);
            }
            let is_whole = slip == ContactSlip::Whole;
            if is_whole || slip == ContactSlip::Partial {
                of.slips_from.get_or_insert(*time);
            }
            if is_whole {
                of.slips_wholly_from.get_or_insert(*time);
            }
        }
    }
}
