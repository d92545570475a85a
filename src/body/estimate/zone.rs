//! Whether the mesh resolves the contact: the zones of closed nodes, and what their pressures can mean.

use serde::{Deserialize, Serialize};

use super::corner::Corners;
use super::graph::ContactGraph;
use super::hertz::HertzContact;
use crate::algebra::vector::{dot, minus, norm, unit};
use crate::body::mesh::CellKind;
use crate::body::model::Model;
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;

/// What the mesh can tell of the contact on boundaries that share nodes, when their force was largest.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContactEstimate {
    /// The boundaries, with commas.
    pub boundary: String,
    /// The time, s.
    pub time: f64,
    /// The sum of the normal forces, N, in two dimensions per m of depth, of a body of revolution all around.
    pub force: f64,
    /// The closed nodes.
    pub closed: usize,
    /// The zones that closed nodes make up where they are neighbours.
    pub zones: usize,
    /// How many nodes are across the zone that bears most; none where the whole surface is in contact.
    pub nodes_across: Option<usize>,
    /// The share of the force on nodes without a closed neighbour.
    pub isolated_share: f64,
    /// The share of the force on zones that are three nodes across or fewer: pressures there mean nothing.
    pub unresolved_share: f64,
    /// The size of the elements at the node of the largest pressure, m.
    pub element_size: f64,
    /// The largest pressure of a node (32), Pa; with elements of second order corrected as in tables.
    pub peak_pressure: f64,
    /// The largest pressure of a node and its neighbours together, Pa.
    pub patch_pressure: f64,
    /// Which of the two is the better peak; none where neither is one.
    pub peak_of: Option<PeakOf>,
    /// How far the former is above the latter, as a share.
    pub scatter: f64,
    /// The largest error of the peak, as a share: `2 / n^1.5` of n nodes across or, from 5 on, the scatter.
    pub peak_error: Option<f64>,
    /// That of the width of the zone: `4 / n^1.5`.
    pub width_error: Option<f64>,
    /// The share of the force of the zone with the largest pressure that is on the nodes at its edge.
    pub edge_share: f64,
    /// Whether the pressure is largest where the zone ends at a corner of the body or of the obstacle, as under a punch, and so that of
    /// the mesh.
    pub singular_edge: bool,
    /// Where the zone ends with the boundary: how many times as long as the elements inside, or as short, those beyond are.
    pub edge_ratio: Option<f64>,
    /// The zone that sticks, where others slip.
    pub stick: Option<StickZone>,
    /// What Hertz has for the force, where the obstacle is a cylinder or a sphere and the zone three nodes across or fewer.
    pub hertz: Option<HertzContact>,
}

/// The part of a zone that sticks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StickZone {
    /// Its width as a share of that of the zone.
    pub ratio: f64,
    /// The ratio is known to this: one element at each end, `2 / n`.
    pub uncertainty: f64,
}

/// What a peak pressure is the largest of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PeakOf {
    /// Pressures of nodes.
    Nodes,
    /// Pressures of nodes and their neighbours together.
    Patches,
}

impl PeakOf {
    /// Patches where there are linear tetrahedra: their nodes scatter by a fifth however fine the mesh is.
    pub(crate) fn of(model: &Model) -> Self {
        let tetrahedra = model.mesh.cells.iter().any(|cell| cell.kind == CellKind::Tetrahedron);
        if tetrahedra { PeakOf::Patches } else { PeakOf::Nodes }
    }

    /// The same of a zone with so many nodes `across`, or of a whole surface; none where the zone is narrower than patches.
    fn zone(model: &Model, across: Option<usize>) -> Option<Self> {
        let of = Self::of(model);
        (of == PeakOf::Nodes || across.is_none_or(|n| n >= SCATTER_FROM)).then_some(of)
    }

    /// The same of the zone that contact node `i` is in, where these are the contact forces `p_n` (N).
    pub(crate) fn at(model: &Model, graph: &ContactGraph, p_n: &[f64], i: usize) -> Option<Self> {
        let surface = graph.surfaces().iter().find(|surface| surface.nodes.contains(&i))?;
        let zones = zones(model, graph, &surface.nodes, p_n);
        let (_, across) = zones.into_iter().find(|(zone, _)| zone.contains(&i))?;
        Self::zone(model, across)
    }
}

/// From so many nodes across on the scatter tells of the peak.
const SCATTER_FROM: usize = 5;

/// Zones of so many nodes across, or fewer, have no pressure to speak of.
pub(super) const NOTHING: usize = 3;

/// From so many nodes across on a peak at the edge tells that the pressure is singular there.
const EDGE_FROM: usize = 4;

/// A pressure that is larger at the edge by less is not singular but uniform, to rounding and to the roughness of meshes.
const UNIFORM: f64 = 0.1;

/// The largest error of the peak pressure of a zone that is `n` nodes across, as a share.
pub fn peak_error(n: usize) -> f64 {
    2.0 / (n as f64).powf(1.5)
}

impl ContactEstimate {
    /// The estimates of surface `k` of `graph` in a `state` at `time` (s) with `statuses`; none where nothing touches.
    pub(crate) fn new(
        model: &Model,
        graph: &ContactGraph,
        k: usize,
        time: f64,
        state: &State,
        statuses: &[ContactStatus],
    ) -> Option<Self> {
        let surface = &graph.surfaces()[k];
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
        let alone = zones.iter().filter(|(zone, _)| zone.len() == 1).fold(0.0, |all, (zone, _)| all + sum(zone));
        let pressures = model.contact_pressures(state);
        let pressure = |i: usize| pressures[i];
        let patch = |i: usize| graph.patch_pressure(model, p_n, i);
        let largest = |value: &dyn Fn(usize) -> f64| closed.iter().map(|&i| value(i)).fold(0.0, f64::max);
        let peak = closed.iter().copied().max_by(|&a, &b| pressure(a).total_cmp(&pressure(b)))?;
        let (peak_pressure, patch_pressure) = (pressure(peak), largest(&patch));
        let scatter = peak_pressure / patch_pressure - 1.0;
        // A node in a symmetry plane has but one cell and a bad pressure on half a mesh of triangles, of which its patch takes a third.
        let beside = graph.neighbours(peak);
        let mean = beside.iter().map(|&j| pressure(j)).sum::<f64>() / beside.len() as f64;
        let mirrored = graph.is_mirrored(peak) && model.mesh.dimension == 2 && mean > 0.0;
        let off = if mirrored { peak_pressure / mean - 1.0 } else { scatter };
        let (around_peak, across_peak) = zones.iter().find(|(zone, _)| zone.contains(&peak))?;
        let peak_error = across_peak.map(|n| match peak_error(n) {
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
            // Beside a corner, too, pressures are those of the mesh.
            ends_here(&peak) || !grows_outwards && beside.iter().any(ends_here)
        };
        Some(ContactEstimate {
            boundary: surface.name.clone(),
            time,
            force,
            closed: closed.len(),
            zones: zones.len(),
            nodes_across: *nodes_across,
            isolated_share: alone / force,
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
            stick: nodes_across.and_then(|n| stick_zone(model, heaviest, statuses, n)),
            hertz: (nodes_across.is_some_and(|n| n <= NOTHING))
                .then(|| HertzContact::under(model, time, p_n, &closed, peak))
                .flatten(),
        })
    }
}

/// The zones that closed nodes of a surface make up, each with the nodes across it.
fn zones(model: &Model, graph: &ContactGraph, surface: &[usize], p_n: &[f64]) -> Vec<(Vec<usize>, Option<usize>)> {
    let closed: Vec<usize> = surface.iter().copied().filter(|&i| p_n[i] > 0.0).collect();
    let depths = graph.depths(surface, &closed);
    let across = |zone: &[usize]| nodes_across(graph, zone, |i| depths.get(&i).copied(), model.mesh.dimension);
    let with = |zone: Vec<usize>| {
        let across = across(&zone);
        (zone, across)
    };
    graph.parts(&closed).into_iter().map(with).collect()
}

/// The nodes across a zone: in the plane those along it, those behind a symmetry plane or an axis included, in space twice the depth less
/// one. None where nothing next to it is open.
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
    let mirrored = zone.iter().any(|&i| graph.is_mirrored(i));
    Some(if mirrored { 2 * zone.len() - 1 } else { zone.len() })
}

/// The distance to the nearest neighbours of contact node `i`, in the mean, m.
fn element_size(model: &Model, graph: &ContactGraph, i: usize) -> f64 {
    let distance = |j: &usize| norm(minus(model.contacts[*j].position, model.contacts[i].position));
    let neighbours = graph.neighbours(i);
    neighbours.iter().map(distance).sum::<f64>() / neighbours.len() as f64
}

/// How unequal in length the elements are on both sides of the ends of a zone in the plane, where the boundary ends, too, and
/// the body goes on straight.
fn edge_ratio(model: &Model, graph: &ContactGraph, zone: &[usize]) -> Option<f64> {
    if model.mesh.dimension == 3 {
        return None;
    }
    let ratio = |&i: &usize| {
        let (node, from) = (model.contacts[i].node, model.contacts[i].position);
        let inside = minus(from, model.contacts[*graph.neighbours(i).first()?].position);
        let beyond = (model.mesh.cells.iter().filter(|cell| cell.nodes.contains(&node)))
            .flat_map(|cell| cell.nodes.iter().map(|&other| minus(model.mesh.nodes[other], from)))
            .filter(|beyond| norm(*beyond) > 0.0 && dot(unit(*beyond), unit(inside)) > STRAIGHT)
            .map(norm)
            .reduce(f64::min)?;
        Some((beyond / norm(inside)).max(norm(inside) / beyond))
    };
    zone.iter().filter(|i| graph.is_at_the_rim(**i)).filter_map(ratio).reduce(f64::max)
}

/// The cosine of an angle, 10 degrees, by which a side may bend and go on all the same.
const STRAIGHT: f64 = 0.985;

/// The zone that sticks; none where all nodes with friction do, or none does.
fn stick_zone(model: &Model, zone: &[usize], statuses: &[ContactStatus], n: usize) -> Option<StickZone> {
    let area = |status: ContactStatus| {
        let of = zone.iter().filter(|&&i| statuses[i] == status && !model.contacts[i].tangents[0].is_empty());
        of.map(|&i| model.contacts[i].weight).sum::<f64>()
    };
    let (stick, slip) = (area(ContactStatus::Stick), area(ContactStatus::Slip));
    let share = stick / (stick + slip);
    // Around an axis, as in space, areas grow with the square of the width.
    let disc = model.mesh.dimension == 3 || zone.iter().any(|&i| model.mesh.is_on_axis(model.contacts[i].node));
    let ratio = if disc { share.sqrt() } else { share };
    (stick > 0.0 && slip > 0.0).then_some(StickZone { ratio, uncertainty: 2.0 / n as f64 })
}
