//! The status of a contact node, and the statuses that may follow.

use serde::{Deserialize, Serialize};

use crate::algebra::sparse::DoubleDouble;
use crate::base::displayed_as_written;

/// The status of a contact node while the load rates are constant. The rates then obey one linear row for each force
/// of the node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NodeStatus {
    /// Separated from the obstacle: `p_n' = p_t' = 0`.
    #[serde(rename = "open")]
    Open,
    /// In contact without slip: `w_n' = g'`, and `w_t'` equals that of the obstacle.
    #[serde(rename = "stick")]
    Stick,
    /// Sliding in the direction of its tangent: `w_n' = g'`, `p_t' = μ p_n'`. Without friction every closed node
    /// slides.
    #[serde(rename = "slip+")]
    Forward,
    /// Sliding opposite to its tangent: `w_n' = g'`, `p_t' = -μ p_n'`.
    #[serde(rename = "slip-")]
    Backward,
}

impl NodeStatus {
    /// Returns slip along the tangent, or opposite to it if `direction` is negative.
    pub(super) fn slip(direction: f64) -> Self {
        if direction < 0.0 { NodeStatus::Backward } else { NodeStatus::Forward }
    }

    /// Returns `true` if the node touches its obstacle.
    pub fn is_closed(self) -> bool {
        self != NodeStatus::Open
    }

    /// Returns `true` if the tangential displacement is prescribed.
    pub(super) fn is_sticking(self) -> bool {
        self == NodeStatus::Stick
    }

    /// Returns the sign of friction in `p_t = sign μ p_n`, or 0 if this equation does not apply.
    pub fn sign(self) -> f64 {
        match self {
            NodeStatus::Open | NodeStatus::Stick => 0.0,
            NodeStatus::Forward => 1.0,
            NodeStatus::Backward => -1.0,
        }
    }
}

displayed_as_written!(NodeStatus);

/// The statuses that are admissible for a node when the rates change: a set of complementary rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum AdmissibleTransition {
    /// The present status: the node is on no border of a law.
    Stay,
    /// Stick, or slip in the direction of this sign: friction is on the border of the cone.
    Turn(f64),
    /// Every status: the node touches without pressure.
    Anything,
}

/// Contact displacements and forces of all contact nodes, n_c each, and all displacements, n_u, or the rates of these
/// quantities, in the units of the path.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct NodalContact {
    pub w_n: Vec<f64>,
    pub w_t: Vec<f64>,
    pub p_n: Vec<f64>,
    pub p_t: Vec<f64>,
    pub u: Vec<f64>,
    /// The low-order part of `u` in double-double arithmetic; empty where it does not matter.
    pub u_rest: Vec<f64>,
    /// The size of elastic forces that count as rounding.
    pub rounding: f64,
}

impl NodalContact {
    pub(super) fn zero(contacts: usize) -> Self {
        let zeros = || vec![0.0; contacts];
        NodalContact { w_n: zeros(), w_t: zeros(), p_n: zeros(), p_t: zeros(), ..NodalContact::default() }
    }

    /// Returns `self + share other`. The low-order parts of displacements are kept if `self` has them.
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
        for (k, (u, u_rest)) in self.u.iter_mut().zip(&mut self.u_rest).enumerate() {
            let mut sum = DoubleDouble::default();
            sum.add(*u);
            sum.add_product(share, other.u[k]);
            sum.add(*u_rest + share * other.u_rest.get(k).copied().unwrap_or(0.0));
            *u = sum.value();
            sum.add(-*u);
            *u_rest = sum.value();
        }
    }

    /// Returns the largest force.
    pub(super) fn largest_force(&self) -> f64 {
        largest(&self.p_n).max(largest(&self.p_t))
    }

    /// Returns the scale for comparing forces under the `given` data.
    pub(super) fn force_scale(&self, given: &Given) -> f64 {
        self.largest_force().max(largest(&given.force)).max(self.rounding)
    }

    /// Returns the largest displacement.
    pub(super) fn largest_displacement(&self) -> f64 {
        largest(&self.w_n).max(largest(&self.w_t))
    }
}

/// The data at one time, or their rates, in the units of the path.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Given {
    /// External forces, n_u.
    pub force: Vec<f64>,
    /// Gaps, n_c.
    pub gap: Vec<f64>,
    /// Tangential displacements, n_c: of the obstacle in a load, of the sticking nodes in equations.
    pub slide: Vec<f64>,
}

impl Given {
    /// Returns `self + share other`.
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
