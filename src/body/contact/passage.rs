//! Search for bodies that pass through each other because there are no contact rows between them.
//!
//! Contact acts only where a scene defines it, and a node has a row only if something is in front of it within the
//! search distance. Elsewhere bodies may overlap while every law holds. Therefore the nodes on the outside of each
//! displaced body are searched for inside the cells of the others. Nodes that have rows between two bodies, or are in
//! such rows, are left out for these two bodies, since facets may overlap slightly there.
//!
//! A given gap replaces the measured one, such as that of an edge whose rounding is not drawn. The true surface of the
//! slave is then behind the drawn one by the difference, and nodes beside the contact enter the drawn body first.

use std::collections::BTreeSet;

use super::mortar::Mortar;
use super::tree::{Bounds, Tree};
use super::triangles::square_distance;
use crate::algebra::vector::{minus, norm};
use crate::body::fem::is_inside_cell;
use crate::body::mesh::{Facet, Mesh};

/// A node counts only if it has entered a body by more than this share of the deformation of both; less is due to
/// rounding and to the assumption of small displacements.
const COUNTS: f64 = 0.02;

/// The least depth that counts for bodies that do not deform, as a share of the size of the mesh.
const LEAST_DEPTH: f64 = 1e-9;

/// The nodes of a slave facet have rows if more than this share of it is covered.
const COVERED: f64 = 0.5;

/// A node that has entered a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// The number of the node in the mesh.
    pub node: usize,
    /// The body of the node, and the body that it has entered.
    pub bodies: [usize; 2],
    /// The depth inside that body beyond the depth at rest, m.
    pub depth: f64,
    /// The distance of the node from that body at rest, m; 0 if it was inside.
    pub apart: f64,
}

/// The outside of a body: its nodes, facets and cells.
#[derive(Debug, Clone, PartialEq, Default)]
struct Outside {
    nodes: Vec<usize>,
    facets: Vec<Facet>,
    cells: Vec<usize>,
}

/// The bodies and boundaries that may pass through each other.
#[derive(Debug, Clone, PartialEq)]
pub struct Passages {
    bodies: Vec<Outside>,
    /// The nodes in contact rows with a body, each with the number of that body.
    guarded: BTreeSet<(usize, usize)>,
    /// Pairs of boundaries of one body: the number of the body, the nodes of one boundary without rows, and the other
    /// boundary.
    slots: Vec<(usize, Vec<usize>, Outside)>,
    receded: Vec<Receded>,
}

/// A slave node whose given gap exceeds the measured one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Receded {
    node: usize,
    /// The bodies of slave and master.
    bodies: [usize; 2],
    /// The difference, m.
    by: f64,
}

impl Passages {
    /// Creates the search for `mesh`, whose bodies are in contact by `mortars`, each with the gaps (m) of its rows at the
    /// beginning. `None` for a single body without a boundary in front of itself.
    pub fn new<'a>(mesh: &Mesh, mortars: impl Iterator<Item = (&'a Mortar, &'a [f64])>) -> Option<Self> {
        let bodies = mesh.bodies();
        let of = bodies.of_nodes();
        let mut guarded = BTreeSet::new();
        let mut slots = Vec::new();
        let mut receded = Vec::new();
        for (mortar, gaps) in mortars {
            let [slave, master] = mortar.sides();
            let masters: BTreeSet<usize> = master.iter().flatten().map(|&node| of[node]).collect();
            let covered = slave.iter().zip(&mortar.covered).filter(|(_, share)| **share > COVERED);
            let with_rows: BTreeSet<usize> = covered
                .flat_map(|(facet, _)| facet.iter().copied())
                .chain(mortar.rows.iter().map(|row| row.node))
                .collect();
            guarded.extend(with_rows.iter().flat_map(|&node| masters.iter().map(move |&body| (node, body))));
            for (row, gap) in mortar.rows.iter().zip(gaps) {
                guarded.extend(row.master.iter().map(|&(node, _)| (node, of[row.node])));
                let master = row.master.first().map(|&(node, _)| of[node]);
                let recedes = master.filter(|_| *gap > row.gap);
                receded.extend(recedes.map(|master| Receded {
                    node: row.node,
                    bodies: [of[row.node], master],
                    by: gap - row.gap,
                }));
            }
            let own = slave.first().map_or(0, |facet| of[facet[0]]);
            if masters.contains(&own) {
                let nodes: BTreeSet<usize> =
                    slave.iter().flatten().copied().filter(|node| !with_rows.contains(node)).collect();
                let corners: BTreeSet<usize> = master.iter().flatten().copied().collect();
                let at_master = |e: &usize| mesh.cells[*e].nodes.iter().any(|node| corners.contains(node));
                let cells = (0..mesh.cells.len()).filter(at_master).collect();
                let other = Outside { nodes: corners.iter().copied().collect(), facets: master.to_vec(), cells };
                slots.push((own, nodes.into_iter().collect(), other));
            }
        }
        if !bodies.are_several() && slots.is_empty() {
            return None;
        }
        let mut outside = vec![Outside::default(); bodies.count()];
        if bodies.are_several() {
            for (facet, cell) in mesh.surface() {
                outside[bodies.of_cells()[cell]].facets.push(facet);
            }
            for (e, body) in bodies.of_cells().iter().enumerate() {
                outside[*body].cells.push(e);
            }
            for body in &mut outside {
                let nodes: BTreeSet<usize> = body.facets.iter().flatten().copied().collect();
                body.nodes = nodes.into_iter().collect();
            }
        }
        Some(Passages { bodies: outside, guarded, slots, receded })
    }

    /// Returns the node that has entered a body furthest after the nodes of `mesh` have moved by `u` (m), if the depth
    /// counts.
    pub fn deepest(&self, mesh: &Mesh, u: &[[f64; 3]]) -> Option<Passed> {
        let moved = |node: usize| [0, 1, 2].map(|c| mesh.nodes[node][c] + u[node][c]);
        let bounds: Vec<Bounds> = self.bodies.iter().map(|body| bounds(&body.nodes, &moved)).collect();
        let spreads: Vec<f64> = self.bodies.iter().map(|body| spread(&body.nodes, u)).collect();
        let least = LEAST_DEPTH * mesh.size();
        let mut deepest: Option<Passed> = None;
        let mut look = |bodies: [usize; 2], nodes: &[usize], other: &Outside, spread: f64| {
            for (node, depth) in inside(mesh, &moved, nodes, other) {
                let at_rest = |node: usize| mesh.nodes[node];
                let before = inside(mesh, &at_rest, &[node], other).first().map_or(0.0, |(_, depth)| *depth);
                let depth = depth - before;
                let depth = depth - self.recess(mesh, node, bodies, depth);
                if depth > least.max(COUNTS * spread) && deepest.is_none_or(|deepest| depth > deepest.depth) {
                    let apart = if before > 0.0 { 0.0 } else { distances(mesh, &at_rest, &other.facets, &[node])[0] };
                    deepest = Some(Passed { node, bodies, depth, apart });
                }
            }
        };
        for (a, own) in self.bodies.iter().enumerate() {
            for (b, other) in self.bodies.iter().enumerate().filter(|(b, _)| *b != a) {
                if bounds[a].overlaps(&bounds[b]) {
                    let free = |node: &usize| {
                        !self.guarded.contains(&(*node, b)) && bounds[b].overlaps(&Bounds::of(&[moved(*node)]))
                    };
                    let nodes: Vec<usize> = own.nodes.iter().copied().filter(free).collect();
                    look([a, b], &nodes, other, spreads[a].max(spreads[b]));
                }
            }
        }
        for (body, nodes, other) in &self.slots {
            let around = self::bounds(&other.nodes, &moved);
            let nodes: Vec<usize> =
                nodes.iter().copied().filter(|node| around.overlaps(&Bounds::of(&[moved(*node)]))).collect();
            look([*body; 2], &nodes, other, spread(&other.nodes, u));
        }
        deepest
    }

    /// Returns the distance (m) by which the true surface is behind the drawn one at a node of the first body that is
    /// `depth` (m) inside the second: that of the nearest slave node. It is 0 away from the contact.
    fn recess(&self, mesh: &Mesh, node: usize, bodies: [usize; 2], depth: f64) -> f64 {
        let away = |receded: &Receded| norm(minus(mesh.nodes[node], mesh.nodes[receded.node]));
        let ours = |receded: &&Receded| receded.bodies == bodies || receded.bodies == [bodies[1], bodies[0]];
        let nearest = self.receded.iter().filter(ours).min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.filter(|receded| away(receded) <= depth + receded.by).map_or(0.0, |receded| receded.by)
    }
}

fn bounds(nodes: &[usize], at: &dyn Fn(usize) -> [f64; 3]) -> Bounds {
    Bounds::of(&nodes.iter().map(|&node| at(node)).collect::<Vec<_>>())
}

/// Returns the largest deviation of the displacements `u` (m) of `nodes` from their mean, m.
fn spread(nodes: &[usize], u: &[[f64; 3]]) -> f64 {
    let mean = [0, 1, 2].map(|c| nodes.iter().map(|&node| u[node][c]).sum::<f64>() / nodes.len() as f64);
    nodes.iter().map(|&node| norm(minus(u[node], mean))).fold(0.0, f64::max)
}

/// Returns the `nodes` inside the cells of `other`, with their distances from its facets, m.
fn inside(mesh: &Mesh, at: &dyn Fn(usize) -> [f64; 3], nodes: &[usize], other: &Outside) -> Vec<(usize, f64)> {
    if nodes.is_empty() {
        return Vec::new();
    }
    let around = bounds(nodes, at);
    let of_cell = |&e: &usize| (e, bounds(&mesh.cells[e].nodes, at));
    let near: Vec<(usize, Bounds)> =
        other.cells.iter().map(of_cell).filter(|(_, cell)| cell.overlaps(&around)).collect();
    let tree = Tree::new(near.iter().map(|(_, bounds)| *bounds));
    let is_inside = |node: &usize| {
        let x = at(*node);
        let is_in = |k: usize| {
            let cell = &mesh.cells[near[k].0];
            let corners = || cell.nodes.iter().map(|&node| at(node)).collect::<Vec<_>>();
            !cell.nodes.contains(node) && is_inside_cell(cell.kind, &corners(), x)
        };
        tree.around(&Bounds::of(&[x])).any(is_in)
    };
    let found: Vec<usize> = nodes.iter().copied().filter(is_inside).collect();
    let depths = distances(mesh, at, &other.facets, &found);
    found.into_iter().zip(depths).collect()
}

/// Returns the distance of each of `nodes` from `facets`, m.
fn distances(mesh: &Mesh, at: &dyn Fn(usize) -> [f64; 3], facets: &[Facet], nodes: &[usize]) -> Vec<f64> {
    if nodes.is_empty() {
        return Vec::new();
    }
    let triangles_of = |piece: Facet| {
        let corners: Vec<[f64; 3]> = piece.iter().map(|&node| at(node)).collect();
        let last = corners.len() - 1;
        (1..corners.len().max(3) - 1).map(|k| [corners[0], corners[k], corners[(k + 1).min(last)]]).collect::<Vec<_>>()
    };
    let triangles: Vec<[[f64; 3]; 3]> =
        facets.iter().flat_map(|facet| mesh.pieces_of(facet)).flat_map(triangles_of).collect();
    let tree = Tree::new(triangles.iter().map(|corners| Bounds::of(corners)));
    let distance = |node: &usize| {
        let x = at(*node);
        tree.nearest(x, |k| square_distance(&triangles[k], x)).map_or(f64::INFINITY, |(square, _)| square.sqrt())
    };
    nodes.iter().map(distance).collect()
}
