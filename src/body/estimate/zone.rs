//! Resolution of the contact by the mesh: zones of closed nodes, the accuracy of their pressures, and slip zones beside stick
//! zones.

use serde::{Deserialize, Serialize};

use super::corner::Corners;
use super::graph::{ContactGraph, ContactPatch};
use super::hertz::HertzContact;
use crate::algebra::vector::{dot, minus, norm, unit};
use crate::body::mesh::CellKind;
use crate::body::model::Model;
use crate::solver::history::IncrementView;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// The resolution of the contact on boundaries that share nodes or meet at a seam, at the time of their largest force.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
pub struct ContactEstimate {
    /// The names of the boundaries, separated by commas.
    pub boundary: String,
    /// The time, s.
    pub time: f64,
    /// The sum of the normal forces, N; in two dimensions per m of depth, for a body of revolution over the full
    /// circumference.
    pub force: f64,
    /// The number of closed nodes.
    pub closed: usize,
    /// The number of zones, the connected sets of closed nodes.
    pub zones: usize,
    /// The number of nodes across the zone with the largest force; none if the whole surface is in contact.
    pub nodes_across: Option<usize>,
    /// The share of the force on nodes without a closed neighbour.
    pub isolated_share: f64,
    /// The share of the force on zones with at most three nodes across, whose pressures are meaningless.
    pub unresolved_share: f64,
    /// The size of the elements at the node of the largest pressure, m.
    pub element_size: f64,
    /// The largest pressure of a node (32), Pa; for elements of second order with the correction used in tables.
    pub peak_pressure: f64,
    /// The largest mean pressure of a node and its neighbours, Pa.
    pub patch_pressure: f64,
    /// The better of the two peak pressures; none if neither is meaningful.
    pub peak_of: Option<PeakOf>,
    /// The excess of the peak pressure over the patch pressure, as a share.
    pub scatter: f64,
    /// The largest error of the peak, as a share: `2 / n^1.5` for n nodes across, or for fewer in the ratio of the depth of the
    /// elements to their length if they are deeper; for n of at least 5, the scatter if that is larger.
    pub peak_error: Option<f64>,
    /// The largest error of the width of the zone, as a share: `4 / n^1.5`.
    pub width_error: Option<f64>,
    /// The share of the force on edge nodes, in the zone with the largest pressure.
    pub edge_share: f64,
    /// `true` if the pressure is largest where the zone ends at a corner of the body or of the obstacle, as under a
    /// punch, so that it depends on the mesh.
    pub singular_edge: bool,
    /// The ratio, at least 1, of the lengths of the elements inside and beyond the end of the zone, if the zone ends
    /// with the boundary.
    pub edge_ratio: Option<f64>,
    /// The stick zone when the tangential forces of the surface were largest.
    pub stick: Option<StickZone>,
    /// The number of nodes across the slip zones adjacent to stick zones, in all increments, weighted by the friction work;
    /// none if there are no such zones, or hardly any friction work.
    pub slip_across: Option<f64>,
    /// The Hertz contact for the force, if the obstacle is a cylinder or a sphere and the zone has at most three nodes
    /// across.
    pub hertz: Option<HertzContact>,
}

/// The sticking part of the zone with the largest force.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct StickZone {
    /// The names of the boundaries, separated by commas.
    pub boundary: String,
    /// The time, s.
    pub time: f64,
    /// The width of the stick zone as a share of the width of the zone: 1 if all nodes stick, 0 if none does.
    pub ratio: f64,
    /// The nodes across the zone, or along it if the whole surface is in contact.
    pub nodes_across: usize,
    /// The typical error of the ratio, a sixth of an element at each end: `1 / (3 n)` for n nodes across. `None` in space, where it is
    /// unknown.
    pub uncertainty: Option<f64>,
}

/// The values of which a peak pressure is the maximum.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PeakOf {
    /// Pressures of nodes.
    Nodes,
    /// Mean pressures of nodes and their neighbours.
    Patches,
}

impl PeakOf {
    /// Returns patches for meshes with linear tetrahedra, whose nodal pressures scatter by a fifth on any mesh;
    /// otherwise nodes.
    pub(crate) fn of(model: &Model) -> Self {
        let tetrahedra = model.mesh.cells.iter().any(|cell| cell.kind == CellKind::Tetrahedron);
        if tetrahedra { PeakOf::Patches } else { PeakOf::Nodes }
    }

    /// Returns the values for a zone with `across` nodes across, or for a whole surface; `None` if the zone is narrower
    /// than patches.
    fn zone(model: &Model, across: Option<usize>) -> Option<Self> {
        let of = Self::of(model);
        (of == PeakOf::Nodes || across.is_none_or(|n| n >= SCATTER_FROM)).then_some(of)
    }

    /// Returns the values for the zone of contact node `i` with the contact forces `p_n` (N).
    pub(crate) fn at(model: &Model, graph: &ContactGraph, p_n: &[f64], i: usize) -> Option<Self> {
        let (_, across) = zone_of(model, graph, p_n, i)?;
        Self::zone(model, across)
    }
}

/// The least number of nodes across for which the scatter measures the error of the peak.
const SCATTER_FROM: usize = 5;

/// The largest number of nodes across for which pressures are meaningless.
pub(crate) const NOTHING: usize = 3;

/// Tangential forces that differ from the friction limit by a smaller share are at it: far above the tolerance of the laws.
const AT_THE_LIMIT: f64 = 1e-6;

/// The typical error of the width of a stick zone, in elements: both of its ends are known to one element.
const OF_ELEMENT: f64 = 1.0 / 3.0;

/// The least number of nodes across for which a peak at the edge indicates a singular pressure.
const EDGE_FROM: usize = 4;

/// The pressure counts as uniform, not singular, if it is larger at the edge by less than this share, which covers
/// rounding and irregular meshes.
const UNIFORM: f64 = 0.1;

/// Returns the largest error of the peak pressure of a zone with `n` nodes across, as a share.
pub fn peak_error(n: usize) -> f64 {
    2.0 / (n as f64).powf(1.5)
}

/// Returns the largest error of the peak pressure at contact node `i` of a zone with `n` nodes across, as a share: of fewer
/// nodes where cells are deeper than long.
pub(crate) fn largest_error(model: &Model, graph: &ContactGraph, i: usize, n: usize) -> f64 {
    let (contact, nodes) = (&model.contact.nodes[i], &model.mesh.nodes);
    let height = |node: &usize| dot(contact.facing.normal, minus(nodes[*node], contact.position)).abs();
    let cells = model.mesh.cells.iter().filter(|cell| cell.nodes.contains(&contact.node));
    let depth = cells.map(|cell| {
        let most = cell.nodes.iter().map(height).fold(0.0, f64::max);
        // Cells of second order have nodes at half the height.
        if cell.kind.is_quadratic() { 0.5 * most } else { most }
    });
    let elongation = depth.fold(f64::INFINITY, f64::min) / element_size(model, graph, i);
    elongation.max(1.0).powf(1.5) * peak_error(n)
}

impl ContactEstimate {
    /// Estimates the resolution of surface `k` of `graph` in a `state` at `time` (s), without its stick and slip zones; `None`
    /// without contact.
    pub(crate) fn new(model: &Model, graph: &ContactGraph, k: usize, time: f64, state: &State) -> Option<Self> {
        let surface = &graph.surfaces[k];
        let p_n = &state.p_n;
        let closed: Vec<usize> = surface.nodes.iter().copied().filter(|&i| p_n[i] > 0.0).collect();
        let sum = |nodes: &[usize]| nodes.iter().map(|&i| p_n[i]).sum::<f64>();
        let force = sum(&closed);
        let depths = graph.depths(&surface.nodes, &closed);
        let zones = zones(model, graph, &surface.nodes, p_n);
        let (heaviest, nodes_across) = zones.iter().max_by(|a, b| sum(&a.0).total_cmp(&sum(&b.0)))?;
        let share = |few: usize| {
            let of = zones.iter().filter(|(_, across)| across.is_some_and(|across| across <= few));
            of.fold(0.0, |all, (zone, _)| all + sum(zone)) / force
        };
        let isolated = zones.iter().filter(|(zone, _)| zone.len() == 1).fold(0.0, |all, (zone, _)| all + sum(zone));
        let pressures = model.contact_pressures(state);
        let pressure = |i: usize| pressures[i];
        let patch = |i: usize| graph.patch_pressure(model, p_n, i);
        let largest = |value: &dyn Fn(usize) -> f64| closed.iter().map(|&i| value(i)).fold(0.0, f64::max);
        let peak = closed.iter().copied().max_by(|&a, &b| pressure(a).total_cmp(&pressure(b)))?;
        let (peak_pressure, patch_pressure) = (pressure(peak), largest(&patch));
        let scatter = peak_pressure / patch_pressure - 1.0;
        // On half a mesh of triangles, a node in a symmetry plane has only one cell and an inaccurate pressure, which
        // makes up a third of its patch.
        let beside = &graph.neighbours[peak];
        let mean = beside.iter().map(|&j| pressure(j)).sum::<f64>() / beside.len() as f64;
        let mirrored = graph.mirrored[peak] && model.mesh.dimension == 2 && mean > 0.0;
        let off = if mirrored { peak_pressure / mean - 1.0 } else { scatter };
        let (around_peak, across_peak) = zones.iter().find(|(zone, _)| zone.contains(&peak))?;
        let peak_error = across_peak.map(|n| match largest_error(model, graph, peak, n) {
            of_width if n >= SCATTER_FROM => of_width.max(off),
            of_width => of_width,
        });
        let is_edge = |i: &usize| depths.get(i) == Some(&1) || graph.is_at_the_rim(*i);
        let (edge, inside): (Vec<usize>, Vec<usize>) = around_peak.iter().partition(|i| is_edge(i));
        let most = |nodes: &[usize]| nodes.iter().map(|&i| pressure(i)).fold(0.0, f64::max);
        let wide = across_peak.map_or(around_peak.len() >= EDGE_FROM, |n| n >= EDGE_FROM);
        let grows_outwards = !inside.is_empty() && most(&edge) > (1.0 + UNIFORM) * most(&inside);
        let singular_edge = wide && (grows_outwards || scatter > UNIFORM) && {
            let corners = Corners::new(model, graph, time);
            let is_closed = |i: usize| p_n[i] > 0.0;
            let ends_here = |i: &usize| is_edge(i) && corners.is_at(*i, is_closed);
            // Pressures beside a corner depend on the mesh, too.
            ends_here(&peak) || !grows_outwards && beside.iter().any(ends_here)
        };
        Some(ContactEstimate {
            boundary: surface.name.clone(),
            time,
            force,
            closed: closed.len(),
            zones: zones.len(),
            nodes_across: *nodes_across,
            isolated_share: isolated / force,
            unresolved_share: share(NOTHING),
            element_size: element_size(model, graph, peak),
            peak_pressure,
            patch_pressure,
            peak_of: PeakOf::zone(model, *across_peak),
            scatter,
            peak_error,
            width_error: nodes_across.map(|n| 2.0 * self::peak_error(n)),
            edge_share: sum(&edge) / sum(around_peak),
            singular_edge,
            edge_ratio: edge_ratio(model, graph, heaviest),
            stick: None,
            slip_across: None,
            hertz: (nodes_across.is_some_and(|n| n <= NOTHING))
                .then(|| HertzContact::under(model, time, p_n, &closed, peak))
                .flatten(),
        })
    }
}

/// Returns the zones of closed nodes of a surface, each with the number of nodes across it.
fn zones(model: &Model, graph: &ContactGraph, surface: &[usize], p_n: &[f64]) -> Vec<(Vec<usize>, Option<usize>)> {
    let closed: Vec<usize> = surface.iter().copied().filter(|&i| p_n[i] > 0.0).collect();
    let depths = graph.depths(surface, &closed);
    let across = |zone: &[usize]| nodes_across(graph, zone, |i| depths.get(&i).copied(), model.mesh.dimension);
    let with = |zone: Vec<usize>| {
        let across = across(&zone);
        (zone, across)
    };
    graph.components(&closed).into_iter().map(with).collect()
}

/// Returns the zone of contact node `i` with the number of nodes across it.
fn zone_of(model: &Model, graph: &ContactGraph, p_n: &[f64], i: usize) -> Option<(Vec<usize>, Option<usize>)> {
    let surface = graph.surfaces.iter().find(|surface| surface.nodes.contains(&i))?;
    zones(model, graph, &surface.nodes, p_n).into_iter().find(|(zone, _)| zone.contains(&i))
}

/// Returns the number of nodes across a zone: in two dimensions the nodes along it, including mirrored ones behind a
/// symmetry plane or an axis; in three dimensions twice the depth minus one. `None` if no open node is next to it.
fn nodes_across(
    graph: &ContactGraph,
    zone: &[usize],
    depth: impl Fn(usize) -> Option<usize>,
    dimension: usize,
) -> Option<usize> {
    let deepest = zone.iter().filter_map(|&i| depth(i)).max()?;
    if dimension == 3 {
        return Some(2 * deepest - 1);
    }
    let mirrored = zone.iter().any(|&i| graph.mirrored[i]);
    Some(if mirrored { 2 * zone.len() - 1 } else { zone.len() })
}

/// Returns the mean distance of contact node `i` to its neighbours, or, without any, to the nodes of its facets, m.
fn element_size(model: &Model, graph: &ContactGraph, i: usize) -> f64 {
    let (nodes, own) = (&model.mesh.nodes, model.contact.nodes[i].node);
    let mut others: Vec<usize> = graph.neighbours[i].iter().map(|&j| model.contact.nodes[j].node).collect();
    if others.is_empty() {
        others.extend(model.mesh.surface_at(|k| k == own).into_iter().flat_map(|of| of.0).filter(|k| *k != own));
    }
    others.iter().map(|&other| norm(minus(nodes[other], nodes[own]))).sum::<f64>() / others.len() as f64
}

/// Returns the ratio of the lengths of the elements on both sides of the ends of a zone in two dimensions, where the
/// boundary ends, too, and the body continues straight.
fn edge_ratio(model: &Model, graph: &ContactGraph, zone: &[usize]) -> Option<f64> {
    if model.mesh.dimension == 3 {
        return None;
    }
    let ratio = |&i: &usize| {
        let (node, from) = (model.contact.nodes[i].node, model.contact.nodes[i].position);
        let inside = minus(from, model.contact.nodes[*graph.neighbours[i].first()?].position);
        let outside = (model.mesh.cells.iter().filter(|cell| cell.nodes.contains(&node)))
            .flat_map(|cell| cell.nodes.iter().map(|&other| minus(model.mesh.nodes[other], from)))
            .filter(|beyond| norm(*beyond) > 0.0 && dot(unit(*beyond), unit(inside)) > STRAIGHT)
            .map(norm)
            .reduce(f64::min)?;
        Some((outside / norm(inside)).max(norm(inside) / outside))
    };
    zone.iter().filter(|i| graph.is_at_the_rim(**i)).filter_map(ratio).reduce(f64::max)
}

/// The cosine of the largest angle, 10 degrees, by which a straight side may bend.
const STRAIGHT: f64 = 0.985;

/// A zone of closed nodes with its largest pressure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeakZone {
    /// The number of nodes across it; `None` if no open node is next to it.
    across: Option<usize>,
    /// The contact nodes.
    pub nodes: Vec<usize>,
    /// The largest pressure of a node, or of a node with its neighbours on linear tetrahedra, Pa.
    peak: f64,
}

impl PeakZone {
    /// Returns the zones of all contact surfaces in a `state`.
    pub(crate) fn all(model: &Model, graph: &ContactGraph, state: &State) -> Vec<Self> {
        let pressures = match PeakOf::of(model) {
            PeakOf::Nodes => model.contact_pressures(state),
            PeakOf::Patches => graph.patch_pressures(model, &state.p_n),
        };
        let peak = |zone: &[usize]| zone.iter().map(|&i| pressures[i]).fold(0.0, f64::max);
        let of_surface = |surface: &ContactPatch| zones(model, graph, &surface.nodes, &state.p_n);
        let zones = graph.surfaces.iter().flat_map(of_surface);
        zones.map(|(nodes, across)| PeakZone { across, peak: peak(&nodes), nodes }).collect()
    }

    /// Returns the number of nodes across the zone of contact node `i` with the normal forces `p_n` (N); `None` if no open
    /// node is next to it.
    pub(crate) fn across_at(model: &Model, graph: &ContactGraph, p_n: &[f64], i: usize) -> Option<usize> {
        zone_of(model, graph, p_n, i).and_then(|(_, across)| across)
    }

    /// Returns `true` if the zone has up to three nodes across.
    pub(crate) fn is_narrow(&self) -> bool {
        self.across.is_some_and(|n| n <= NOTHING)
    }

    /// Returns the largest pressure that the zone may have on a fine mesh, Pa; `None` if it is unknown.
    pub(crate) fn largest_possible(&self) -> Option<f64> {
        self.across.map(|n| self.peak * (1.0 + peak_error(n)))
    }
}

impl StickZone {
    /// Returns the stick zone of surface `k` of `graph` in a `state` at `time` (s); `None` without friction, and
    /// in zones of up to three nodes across. A closed node at the friction limit belongs to the slip zone, whatever its
    /// status: where slip has just ended, rounding decides between stick and slip.
    pub(crate) fn new(model: &Model, graph: &ContactGraph, k: usize, time: f64, state: &State) -> Option<Self> {
        let p_n = &state.p_n;
        let mu = model.loading.friction().map_or_else(|| model.problem.mu().to_vec(), |friction| friction.at(time));
        let is_at_the_limit = |i: usize| state.p_t[i].hypot(state.p_o[i]) >= (1.0 - AT_THE_LIMIT) * mu[i] * p_n[i];
        let surface = &graph.surfaces[k];
        let sum = |nodes: &[usize]| nodes.iter().map(|&i| p_n[i]).sum::<f64>();
        let zones = zones(model, graph, &surface.nodes, p_n);
        let (zone, across) = zones.into_iter().max_by(|a, b| sum(&a.0).total_cmp(&sum(&b.0)))?;
        let area = |at_the_limit: bool| {
            let with_friction = zone.iter().filter(|&&i| !model.contact.nodes[i].tangents[0].is_empty());
            with_friction
                .filter(|&&i| is_at_the_limit(i) == at_the_limit)
                .map(|&i| model.contact.nodes[i].weight)
                .sum::<f64>()
        };
        let (stick, slip) = (area(false), area(true));
        // + 0.0 because the sum of nothing is -0.
        let share = stick / (stick + slip) + 0.0;
        // Around an axis, as in three dimensions, areas grow with the square of the width.
        let disc =
            model.mesh.dimension == 3 || zone.iter().any(|&i| model.mesh.is_on_axis(model.contact.nodes[i].node));
        let ratio = if disc { share.sqrt() } else { share };
        let along = if model.mesh.dimension == 3 { zone.len().isqrt() } else { zone.len() };
        let n = across.unwrap_or(along);
        (stick + slip > 0.0 && n > NOTHING).then(|| StickZone {
            boundary: surface.name.clone(),
            time,
            ratio,
            nodes_across: n,
            uncertainty: (model.mesh.dimension == 2).then_some(OF_ELEMENT / n as f64),
        })
    }
}

/// The work of friction on a contact surface so far, and the number of nodes over which it is distributed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct SlipZones {
    /// The work of friction, J; in two dimensions J per m of depth.
    work: f64,
    /// The sum over all slip zones beside sticking nodes of the work divided by the number of nodes across the zone.
    /// Without sticking nodes the work does not depend on such a width.
    by_width: f64,
}

impl SlipZones {
    /// Adds the slip of surface `k` of `graph` in a converged increment.
    pub(crate) fn observe(&mut self, model: &Model, graph: &ContactGraph, k: usize, step: &IncrementView<'_>) {
        let IncrementView { increment, state, statuses, .. } = step;
        let work_of = |i: &usize| {
            let slip = model.problem.slip(increment, state, *i);
            (state.p_t[*i] * slip[0] + state.p_o[*i] * slip[1]).max(0.0)
        };
        let nodes = || graph.surfaces[k].nodes.iter().copied();
        let nodes_that = |status: ContactStatus| nodes().filter(move |&i| statuses[i] == status);
        let slipping: Vec<usize> = nodes_that(ContactStatus::Slip).collect();
        if slipping.is_empty() {
            return;
        }
        let both: Vec<usize> = nodes_that(ContactStatus::Stick).chain(slipping.iter().copied()).collect();
        // The number of edges from each slipping node to the nearest sticking node.
        let depths = graph.depths(&both, &slipping);
        for zone in graph.components(&slipping) {
            let work: f64 = zone.iter().map(work_of).sum();
            self.work += work;
            if let Some(across) = zone.iter().filter_map(|i| depths.get(i)).max() {
                self.by_width += work / *across as f64;
            }
        }
    }

    /// Returns the work, J, and the number of nodes across the slip zones, the harmonic mean weighted by the work.
    /// `None` if no node slips beside sticking nodes.
    pub(crate) fn found(&self) -> Option<(f64, f64)> {
        (self.by_width > 0.0).then(|| (self.work, self.work / self.by_width))
    }
}
