//! The state of every contact node at the end of an increment.

use serde::Serialize;

use super::csv;
use crate::contact::{ContactNode, ContactStatus};
use crate::history::Step;
use crate::problem::ContactProblem;

/// One contact node at the end of an increment, SI.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ContactPoint {
    /// Position, m.
    pub x: f64,
    /// Position, m.
    pub y: f64,
    /// Distance along the contact boundary from its first node, m.
    pub s: f64,
    /// Normal contact force, N per unit depth, positive in compression.
    pub p_n: f64,
    /// Tangential contact force, N per unit depth: of the body on the obstacle, along the positive
    /// tangent.
    pub p_t: f64,
    /// Normal contact stress `p_n / l` (32), Pa.
    pub sigma_n: f64,
    /// Tangential contact stress `p_t / l` (32), Pa.
    pub sigma_t: f64,
    /// Normal contact displacement, m, positive towards the obstacle.
    pub w_n: f64,
    /// Tangential contact displacement, m.
    pub w_t: f64,
    /// Friction coefficient.
    pub mu: f64,
    /// What the node does.
    pub status: ContactStatus,
}

/// The contact nodes in order.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLine {
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// One point a node.
    pub points: Vec<ContactPoint>,
}

impl ContactLine {
    /// The contact line of a step.
    pub fn new(problem: &ContactProblem, contacts: &[ContactNode], step: &Step<'_>) -> Self {
        let mut s = 0.0;
        let mut last: Option<[f64; 2]> = None;
        let points = contacts.iter().enumerate().map(|(i, contact)| {
            let [x, y] = contact.position;
            s += last.replace([x, y]).map_or(0.0, |[x0, y0]| (x - x0).hypot(y - y0));
            let (p_n, p_t, l) = (step.state.p_n[i], step.state.p_t[i], problem.weight[i]);
            ContactPoint {
                x,
                y,
                s,
                p_n,
                p_t,
                sigma_n: p_n / l,
                sigma_t: p_t / l,
                w_n: problem.c_n.dot(i, &step.state.u),
                w_t: problem.c_t.dot(i, &step.state.u),
                mu: problem.mu[i],
                status: step.statuses[i],
            }
        });
        ContactLine { index: step.record.index, time: step.record.time, points: points.collect() }
    }

    /// As CSV, SI units.
    pub fn to_csv(&self) -> String {
        csv::table(
            &["x", "y", "p_n", "p_t", "sigma_n", "sigma_t", "w_n", "w_t", "status"],
            self.points.iter().map(|p| {
                let numbers = [p.x, p.y, p.p_n, p.p_t, p.sigma_n, p.sigma_t, p.w_n, p.w_t];
                let status = match p.status {
                    ContactStatus::Open => "open",
                    ContactStatus::Stick => "stick",
                    ContactStatus::Slip => "slip",
                };
                numbers.iter().map(ToString::to_string).chain([status.to_string()]).collect()
            }),
        )
    }
}
