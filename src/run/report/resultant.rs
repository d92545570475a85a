//! The resultants of the contact forces.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::balance::about_axes;
use crate::body::contact::ContactBoundary;
use crate::body::model::{Model, Wrench};
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// The force of the body on the obstacles, or on the opposing body, in front of one boundary: the sum of the contact
/// forces, and of their components. A node of several boundaries contributes to each by its share in the node's area.
/// With several boundaries, or an obstacle with a normal for each node, normals and tangents have different directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Resultant {
    /// The boundary.
    pub boundary: String,
    /// The force of the body on the obstacle: x, y and, in three dimensions, z, N; in two dimensions N per m of depth.
    pub force: Vec<f64>,
    /// The moment of the force about the origin, at the reference positions of the nodes: about z in two dimensions,
    /// about x, y and z in three, N m; in two dimensions N m per m of depth.
    pub moment: Vec<f64>,
    /// The sums of the components.
    #[serde(flatten)]
    pub sums: ComponentSums,
    /// The part on each obstacle, if there are several in front of the boundary.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<OnObstacle>,
    /// The force of the opposing body, if there is one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opposite: Option<OfOpposite>,
}

/// The force of the opposing body on the body of a boundary.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct OfOpposite {
    /// The opposing boundary.
    pub boundary: String,
    /// The force of the opposing body, with components as above.
    pub force: Vec<f64>,
    /// The moment, as above, at the nodes of this side. Across a gap, the friction has a different moment here.
    pub moment: Vec<f64>,
}

/// The force of the nodes of one boundary on one of the obstacles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct OnObstacle {
    /// The obstacle, by its key: `contact[0].obstacle[1]`.
    pub obstacle: String,
    /// The force of the body on the obstacle, with components as above.
    pub force: Vec<f64>,
    /// The moment of the force, as above.
    pub moment: Vec<f64>,
    /// The sums of the components.
    #[serde(flatten)]
    pub sums: ComponentSums,
}

/// Sums of the components of contact forces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct ComponentSums {
    /// `Σ p_n`, N.
    pub sum_p_n: f64,
    /// `Σ p_t`, N, along the first tangent of the obstacle.
    pub sum_p_t: f64,
    /// `Σ p_o`, N, along the second; only in three dimensions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sum_p_o: Option<f64>,
}

/// The resultant of a boundary at the end of an increment.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct ForceRecord {
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The resultant.
    #[serde(flatten)]
    pub resultant: Resultant,
    /// The slip of a boundary with friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip_state: Option<ContactSlip>,
    /// The share of its friction in use, the magnitude of `tangential` by `Σ μ p_n`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_used: Option<f64>,
    /// `Σ μ p_n`, N.
    #[serde(skip)]
    pub(super) friction_limit: f64,
    /// `Σ p_t` and `Σ p_o`, N; for a body of revolution without radial forces, which have no resultant.
    #[serde(skip)]
    pub(super) tangential: [f64; 2],
}

/// The slip of a contact with friction at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ContactSlip {
    /// No node touches.
    Open,
    /// All nodes that touch stick.
    Stick,
    /// Some nodes stick, others slip.
    Partial,
    /// All nodes that touch slip.
    Whole,
}

impl Resultant {
    /// Returns the resultants of a `state` at time `t` (s), one for each boundary with contact.
    pub fn all(model: &Model, t: f64, state: &State) -> Vec<Self> {
        model.contact.boundaries.iter().map(|boundary| Resultant::of(model, t, state, boundary)).collect()
    }

    fn of(model: &Model, t: f64, state: &State, boundary: &ContactBoundary) -> Self {
        let (force, moment, sums) = total(model, state, boundary.shares(&model.contact.nodes));
        let name = boundary.name.clone();
        let obstacles = OnObstacle::all(model, t, state, boundary);
        Resultant { boundary: name, force, moment, sums, obstacles, opposite: OfOpposite::of(model, state, boundary) }
    }
}

impl OfOpposite {
    fn of(model: &Model, state: &State, boundary: &ContactBoundary) -> Option<Self> {
        let name = model.contact.pairs[boundary.pair?].master.name.clone();
        let (force, moment) = wrench(model, state, boundary.shares(&model.contact.nodes), true);
        Some(OfOpposite { boundary: name, force, moment })
    }
}

impl OnObstacle {
    /// Returns the resultant on each obstacle in front of `boundary`, and on each other obstacle that a node shared
    /// with another boundary meets; empty if there is only one obstacle.
    fn all(model: &Model, t: f64, state: &State, boundary: &ContactBoundary) -> Vec<Self> {
        if boundary.obstacles.len() < 2 {
            return Vec::new();
        }
        let assigned_to = |i: usize| model.assigned(i, t).map(|(k, _)| k);
        let assigned = boundary.nodes.iter().filter_map(|&i| assigned_to(i));
        let on = |k: usize| {
            let parts = boundary.shares(&model.contact.nodes).filter(|(i, _)| assigned_to(*i) == Some(k));
            let (force, moment, sums) = total(model, state, parts);
            OnObstacle { obstacle: model.obstacle_key(k), force, moment, sums }
        };
        boundary.obstacles.clone().chain(assigned).collect::<BTreeSet<_>>().into_iter().map(on).collect()
    }
}

/// Returns force, moment and sums over contact nodes, each weighted with its share.
fn total(
    model: &Model,
    state: &State,
    parts: impl Iterator<Item = (usize, f64)> + Clone,
) -> (Vec<f64>, Vec<f64>, ComponentSums) {
    let (force, moment) = wrench(model, state, parts.clone(), false);
    (force, moment, ComponentSums::of(model, state, parts))
}

/// Returns the force and the moment of the contact nodes' own body on the other side, or with `opposite` those of the
/// other body.
fn wrench(
    model: &Model,
    state: &State,
    parts: impl Iterator<Item = (usize, f64)>,
    opposite: bool,
) -> (Vec<f64>, Vec<f64>) {
    let geometry = model.mesh.geometry;
    let of_row = |(i, part): (usize, f64)| {
        let forces = model.forces_of_rows(state, i).filter(move |(term, _)| term.opposite == opposite);
        forces.map(move |(term, force)| Wrench::at(geometry, term.position, force.map(|f| part * f)))
    };
    let Wrench { force, moment } = parts.flat_map(of_row).sum();
    let components = model.mesh.components();
    (force[..components].to_vec(), about_axes(moment, components))
}

impl ComponentSums {
    /// Returns the sums over contact nodes, each weighted with its share.
    pub(in crate::run) fn of(model: &Model, state: &State, parts: impl Iterator<Item = (usize, f64)>) -> Self {
        let mut sums = [0.0; 3];
        for (i, part) in parts {
            let [p_t, p_o] = model.contact.nodes[i].in_frame([state.p_t[i], state.p_o[i]]);
            sums.iter_mut().zip([state.p_n[i], p_t, p_o]).for_each(|(sum, p)| *sum += part * p);
        }
        let [sum_p_n, sum_p_t, sum_p_o] = sums;
        ComponentSums { sum_p_n, sum_p_t, sum_p_o: (model.mesh.components() == 3).then_some(sum_p_o) }
    }
}

impl ContactSlip {
    /// Returns the slip of a `boundary` after a step, the limit of its friction, N, and the tangential resultant; `None`
    /// without friction.
    fn of(model: &Model, step: &IncrementView<'_>, boundary: &ContactBoundary) -> Option<(Self, f64, [f64; 2])> {
        let (mut sticks, mut slips, mut most, mut has_friction) = (false, false, 0.0, false);
        let mut tangential = [0.0; 2];
        for (i, part) in boundary.shares(&model.contact.nodes).filter(|(i, _)| step.increment.mu[*i] > 0.0) {
            let contact = &model.contact.nodes[i];
            // A node on the axis of a body of revolution, or between supports, cannot slide.
            if contact.tangents.iter().all(Vec::is_empty) {
                continue;
            }
            has_friction = true;
            sticks |= step.statuses[i] == ContactStatus::Stick;
            slips |= step.statuses[i] == ContactStatus::Slip;
            most += part * step.increment.mu[i] * step.state.p_n[i].max(0.0);
            let along = if model.mesh.geometry.is_revolved() { contact.frame[0][1] } else { 1.0 };
            let [p_t, p_o] = contact.in_frame([step.state.p_t[i], step.state.p_o[i]]);
            tangential = [tangential[0] + part * along * p_t, tangential[1] + part * p_o];
        }
        let slip = match (sticks, slips) {
            (false, false) => ContactSlip::Open,
            (true, false) => ContactSlip::Stick,
            (true, true) => ContactSlip::Partial,
            (false, true) => ContactSlip::Whole,
        };
        has_friction.then_some((slip, most, tangential))
    }
}

/// A sum of forces is rounding, or an error that the laws tolerate, below this share of the normal forces at the nodes, as
/// around a shaft in its hub.
pub(super) const NO_RESULTANT: f64 = 1e-10;

impl ForceRecord {
    /// Returns the records of a step, one for each boundary with contact.
    pub fn all(model: &Model, step: &IncrementView<'_>) -> Vec<Self> {
        let (index, time) = (step.record.index, step.record.time);
        let record = |boundary: &ContactBoundary| {
            let resultant = Resultant::of(model, time, step.state, boundary);
            let slip = ContactSlip::of(model, step, boundary);
            let used = |[t, o]: [f64; 2], limit: f64| Some(t.hypot(o) / limit).filter(|share| *share > NO_RESULTANT);
            let (slip_state, friction_used) =
                slip.map(|(slip, limit, sum)| (slip, used(sum, limit).unwrap_or(0.0))).unzip();
            let (_, friction_limit, tangential) = slip.unwrap_or((ContactSlip::Open, 0.0, [0.0; 2]));
            ForceRecord { index, time, resultant, slip_state, friction_used, friction_limit, tangential }
        };
        model.contact.boundaries.iter().map(record).collect()
    }
}
