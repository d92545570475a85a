//! Resolution of slip zones beside stick zones. Their width, and therefore the work of friction, is known only to about
//! one node.

use serde::{Deserialize, Serialize};

use super::graph::ContactGraph;
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;

/// The work of friction so far, and the number of nodes over which it is distributed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct SlipZones {
    /// The work of friction, J; in two dimensions J per m of depth.
    work: f64,
    /// The sum over all slip zones beside sticking nodes of the work divided by the number of nodes across the zone.
    /// Without sticking nodes the work does not depend on such a width.
    by_width: f64,
    /// The sum of the work divided by the square of that number.
    by_square: f64,
}

impl SlipZones {
    /// Adds the slip of a converged increment.
    pub(crate) fn see(&mut self, model: &Model, graph: &ContactGraph, step: &IncrementView<'_>) {
        let IncrementView { increment, state, statuses, .. } = step;
        let work_of = |i: &usize| {
            let slip = model.problem.slip(increment, state, *i);
            (state.p_t[*i] * slip[0] + state.p_o[*i] * slip[1]).max(0.0)
        };
        let nodes_that = |status: ContactStatus| (0..statuses.len()).filter(move |&i| statuses[i] == status);
        let slipping: Vec<usize> = nodes_that(ContactStatus::Slip).collect();
        if slipping.is_empty() {
            return;
        }
        let both: Vec<usize> = nodes_that(ContactStatus::Stick).chain(slipping.iter().copied()).collect();
        // The number of edges from each slipping node to the nearest sticking node.
        let depths = graph.depths(&both, &slipping);
        for zone in graph.parts(&slipping) {
            let work: f64 = zone.iter().map(work_of).sum();
            self.work += work;
            if let Some(across) = zone.iter().filter_map(|i| depths.get(i)).max() {
                self.by_width += work / *across as f64;
                self.by_square += work / (*across as f64).powi(2);
            }
        }
    }

    /// Returns the error of the work by the width of slip zones, as a share: the square of one node of the width of each zone,
    /// weighted by the work. `None` if no node slips beside sticking nodes.
    pub(crate) fn error(&self) -> Option<f64> {
        (self.by_square > 0.0).then(|| self.by_square / self.work)
    }

    /// Returns the work, J, and the number of nodes across the slip zones, the harmonic mean weighted by the work.
    /// `None` if no node slips beside sticking nodes.
    pub(crate) fn found(&self) -> Option<(f64, f64)> {
        (self.by_width > 0.0).then(|| (self.work, self.work / self.by_width))
    }
}
