//! Whether the mesh resolves zones that slip beside others that stick: how wide they are, and so the work of friction, is known to a node or so.

use serde::{Deserialize, Serialize};

use super::graph::ContactGraph;
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;

/// The work of friction so far, and over how many nodes it is spread.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct SlipZones {
    /// J; in two dimensions J per m of depth.
    work: f64,
    /// The sum of the work of each zone that slips beside nodes that stick over the nodes across that zone. Where all slides, the work does not depend
    /// on such a width.
    by_width: f64,
}

impl SlipZones {
    /// Takes in the slip of a converged increment.
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
        // How many edges each is away from the nearest node that sticks.
        let depths = graph.depths(&both, &slipping);
        for zone in graph.parts(&slipping) {
            let work: f64 = zone.iter().map(work_of).sum();
            self.work += work;
            if let Some(across) = zone.iter().filter_map(|i| depths.get(i)).max() {
                self.by_width += work / *across as f64;
            }
        }
    }

    /// The work, J, and the nodes across the zones in which it is done: one over the mean of their inverses, weighted by the work. None where nothing
    /// slips beside nodes that stick.
    pub(crate) fn found(&self) -> Option<(f64, f64)> {
        (self.by_width > 0.0).then(|| (self.work, self.work / self.by_width))
    }
}
