//! The rate problem at one point of the path, and the laws that given rates break.

use super::node::{AdmissibleTransition, Given, NodalContact, NodeStatus, largest};
use super::tangent::Tangent;
use crate::algebra::linear::Computed;
use crate::solver::problem::ContactProblem;
use serde::{Deserialize, Serialize};

/// A breach of a law below this share of the largest rate counts as rounding.
pub(super) const RATE_ROUNDING: f64 = 1e-12;

/// The rate problem at one point of the path.
#[derive(Clone, Copy)]
pub(super) struct RateProblem<'a> {
    pub problem: &'a ContactProblem,
    /// The tangent along which each node slides, if any.
    pub tangents: &'a [Option<usize>],
    pub given: &'a Given,
    pub mu: &'a [f64],
    /// `true` for each node with friction.
    pub has_friction: &'a [bool],
    pub may: &'a [AdmissibleTransition],
}

/// A law that the rates of a node break, and the status that would correct it.
pub(super) struct Breach {
    pub node: usize,
    pub to: NodeStatus,
    /// The size of the breach, relative to the largest rate of its kind.
    pub size: f64,
}

/// Returns the size of the largest of the `breaches`.
pub(super) fn largest_breach(breaches: &[Breach]) -> f64 {
    breaches.iter().fold(0.0_f64, |m, breach| m.max(breach.size))
}

/// The search for the statuses of a rate problem.
pub(super) struct RateSearch<'a> {
    pub problem: RateProblem<'a>,
    pub tangent: &'a mut dyn Tangent,
    /// The rates of the statuses tried last.
    pub rate: &'a mut NodalContact,
    pub effort: &'a mut Effort,
    /// The statuses with the smallest breach so far.
    pub best: Option<(f64, Vec<NodeStatus>)>,
}

/// The cost of the rate problems of a history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Effort {
    /// The number of solves for rates.
    pub solves: usize,
    /// The number of points at which nodes were changed one by one.
    pub one_by_one: usize,
    /// The number of points that Lemke's method solved.
    pub lemke: usize,
    /// The number of points at which all statuses were tried.
    pub enumerated: usize,
}

impl RateSearch<'_> {
    /// Returns the largest breach of the rates of these statuses, or `None` if they have no rates.
    pub(super) fn try_out(&mut self, statuses: &[NodeStatus]) -> Computed<Option<f64>> {
        let breaches = self.rates(statuses)?.then(|| self.problem.breaches(statuses, self.rate));
        Ok(breaches.map(|breaches| largest_breach(&breaches)))
    }

    /// Computes the rates of these statuses. Returns `true` if they have any.
    pub(super) fn rates(&mut self, statuses: &[NodeStatus]) -> Computed<bool> {
        self.effort.solves += 1;
        Ok(self.tangent.set_statuses(statuses)? && self.tangent.solve(self.problem.given, self.rate)?)
    }

    /// Keeps `statuses` if they are the best so far.
    pub(super) fn keep(&mut self, size: Option<f64>, statuses: &[NodeStatus]) {
        let Some(size) = size else { return };
        if self.best.as_ref().is_none_or(|(least, _)| size < *least) {
            self.best = Some((size, statuses.to_vec()));
        }
    }
}

impl RateProblem<'_> {
    /// Returns the laws that the rates break by more than rounding.
    pub(super) fn breaches(&self, statuses: &[NodeStatus], rate: &NodalContact) -> Vec<Breach> {
        let force = rate.force_scale(self.given);
        let length = rate.largest_displacement().max(largest(&self.given.gap)).max(largest(&self.given.slide));
        let mut breaches = Vec::new();
        for (i, (&status, &may)) in statuses.iter().zip(self.may).enumerate() {
            let slip = rate.w_t[i] - self.given.slide[i];
            let excess = |sign: f64| sign * rate.p_t[i] - self.mu[i] * rate.p_n[i];
            let along = |sign: f64| if self.has_friction[i] { NodeStatus::slip(sign) } else { NodeStatus::Forward };
            let (value, scale, to) = match (may, status) {
                (AdmissibleTransition::Anything, NodeStatus::Open) => {
                    (rate.w_n[i] - self.given.gap[i], length, along(slip))
                }
                (AdmissibleTransition::Anything, _) if rate.p_n[i] < -RATE_ROUNDING * force => {
                    (-rate.p_n[i], force, NodeStatus::Open)
                }
                (AdmissibleTransition::Stay, _) | (_, NodeStatus::Open) => continue,
                _ if !self.has_friction[i] => continue,
                (AdmissibleTransition::Anything, NodeStatus::Stick) => {
                    let sign = if rate.p_t[i] < 0.0 { -1.0 } else { 1.0 };
                    (excess(sign), force, NodeStatus::slip(sign))
                }
                (AdmissibleTransition::Turn(sign), NodeStatus::Stick) => (excess(sign), force, NodeStatus::slip(sign)),
                (_, NodeStatus::Forward | NodeStatus::Backward) => (-status.sign() * slip, length, NodeStatus::Stick),
            };
            if value > RATE_ROUNDING * scale {
                breaches.push(Breach { node: i, to, size: value / scale });
            }
        }
        breaches
    }
}
