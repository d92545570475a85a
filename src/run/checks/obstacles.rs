//! Obstacles that contact nodes miss.

use super::prelude::*;
use crate::body::model::{BetweenNodes, Overlap, TOLERATED_SHARE};

kinds! {
    /// A node is inside an obstacle that it does not meet, by more than a tenth of the indentation.
    OBSTACLE_NOT_MET("obstacle-not-met", "One `normal` for these obstacles, or one boundary each.", "never");
    /// The obstacle has details finer than the elements: between nodes its distance is off, or it is inside the body, by
    /// more than a tenth of the indentation.
    OBSTACLE_BETWEEN_NODES("obstacle-between-nodes", "Smaller elements there.", "never");
}

/// The contact node deepest inside an obstacle that it does not meet.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct ObstacleNotMet(Largest<Overlap>);

impl Check for ObstacleNotMet {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, _: &SoFar) {
        let overlap = model.overlap(step.record.time, step.state);
        self.0.add(step, overlap.map(|overlap| (overlap.depth, overlap)));
    }

    fn fits(&self, model: &Model) -> bool {
        let (contacts, obstacles) = (model.contact.nodes.len(), model.contact.obstacles.len());
        self.0.0.as_ref().is_none_or(|(.., overlap)| overlap.contact < contacts && overlap.obstacle < obstacles)
    }

    fn warning(&self, model: &Model, so_far: &SoFar) -> Option<Warning> {
        let (depth, time, &Overlap { contact, obstacle, .. }) = self.0.above(TOLERATED_SHARE * so_far.indentation)?;
        let boundary = model.contact.boundaries.iter().find(|boundary| boundary.obstacles.contains(&obstacle));
        let cure = match boundary {
            Some(boundary) if !boundary.nodes.contains(&contact) => {
                format!("an obstacle of `{}` only; list it for the node's boundary too", boundary.name)
            }
            _ => "which it does not meet: of obstacles with different normals, a node meets only the nearest one at \
                 the beginning; give these obstacles one `normal`, with direction = \"normal\", or one boundary each"
                .to_string(),
        };
        let (place, beside) = (model.units().point(model.contact.nodes[contact].position), so_far.beside(depth));
        let (depth, obstacle) = (model.units().rounded(Quantity::Length, depth, 3), model.obstacle_key(obstacle));
        Some(WarningKind::OBSTACLE_NOT_MET.warning(format!(
            "the contact node at {place} is {depth} inside {obstacle} at t = {time} s, {beside}, {cure}"
        )))
    }
}

/// The largest deviation of an obstacle between nodes when contact forces were largest, if any, and the time, s.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct ObstacleBetweenNodes(pub(super) Option<(BetweenNodes, f64)>);

impl Check for ObstacleBetweenNodes {
    fn observe(&mut self, model: &Model, step: &IncrementView<'_>, so_far: &SoFar) {
        if so_far.is_deepest {
            let time = step.record.time;
            self.0 = model.between_nodes(time, step.state, step.statuses).map(|between| (between, time));
        }
    }

    fn warning(&self, model: &Model, so_far: &SoFar) -> Option<Warning> {
        let tolerated = TOLERATED_SHARE * so_far.indentation;
        let (found, time) = self.0.as_ref().filter(|(found, _)| found.missed > tolerated)?;
        let BetweenNodes { boundary, position, missed, untouched, size } = found;
        let (place, time, beside) = (model.units().point(*position), six_digits(*time), so_far.beside(*missed));
        let [off, size] = [*missed, *size].map(|x| model.units().rounded(Quantity::Length, x, 3));
        let what = match untouched {
            Some(_) => format!("it is {off} inside the body at t = {time} s"),
            None => format!("its distance at t = {time} s differs by {off} from the distances at the nodes"),
        };
        Some(WarningKind::OBSTACLE_BETWEEN_NODES.warning(format!(
            "the obstacle in front of `{boundary}` has details that are finer than the elements: between nodes, at \
             {place}, {what}, {beside}, and \
             pressures may be equally wrong; make the elements there, now {size} long, smaller than these details"
        )))
    }
}
