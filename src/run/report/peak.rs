//! The largest contact pressure of a history.

use serde::{Deserialize, Serialize};

use crate::body::estimate::{ContactEstimate, ContactGraph, PeakOf};
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

use super::largest::is_as_large;

/// The largest contact pressure of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LargestPressure {
    /// `σ_n = p_n / l` (32) of a node, on linear tetrahedra of a node and its neighbours together, Pa; none where the contact zone has so
    /// few tetrahedra across that neither is the peak.
    pub pressure: Option<f64>,
    /// Which of the two it is.
    pub peak_of: Option<PeakOf>,
    /// The boundary of the node.
    pub boundary: String,
    /// The node's position, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
}

/// The largest pressure so far, and what it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    /// Pa.
    pressure: f64,
    /// The places of its boundary and of its contact node.
    at: [usize; 2],
    /// s.
    time: f64,
    /// The contact forces then; displacements are left out.
    state: State,
    statuses: Vec<ContactStatus>,
}

impl Peak {
    /// The larger one of `before` and what `step` has, by the pressures `of` nodes or patches.
    pub(super) fn see(
        before: &mut Option<Self>,
        model: &Model,
        graph: &ContactGraph,
        of: PeakOf,
        IncrementView { record, state, statuses, .. }: &IncrementView<'_>,
    ) {
        let pressures = match of {
            PeakOf::Nodes => model.contact_pressures(state),
            PeakOf::Patches => graph.patch_pressures(model, &state.p_n),
        };
        // What is left at open nodes is rounding, and patches around them belong to closed ones.
        let is_closed = |i: &usize| statuses[*i] != ContactStatus::Open && state.p_n[*i] > 0.0;
        let nodes = model.contact_boundaries.iter().enumerate();
        let pairs =
            nodes.flat_map(|(b, boundary)| boundary.nodes.iter().map(move |&i| [b, i])).filter(|[_, i]| is_closed(i));
        // The first of those that are as large.
        let largest = pairs.fold((0.0, None), |(most, at), pair| match pressures[pair[1]] {
            pressure if pressure > 0.0 && !is_as_large(most, pressure) => (pressure, Some(pair)),
            _ => (most, at),
        });
        let so_far = before.as_ref().map_or(0.0, |peak| peak.pressure);
        if let (pressure, Some(at)) = largest
            && is_as_large(pressure, so_far)
        {
            let State { p_n, p_t, p_o, .. } = state;
            let state = State { p_n: p_n.clone(), p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() };
            let (pressure, time, statuses) = (pressure.max(so_far), record.time, statuses.to_vec());
            *before = Some(Peak { pressure, at, time, state, statuses });
        }
    }

    /// Whether it is one of a model with so many contact nodes.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let [boundary, i] = self.at;
        let nodes = model.contact_boundaries.get(boundary).map(|boundary| &boundary.nodes);
        nodes.is_some_and(|nodes| nodes.contains(&i))
            && self.state.p_n.len() == model.contacts.len()
            && self.statuses.len() == model.contacts.len()
    }

    /// What the mesh can tell of the contact surface that it is on, at that time.
    pub(super) fn estimate(&self, model: &Model, graph: &ContactGraph) -> Option<ContactEstimate> {
        let surface = graph.surfaces().iter().position(|surface| surface.nodes.contains(&self.at[1]))?;
        ContactEstimate::new(model, graph, surface, self.time, &self.state, &self.statuses)
    }

    /// What there is to tell of it.
    pub(super) fn told(&self, model: &Model, graph: &ContactGraph) -> LargestPressure {
        let [boundary, i] = self.at;
        let peak_of = PeakOf::at(model, graph, &self.state.p_n, i);
        LargestPressure {
            pressure: peak_of.map(|_| self.pressure),
            peak_of,
            boundary: model.contact_boundaries[boundary].name.clone(),
            position: model.contacts[i].position,
            time: self.time,
        }
    }
}
