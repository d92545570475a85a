//! Fretting in one load cycle: slip, friction work and the changes of the contact stresses at each contact node, and the
//! friction work of the cycles before.

mod find;
mod node;
mod table;

use serde::{Deserialize, Serialize};

pub use find::last_cycles;
pub use node::CycleNode;
use node::NodeWatch;
#[cfg(test)]
pub(super) use table::names;

use super::contact_line::points;
use crate::body::description::{CycleChoice, CycleRequest};
use crate::body::model::Model;
use crate::solver::history::{IncrementView, Status};
use crate::solver::laws::ContactStatus;

/// The slip of a contact surface in a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SlipRegime {
    /// No node slips.
    Stick,
    /// Nodes slip while others stick.
    PartialSlip,
    /// At some time all closed nodes of a boundary slip.
    GrossSlip,
}

/// The results of a load cycle.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct CycleReport {
    /// The time of its beginning, s.
    pub start: f64,
    /// The time of its end, s.
    pub end: f64,
    /// The friction work of the cycle, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The cycles before it, the first one first.
    pub earlier: Vec<CycleWork>,
    /// The change of the friction work from the cycle before, as a share of it; none without such a cycle, or if one of the two
    /// had no friction work.
    pub change: Option<f64>,
    /// The slip of all contact surfaces together.
    pub regime: SlipRegime,
    /// Each boundary with friction.
    pub boundaries: Vec<CycleOfBoundary>,
    /// The nodes of these boundaries.
    #[serde(skip)]
    pub nodes: Vec<CycleNode>,
}

/// The friction work of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct CycleWork {
    /// The time of its beginning, s.
    pub start: f64,
    /// The time of its end, s.
    pub end: f64,
    /// The friction work, J; in two dimensions J per m of depth.
    pub friction_work: f64,
}

/// A boundary in a cycle.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct CycleOfBoundary {
    /// The boundary.
    pub boundary: String,
    /// Its slip.
    pub regime: SlipRegime,
    /// The friction work of its nodes, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The largest slip range of a node, m.
    pub slip_range: f64,
    /// The largest net slip of a node from the beginning to the end of the cycle, m: with each cycle, the bodies move past
    /// each other by so much.
    pub slip_net: f64,
}

/// Collects the data of a cycle during a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CycleWatch {
    /// The cycles, in order; the last one is examined.
    cycles: Vec<CycleWork>,
    wear_coefficient: Option<f64>,
    /// `true` along an exact path: within an increment forces and slip are nearly proportional, and a node that sticks at the
    /// end may have slipped. Otherwise the force at the end of an increment belongs to all of its slip.
    follows_path: bool,
    /// The end of the last increment, s.
    time: f64,
    nodes: Vec<NodeWatch>,
    /// For each boundary with contact: whether any node slipped in the cycle, and whether all closed nodes did at once.
    slips: Vec<[bool; 2]>,
}

impl CycleWatch {
    /// Begins with the first increment of `model`, whose increments end at `times` (s). Returns `None` if the last change
    /// of the loads ends no cycle.
    pub fn new(model: &Model, times: &[f64], request: &CycleRequest, follows_path: bool) -> Option<Self> {
        let cycles = match request.choice {
            CycleChoice::Last => last_cycles(&model.loading, times),
            CycleChoice::Between([start, end]) => find::repeated(&model.loading, [start, end], times.len()),
        };
        let cycles =
            cycles.into_iter().map(|[start, end]| CycleWork { start, end, friction_work: 0.0 }).collect::<Vec<_>>();
        (!cycles.is_empty()).then(|| CycleWatch {
            cycles,
            wear_coefficient: request.wear_coefficient,
            follows_path,
            time: 0.0,
            nodes: vec![NodeWatch::default(); model.contact.nodes.len()],
            slips: vec![[false; 2]; model.contact.boundaries.len()],
        })
    }

    /// Returns `true` if the data, restored from another run, fits `model`.
    pub fn fits(&self, model: &Model) -> bool {
        self.nodes.len() == model.contact.nodes.len() && self.slips.len() == model.contact.boundaries.len()
    }

    fn cycle(&self) -> Option<&CycleWork> {
        self.cycles.last()
    }

    /// Returns the position of a time (s): before the cycle or at its beginning, in it or at its end, or behind it.
    fn phase(&self, time: f64) -> Phase {
        let Some(CycleWork { start, end, .. }) = self.cycle() else { return Phase::After };
        let slack = find::SAME_TIME * end;
        match time {
            t if t <= start + slack => Phase::Before,
            t if t <= end + slack => Phase::Within,
            _ => Phase::After,
        }
    }

    /// Examines the end of a substep of an increment, except the last.
    pub fn substep(&mut self, model: &Model, part: &IncrementView<'_>) {
        if self.phase(part.record.time) == Phase::Within {
            self.nodes(model, part);
        }
    }

    /// Examines the end of an increment. Increments that did not converge are ignored.
    pub fn observe(&mut self, model: &Model, step: &IncrementView<'_>) {
        let record = step.record;
        if record.status != Status::Converged {
            return;
        }
        for CycleWork { start, end, friction_work } in &mut self.cycles {
            let shared = record.time.min(*end) - self.time.max(*start);
            *friction_work += record.friction_work * (shared / (record.time - self.time)).max(0.0);
        }
        self.time = record.time;
        match self.phase(record.time) {
            Phase::Before => {
                let points = points(model, 0..model.contact.nodes.len(), step);
                self.nodes = points.iter().map(NodeWatch::at).collect();
            }
            Phase::Within => self.nodes(model, step),
            Phase::After => {}
        }
    }

    fn nodes(&mut self, model: &Model, step: &IncrementView<'_>) {
        let points = points(model, 0..model.contact.nodes.len(), step);
        for (i, (node, point)) in self.nodes.iter_mut().zip(&points).enumerate() {
            if self.follows_path {
                node.observe_path(point);
            } else {
                let [t, o] = model.problem.slip(step.increment, step.state, i);
                node.observe(point, step.state.p_t[i] * t + step.state.p_o[i] * o);
            }
        }
        for ([some, all], boundary) in self.slips.iter_mut().zip(&model.contact.boundaries) {
            let slides = |i: &&usize| !model.contact.nodes[**i].tangents[0].is_empty();
            let of = |status| boundary.nodes.iter().filter(slides).any(|&i| step.statuses[i] == status);
            *some |= of(ContactStatus::Slip);
            *all |= of(ContactStatus::Slip) && !of(ContactStatus::Stick);
        }
    }

    /// Returns the results of the cycle; `None` if the history ended before it.
    pub fn report(&self, model: &Model) -> Option<CycleReport> {
        let CycleWork { start, end, friction_work: work } = *self.cycle()?;
        if self.time < end - find::SAME_TIME * end {
            return None;
        }
        let earlier = &self.cycles[..self.cycles.len() - 1];
        let with_friction = |b: &usize| {
            let nodes = &model.contact.boundaries[*b].nodes;
            nodes.iter().any(|&i| !model.contact.nodes[i].tangents[0].is_empty())
        };
        let boundaries: Vec<usize> = (0..model.contact.boundaries.len()).filter(with_friction).collect();
        let regimes = boundaries.iter().map(|&b| self.regime(model, b));
        let regime = regimes.max_by_key(|regime| *regime as usize).unwrap_or(SlipRegime::Stick);
        // Without slip, the work of friction is rounding.
        let work = if regime == SlipRegime::Stick { 0.0 } else { work };
        let before = earlier.last().map(|before| before.friction_work).filter(|before| *before > 0.0 && work > 0.0);
        Some(CycleReport {
            start,
            end,
            friction_work: work,
            earlier: earlier.to_vec(),
            change: before.map(|before| work / before - 1.0),
            regime,
            boundaries: boundaries.iter().map(|&b| self.boundary(model, b)).collect(),
            nodes: boundaries.iter().flat_map(|&b| self.of_nodes(model, b)).collect(),
        })
    }

    /// Returns the slip of boundary `b`. Nodes with the status slip that do not move stick.
    fn regime(&self, model: &Model, b: usize) -> SlipRegime {
        let moves = model.contact.boundaries[b].nodes.iter().any(|&i| self.nodes[i].slip_range() > 0.0);
        if moves { SlipRegime::of(self.slips[b]) } else { SlipRegime::Stick }
    }

    fn boundary(&self, model: &Model, b: usize) -> CycleOfBoundary {
        let boundary = &model.contact.boundaries[b];
        let largest =
            |of: fn(&NodeWatch) -> f64| boundary.nodes.iter().map(|&i| of(&self.nodes[i])).fold(0.0, f64::max);
        CycleOfBoundary {
            boundary: boundary.name.clone(),
            regime: self.regime(model, b),
            friction_work: boundary.shares(&model.contact.nodes).map(|(i, part)| part * self.nodes[i].work).sum(),
            slip_range: largest(NodeWatch::slip_range),
            slip_net: largest(NodeWatch::slip_net),
        }
    }

    fn of_nodes(&self, model: &Model, b: usize) -> Vec<CycleNode> {
        let boundary = &model.contact.boundaries[b];
        let node = |&i: &usize| self.nodes[i].node(model, &boundary.name, i, self.wear_coefficient);
        boundary.nodes.iter().map(node).collect()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Before,
    Within,
    After,
}

impl SlipRegime {
    fn of([some, all]: [bool; 2]) -> Self {
        match (some, all) {
            (_, true) => SlipRegime::GrossSlip,
            (true, _) => SlipRegime::PartialSlip,
            _ => SlipRegime::Stick,
        }
    }

    /// Returns the name of the regime.
    pub fn name(self) -> &'static str {
        match self {
            SlipRegime::Stick => "stick",
            SlipRegime::PartialSlip => "partial slip",
            SlipRegime::GrossSlip => "gross slip",
        }
    }
}
