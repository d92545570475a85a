//! What a contact node does, and what it may do next.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::algebra::sparse::DoubleDouble;

/// What a contact node does while the loads go on at one rate. Its rates then obey one linear row for each of its forces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NodeStatus {
    /// Apart from the obstacle: `p_n' = p_t' = 0`.
    #[serde(rename = "open")]
    Open,
    /// In contact without slip: `w_n' = g'`, `w_t'` is that of the obstacle.
    #[serde(rename = "stick")]
    Stick,
    /// Sliding along its tangent: `w_n' = g'`, `p_t' = μ p_n'`. Without friction every closed node slides.
    #[serde(rename = "slip+")]
    Forward,
    /// Sliding against its tangent: `w_n' = g'`, `p_t' = -μ p_n'`.
    #[serde(rename = "slip-")]
    Backward,
}

impl NodeStatus {
    /// Slip along the tangent, or against it where `way` is below 0.
    pub(super) fn slip(way: f64) -> Self {
        if way < 0.0 { NodeStatus::Backward } else { NodeStatus::Forward }
    }

    /// Whether the node touches its obstacle.
    pub fn is_closed(self) -> bool {
        self != NodeStatus::Open
    }

    /// Whether its tangential displacement is given.
    pub(super) fn is_held(self) -> bool {
        self == NodeStatus::Stick
    }

    /// The sign of its friction in `p_t = sign μ p_n`; 0 where that is not so.
    pub fn sign(self) -> f64 {
        match self {
            NodeStatus::Open | NodeStatus::Stick => 0.0,
            NodeStatus::Forward => 1.0,
            NodeStatus::Backward => -1.0,
        }
    }
}

impl fmt::Display for NodeStatus {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NodeStatus::Open => "open",
            NodeStatus::Stick => "stick",
            NodeStatus::Forward => "slip+",
            NodeStatus::Backward => "slip-",
        })
    }
}

/// What a node may do when the rates change: a set of complementary rates that its place among the laws leaves open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum AdmissibleTransition {
    /// What it does: it is off the borders of all laws.
    Stay,
    /// Stick or slip in the direction of this sign: its friction is on the border of the cone.
    Turn(f64),
    /// All: it touches without pressure.
    Anything,
}

/// Contact displacements and forces of all contact nodes, n_c each, and all displacements, n_u, or their rates, in the units of the
/// walk.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct NodalContact {
    pub w_n: Vec<f64>,
    pub w_t: Vec<f64>,
    pub p_n: Vec<f64>,
    pub p_t: Vec<f64>,
    pub u: Vec<f64>,
    /// What rounding takes off `u`; empty where it does not matter.
    pub u_rest: Vec<f64>,
    /// Elastic forces of this size are rounding.
    pub rounding: f64,
}

impl NodalContact {
    pub(super) fn zero(contacts: usize) -> Self {
        let zeros = || vec![0.0; contacts];
        NodalContact { w_n: zeros(), w_t: zeros(), p_n: zeros(), p_t: zeros(), ..NodalContact::default() }
    }

    /// `self + share other`; displacements keep what rounding takes off them, if they have kept it so far.
    pub(super) fn add(&mut self, share: f64, other: &NodalContact) {
        let plus = |to: &mut [f64], by: &[f64]| to.iter_mut().zip(by).for_each(|(to, by)| *to += share * by);
        plus(&mut self.w_n, &other.w_n);
        plus(&mut self.w_t, &other.w_t);
        plus(&mut self.p_n, &other.p_n);
        plus(&mut self.p_t, &other.p_t);
        if self.u_rest.is_empty() && other.u_rest.is_empty() {
            plus(&mut self.u, &other.u);
            return;
        }
        self.u_rest.resize(self.u.len(), 0.0);
        for (k, (u, rest)) in self.u.iter_mut().zip(&mut self.u_rest).enumerate() {
            let mut sum = DoubleDouble::default();
            sum.add(*u);
            sum.add_product(share, other.u[k]);
            sum.add(*rest + share * other.u_rest.get(k).copied().unwrap_or(0.0));
            *u = sum.value();
            sum.add(-*u);
            *rest = sum.value();
        }
    }

    /// The largest force.
    pub(super) fn largest_force(&self) -> f64 {
        largest(&self.p_n).max(largest(&self.p_t))
    }

    /// What forces are compared with under what is `given`.
    pub(super) fn force_scale(&self, given: &Given) -> f64 {
        self.largest_force().max(largest(&given.force)).max(self.rounding)
    }

    /// The largest displacement.
    pub(super) fn largest_displacement(&self) -> f64 {
        largest(&self.w_n).max(largest(&self.w_t))
    }
}

/// What is given at a time, or the rates of it, in the units of the walk.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Given {
    /// External forces, n_u.
    pub force: Vec<f64>,
    /// Gaps, n_c.
    pub gap: Vec<f64>,
    /// Tangential displacements: of the obstacle in a load, of the sticking nodes in equations; n_c.
    pub slide: Vec<f64>,
}

impl Given {
    /// `self + share other`.
    pub(super) fn plus(&self, share: f64, other: &Given) -> Given {
        let plus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + share * b).collect();
        Given {
            force: plus(&self.force, &other.force),
            gap: plus(&self.gap, &other.gap),
            slide: plus(&self.slide, &other.slide),
        }
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| m.max(v.abs()))
}
