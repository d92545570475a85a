//! The largest contact pressure of a history.

use serde::{Deserialize, Serialize};

use crate::body::estimate::{ContactEstimate, ContactGraph, NOTHING, PeakOf, PeakZone, largest_error};
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

use super::largest::is_as_large;

/// The largest contact pressure of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct LargestPressure {
    /// The largest `σ_n = p_n / l` (32), Pa, of a node, or on linear tetrahedra of a node and its neighbours together;
    /// none if the contact zone has so few tetrahedra across that neither is the peak.
    pub pressure: Option<f64>,
    /// The kind of the pressure: of a node, or of a node and its neighbours.
    pub peak_of: Option<PeakOf>,
    /// The mean pressure of the closed nodes of its boundary at that time, Pa: the sum of their `p_n` over the sum of their
    /// weights l (32).
    #[serde(default)]
    pub mean_pressure: Option<f64>,
    /// The boundary of the node.
    pub boundary: String,
    /// The node's position, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
    /// The number of nodes across the zone of the node; none if the whole surface is in contact.
    pub nodes_across: Option<usize>,
    /// The error of the mesh, as a share, see doc/method/estimates.md. `None` if it is unknown or above 1: in zones of up to
    /// three nodes across, at a singular edge, at the rim of a surface that is wholly in contact, or on one that slides there.
    pub mesh_error: Option<f64>,
    /// `true` if the pressure is singular at a corner, so that it depends on the mesh.
    #[serde(default)]
    pub singular: bool,
}

/// The typical error of a peak as a share of the largest one, the median of measured peaks.
const OF_LARGEST: f64 = 0.25;

/// The typical error of the force of a mesh as a share of the square of its error in the energy norm, as far as the contact is
/// resolved better than the body.
const OF_SQUARE: f64 = 0.5;

/// A pressure at the rim of a surface in contact that exceeds the mean with its neighbours by a larger share may be singular.
const STEEP: f64 = 0.01;

/// A tangential force that is less than the friction by a smaller share of it counts as that of a slipping node.
const SLIDES: f64 = 1e-6;

/// The largest pressure so far, with its place, time and state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Peak {
    /// The pressure, Pa.
    pressure: f64,
    /// The indices of the boundary and of the contact node.
    at: [usize; 2],
    /// The mean pressure of the closed nodes of the boundary at that time, Pa.
    mean: Option<f64>,
    /// The time, s.
    time: f64,
    /// The contact forces at that time; displacements are omitted.
    state: State,
}

impl Peak {
    /// Replaces `before` if `step` has a larger pressure of nodes or patches.
    pub(super) fn see(
        before: &mut Option<Self>,
        model: &Model,
        graph: &ContactGraph,
        IncrementView { record, state, statuses, .. }: &IncrementView<'_>,
    ) {
        let pressures = match PeakOf::of(model) {
            PeakOf::Nodes => model.contact_pressures(state),
            PeakOf::Patches => graph.patch_pressures(model, &state.p_n),
        };
        // Forces at open nodes are rounding errors, and patches around them belong to closed nodes.
        let is_closed = |i: &usize| statuses[*i] != ContactStatus::Open && state.p_n[*i] > 0.0;
        let nodes = model.contact.boundaries.iter().enumerate();
        let pairs =
            nodes.flat_map(|(b, boundary)| boundary.nodes.iter().map(move |&i| [b, i])).filter(|[_, i]| is_closed(i));
        // The first of equally large pressures counts.
        let largest = pairs.fold((0.0, None), |(most, at), pair| match pressures[pair[1]] {
            pressure if pressure > 0.0 && !is_as_large(most, pressure) => (pressure, Some(pair)),
            _ => (most, at),
        });
        let so_far = before.as_ref().map_or(0.0, |peak| peak.pressure);
        if let (pressure, Some(at)) = largest
            && is_as_large(pressure, so_far)
        {
            let parts = model.contact.boundaries[at[0]].shares(&model.contact.nodes).filter(|(i, _)| is_closed(i));
            let [force, area] = parts.fold([0.0; 2], |[force, area], (i, share)| {
                [force + share * state.p_n[i], area + share * model.contact.nodes[i].weight]
            });
            let mean = (area > 0.0).then(|| force / area);
            let State { p_n, p_t, p_o, .. } = state;
            let state = State { p_n: p_n.clone(), p_t: p_t.clone(), p_o: p_o.clone(), ..State::default() };
            *before = Some(Peak { pressure: pressure.max(so_far), at, mean, time: record.time, state });
        }
    }

    /// Returns `true` if the data fits `model`.
    pub(super) fn fits(&self, model: &Model) -> bool {
        let [boundary, i] = self.at;
        let nodes = model.contact.boundaries.get(boundary).map(|boundary| &boundary.nodes);
        nodes.is_some_and(|nodes| nodes.contains(&i)) && self.state.p_n.len() == model.contact.nodes.len()
    }

    /// Estimates the mesh error of its contact surface at that time.
    pub(super) fn estimate(&self, model: &Model, graph: &ContactGraph) -> Option<ContactEstimate> {
        let surface = graph.surfaces.iter().position(|surface| surface.nodes.contains(&self.at[1]))?;
        ContactEstimate::new(model, graph, surface, self.time, &self.state)
    }

    /// Estimates the error of the peak, as a share, from the estimate of its `surface` and the error `discretisation` in the
    /// energy norm. A less resolved zone with a smaller pressure may hold the true peak.
    pub(super) fn error(
        &self,
        model: &Model,
        graph: &ContactGraph,
        surface: &ContactEstimate,
        discretisation: Option<f64>,
    ) -> Option<f64> {
        let across = PeakZone::across_at(model, graph, &self.state.p_n, self.at[1]);
        let own = match surface.peak_error {
            _ if surface.singular_edge || across.is_some_and(|n| n <= NOTHING) => return None,
            // The scatter is larger than the envelope, and an error itself: the peak is that of a node which scatters up.
            Some(largest) if across.is_some_and(|n| largest > largest_error(model, graph, self.at[1], n)) => largest,
            Some(largest) => (OF_LARGEST * largest).max(OF_SQUARE * discretisation.map_or(0.0, |share| share * share)),
            None if graph.is_at_the_rim(self.at[1]) && surface.scatter > STEEP => return None,
            None if self.slides_at_the_rim(model, graph) => return None,
            None => discretisation?.powi(2).max(surface.scatter),
        };
        let others =
            PeakZone::all(model, graph, &self.state).into_iter().filter(|zone| !zone.nodes.contains(&self.at[1]));
        let possible = others.filter_map(|zone| zone.largest_possible());
        let error = possible.fold(own, |error, possible| error.max(possible / self.pressure - 1.0));
        Some(error).filter(|error| *error <= 1.0)
    }

    /// Returns `true` if a node at the rim of the peak's boundary slips with friction. The pressure there may be singular, by
    /// an exponent that depends on the friction, and exceed the peak on a finer mesh.
    fn slides_at_the_rim(&self, model: &Model, graph: &ContactGraph) -> bool {
        let State { p_n, p_t, p_o, .. } = &self.state;
        let slides = |i: usize| {
            let bears = model.problem.mu()[i] * p_n[i];
            bears > 0.0 && p_t[i].hypot(p_o[i]) >= (1.0 - SLIDES) * bears
        };
        model.contact.boundaries[self.at[0]].nodes.iter().any(|&i| graph.is_at_the_rim(i) && slides(i))
    }

    /// Returns the pressure for the report.
    pub(super) fn record(
        &self,
        model: &Model,
        graph: &ContactGraph,
        mesh_error: Option<f64>,
        singular: bool,
    ) -> LargestPressure {
        let [boundary, i] = self.at;
        let peak_of = PeakOf::at(model, graph, &self.state.p_n, i);
        LargestPressure {
            pressure: peak_of.map(|_| self.pressure),
            peak_of,
            mean_pressure: self.mean,
            boundary: model.contact.boundaries[boundary].name.clone(),
            position: model.contact.nodes[i].position,
            time: self.time,
            nodes_across: PeakZone::across_at(model, graph, &self.state.p_n, i),
            mesh_error,
            singular,
        }
    }
}
