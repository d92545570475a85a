//! The rate problem at one place of the path, and what rates break in it.

use serde::{Deserialize, Serialize};

use super::node::{AdmissibleTransition, Given, NodalContact, NodeStatus, largest};
use super::tangent::Tangent;
use crate::algebra::linear::LinearError;
use crate::solver::problem::ContactProblem;

/// A rate that breaks a law by less than this share of the largest is rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// The rate problem at one place of the path.
pub(super) struct RateProblem<'a> {
    pub problem: &'a ContactProblem,
    /// Along which tangent each node slides, if any.
    pub tangents: &'a [Option<usize>],
    pub given: &'a Given,
    pub mu: &'a [f64],
    /// Whether each node has friction.
    pub rough: &'a [bool],
    pub may: &'a [AdmissibleTransition],
}

/// A law that a node's rates break, and the status that would mend it.
pub(super) struct Breach {
    pub node: usize,
    pub to: NodeStatus,
    /// Relative to the largest rate of its kind.
    pub size: f64,
}

/// What it took, over a history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// Rates solved for.
    pub solves: usize,
    /// Places where nodes were changed one by one.
    pub one_by_one: usize,
    /// Places that Lemke's method settled.
    pub lemke: usize,
    /// Places where all statuses were tried.
    pub enumerated: usize,
}

impl RateProblem<'_> {
    /// The largest breach of the rates of these statuses; `None` if they have none.
    pub(super) fn try_out(
        &self,
        tangent: &mut dyn Tangent,
        statuses: &[NodeStatus],
        rate: &mut NodalContact,
        effort: &mut Effort,
    ) -> Result<Option<f64>, LinearError> {
        effort.solves += 1;
        if !(tangent.take(statuses)? && tangent.solve(self.given, rate)?) {
            return Ok(None);
        }
        Ok(Some(self.breaches(statuses, rate).iter().fold(0.0_f64, |m, breach| m.max(breach.size))))
    }

    /// The laws that rates break by more than rounding.
    pub(super) fn breaches(&self, statuses: &[NodeStatus], rate: &NodalContact) -> Vec<Breach> {
        let force = rate.force_scale(self.given);
        let length = rate.largest_displacement().max(largest(&self.given.gap)).max(largest(&self.given.slide));
        let mut breaches = Vec::new();
        for (i, (&status, &may)) in statuses.iter().zip(self.may).enumerate() {
            let slip = rate.w_t[i] - self.given.slide[i];
            let beyond = |sign: f64| sign * rate.p_t[i] - self.mu[i] * rate.p_n[i];
            let along = |sign: f64| if self.rough[i] { NodeStatus::slip(sign) } else { NodeStatus::Forward };
            let (value, scale, to) = match (may, status) {
                (AdmissibleTransition::Anything, NodeStatus::Open) => {
                    (rate.w_n[i] - self.given.gap[i], length, along(slip))
                }
                (AdmissibleTransition::Anything, _) if rate.p_n[i] < -ROUNDING * force => {
                    (-rate.p_n[i], force, NodeStatus::Open)
                }
                (AdmissibleTransition::Stay, _) | (_, NodeStatus::Open) => continue,
                _ if !self.rough[i] => continue,
                (AdmissibleTransition::Anything, NodeStatus::Stick) => {
                    let sign = if rate.p_t[i] < 0.0 { -1.0 } else { 1.0 };
                    (beyond(sign), force, NodeStatus::slip(sign))
                }
                (AdmissibleTransition::Turn(sign), NodeStatus::Stick) => (beyond(sign), force, NodeStatus::slip(sign)),
                (_, NodeStatus::Forward | NodeStatus::Backward) => (-status.sign() * slip, length, NodeStatus::Stick),
            };
            if value > ROUNDING * scale {
                breaches.push(Breach { node: i, to, size: value / scale });
            }
        }
        breaches
    }
}
