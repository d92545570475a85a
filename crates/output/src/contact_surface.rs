//! Views of a contact surface in space at the end of an increment, along its normal; unrolled if it is around an axis.

use super::unrolled::Cylinder;
use std::collections::BTreeMap;
use stickslip::algebra::{across, axis, axis_across, cross, dot, norm, plus, unit};
use stickslip::base::UnitSystem;
use stickslip::body::mesh::Facet;
use stickslip::body::{ContactBoundary, Model};
use stickslip::solver::ContactStatus;
use stickslip::solver::history::IncrementView;

/// The nodes and facets of a boundary with contact, projected on the plane perpendicular to the obstacle's normal, or
/// unrolled.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSurface {
    /// The boundary, if the scene has contact on several.
    pub boundary: Option<String>,
    /// The increment, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The two axes of the plane, unit vectors. On an unrolled surface the first is that of the angle 0.
    pub axes: [[f64; 3]; 2],
    /// The length on the map of one degree about the second axis, m, if the surface is around it and unrolled.
    pub degree: Option<f64>,
    /// The nodes of the boundary.
    pub nodes: Vec<SurfaceNode>,
    /// The facets, by their nodes.
    pub facets: Vec<Vec<usize>>,
    /// The units of the picture; the numbers here are SI.
    pub units: UnitSystem,
}

/// A node of a contact surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceNode {
    /// The coordinates of the node along the two axes of the map, m.
    pub position: [f64; 2],
    /// Normal contact stress (32), Pa.
    pub pressure: f64,
    /// Tangential contact stress of the body on the obstacle along the axes, Pa.
    pub traction: [f64; 2],
    /// The contact status of the node; `None` if supports hold it along the normal, or nothing is in front of it.
    pub status: Option<ContactStatus>,
    /// `true` if supports hold the node along the normal of the surface.
    pub held: bool,
}

impl ContactSurface {
    /// Returns the contact surfaces of a step, one for each boundary with contact; none in two dimensions.
    pub fn all(model: &Model, step: &IncrementView<'_>) -> Vec<Self> {
        let boundaries = model.contact.boundaries.iter().filter(|_| model.mesh.dimension == 3);
        boundaries.filter_map(|boundary| Self::new(model, step, boundary)).collect()
    }

    fn new(model: &Model, step: &IncrementView<'_>, boundary: &ContactBoundary) -> Option<Self> {
        let facets = &model.mesh.boundary(&boundary.name)?.facets;
        let mesh = &model.mesh;
        let (axes, cylinder) = (axes(view(model, boundary)), cylinder(model, facets));
        let flat = |v: [f64; 3]| axes.map(|axis| dot(axis, v));
        let along = |node: usize, v: [f64; 3]| match &cylinder {
            Some(cylinder) => cylinder.along(mesh.nodes[node], v),
            None => flat(v),
        };
        let mut number = vec![None; mesh.nodes.len()];
        let mut nodes = Vec::new();
        for &node in facets.iter().flatten() {
            number[node].get_or_insert_with(|| {
                let x = mesh.nodes[node];
                let position = cylinder.as_ref().map_or_else(|| flat(x), |cylinder| cylinder.at(cylinder.angle(x), x));
                nodes.push(SurfaceNode { position, pressure: 0.0, traction: [0.0; 2], status: None, held: false });
                nodes.len() - 1
            });
        }
        for (node, normal) in normals(model, facets) {
            let free = model.constraints.dofs.held(node).fold(normal, across);
            nodes[number[node]?].held = norm(free) < HELD * norm(normal);
        }
        let state = step.state;
        let recovered = model.recovered_tractions(state);
        let [sigma_n, sigma_t, sigma_o] = [&state.p_n, &state.p_t, &state.p_o]
            .map(|p| if recovered.is_none() { model.over_weights(|i| p[i]) } else { Vec::new() });
        for &i in &boundary.nodes {
            let contact = &model.contact.nodes[i];
            let [t, o] = contact.facing.tangents;
            let node = &mut nodes[number[contact.node]?];
            (node.pressure, node.traction) = match &recovered {
                None => {
                    let tangential = [0, 1, 2].map(|c| sigma_t[i] * t[c] + sigma_o[i] * o[c]);
                    (sigma_n[i], along(contact.node, tangential))
                }
                Some(all) => {
                    let normal = contact.facing.normal;
                    (dot(all[i], normal), along(contact.node, across(all[i], normal)))
                }
            };
            node.status = Some(step.statuses[i]);
        }
        let facets = facets.iter().map(|facet| facet.iter().filter_map(|&node| number[node]).collect());
        let mut facets: Vec<Vec<usize>> = facets.collect();
        if let Some(cylinder) = &cylinder {
            close(&mut facets, &mut nodes, std::f64::consts::PI * cylinder.radius);
        }
        Some(ContactSurface {
            boundary: (model.contact.boundaries.len() > 1).then(|| boundary.name.clone()),
            index: step.record.index,
            time: step.record.time,
            axes: cylinder.as_ref().map_or(axes, |cylinder| [cylinder.zero[0], cylinder.axis]),
            degree: cylinder.as_ref().map(|cylinder| cylinder.radius.to_radians()),
            facets,
            nodes,
            units: model.units(),
        })
    }
}

fn cylinder(model: &Model, facets: &[Facet]) -> Option<Cylinder> {
    let centre = |facet: &Facet| {
        let sum = facet.iter().fold([0.0; 3], |sum, &node| plus(sum, 1.0, model.mesh.nodes[node]));
        sum.map(|c| c / facet.len() as f64)
    };
    let of: Vec<_> = facets.iter().map(|facet| (centre(facet), model.mesh.area_vector(facet))).collect();
    let nodes: Vec<_> = facets.iter().flatten().map(|&node| model.mesh.nodes[node]).collect();
    Cylinder::of(&of, &nodes)
}

/// Gives the facets across the cut of an unrolled surface, on which half a turn is `half` (m) long, copies of their
/// nodes on the left, a whole turn further to the right.
fn close(facets: &mut [Vec<usize>], nodes: &mut Vec<SurfaceNode>, half: f64) {
    let mut copies = BTreeMap::new();
    for facet in facets {
        let right = facet.iter().map(|&node| nodes[node].position[0]).fold(f64::NEG_INFINITY, f64::max);
        for node in facet {
            if right - nodes[*node].position[0] > half {
                *node = *copies.entry(*node).or_insert_with(|| {
                    let [x, y] = nodes[*node].position;
                    nodes.push(SurfaceNode { position: [x + 2.0 * half, y], ..nodes[*node] });
                    nodes.len() - 1
                });
            }
        }
    }
}

/// Returns the nodes of facets, each with the sum of the area vectors of its facets.
fn normals(model: &Model, facets: &[Facet]) -> BTreeMap<usize, [f64; 3]> {
    let mut normals = BTreeMap::new();
    for facet in facets {
        let area = model.mesh.area_vector(facet);
        for &node in facet {
            let normal = normals.entry(node).or_insert([0.0; 3]);
            *normal = plus(*normal, 1.0, area);
        }
    }
    normals
}

/// A node is held along its normal if supports leave less than this share of the normal free.
const HELD: f64 = 1e-6;

/// Returns the viewing direction: the normal of the obstacle. For several obstacles or an opposing body it is the mean
/// normal, or the first one if the mean vanishes.
fn view(model: &Model, boundary: &ContactBoundary) -> [f64; 3] {
    let normals: Vec<[f64; 3]> = match boundary.pair {
        None => {
            model.contact.obstacles[boundary.obstacles.clone()].iter().map(|(obstacle, _)| obstacle.normal).collect()
        }
        Some(_) => boundary.nodes.iter().map(|&i| model.contact.nodes[i].facing.normal).collect(),
    };
    let [first, others @ ..] = &normals[..] else { return axis(2) };
    let sum = others.iter().fold(*first, |sum, other| plus(sum, 1.0, *other));
    if others.is_empty() || norm(sum) < NOTHING { *first } else { unit(sum) }
}

/// A sum of unit vectors shorter than this counts as zero.
const NOTHING: f64 = 1e-9;

/// Returns two axes perpendicular to `normal` and to each other, as close as possible to positive coordinate axes.
fn axes(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let steepest = (0..3).fold(0, |best, c| if normal[c].abs() > normal[best].abs() { c } else { best });
    let [a, b] = [[1, 2], [0, 2], [0, 1]][steepest];
    let first = axis_across(a, normal);
    let second = cross(normal, first);
    let sign = second[b].signum();
    [first, second.map(|c| sign * c + 0.0)]
}

#[cfg(test)]
mod tests {
    use super::axes;

    #[test]
    fn coordinates_grow_to_the_right_and_upwards() {
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!([axes(z), axes([0.0, 0.0, -1.0])], [[x, y]; 2]);
        assert_eq!([axes(x), axes([-1.0, 0.0, 0.0])], [[y, z]; 2]);
        assert_eq!([axes(y), axes([0.0, -1.0, 0.0])], [[x, z]; 2]);
        let [first, second] = axes([0.6, 0.0, -0.8]);
        assert!((0..3).all(|c| (first[c] - [0.8, 0.0, 0.6][c]).abs() < 1e-15) && second == y, "{first:?} {second:?}");
    }
}
