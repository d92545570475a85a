//! The state of every contact node at the end of an increment.

use std::ops::Range;

use serde::Serialize;

use super::csv;
use crate::contact::{ContactBoundary, ContactStatus};
use crate::history::Step;
use crate::model::Model;

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

/// The contact nodes of one boundary, in order.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLine {
    /// The boundary, if the scene has contact on several.
    pub boundary: Option<String>,
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// One point a node.
    pub points: Vec<ContactPoint>,
}

impl ContactLine {
    /// The contact lines of a step, one for each boundary with contact.
    pub fn all(model: &Model, step: &Step<'_>) -> Vec<Self> {
        let several = model.contact_boundaries.len() > 1;
        let line = |boundary: &ContactBoundary| ContactLine {
            boundary: several.then(|| boundary.name.clone()),
            index: step.record.index,
            time: step.record.time,
            points: points(model, boundary.nodes.clone(), step),
        };
        model.contact_boundaries.iter().map(line).collect()
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

fn points(model: &Model, nodes: Range<usize>, step: &Step<'_>) -> Vec<ContactPoint> {
    let (problem, state) = (&model.problem, step.state);
    let mut s = 0.0;
    let mut last: Option<[f64; 2]> = None;
    let point = |i: usize| {
        let [x, y, _] = model.contacts[i].position;
        s += last.replace([x, y]).map_or(0.0, |[x0, y0]| (x - x0).hypot(y - y0));
        let (p_n, p_t, l) = (state.p_n[i], state.p_t[i], problem.weight[i]);
        ContactPoint {
            x,
            y,
            s,
            p_n,
            p_t,
            sigma_n: p_n / l,
            sigma_t: p_t / l,
            w_n: problem.c_n.dot(i, &state.u),
            w_t: problem.c_t.dot(i, &state.u),
            mu: problem.mu[i],
            status: step.statuses[i],
        }
    };
    nodes.map(point).collect()
}
