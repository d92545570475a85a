//! The graph of the contact nodes; neighbours share an edge of the contact surface.

use std::collections::{BTreeMap, BTreeSet};

use crate::algebra::union_find::UnionFind;
use crate::algebra::vector::dot;
use crate::body::constraints::SAME_DIRECTION;
use crate::body::contact::{ContactBoundary, ContactNode, MortarRow};
use crate::body::model::Model;

/// The least angle of a corner, rad. A rounded edge of 90 degrees with three elements turns by less at each node.
pub(super) const CORNER: f64 = 40.0 / 180.0 * std::f64::consts::PI;

/// A direction counts as tangential if its component along the normal is smaller than this; symmetry planes may cut a
/// curved surface not quite at right angles.
pub(super) const ALONG: f64 = 0.1;

/// The graph of the contact nodes of a model.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactGraph {
    /// The neighbours of each contact node.
    pub(super) neighbours: Vec<Vec<usize>>,
    /// For each contact node: `true` if it is at the rim of the contact surface and no symmetry plane cuts the surface
    /// there.
    rim: Vec<bool>,
    /// For each contact node: `true` if a symmetry plane or an axis cuts the surface there, so that a support or the
    /// axis holds the node tangentially.
    pub(super) mirrored: Vec<bool>,
    pub(crate) surfaces: Vec<ContactPatch>,
}

/// Boundaries with contact that share nodes, or meet at glue or at the end of a period.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ContactPatch {
    /// The names of the boundaries, separated by commas.
    pub name: String,
    /// The contact nodes, ascending.
    pub nodes: Vec<usize>,
}

/// Returns `true` if a symmetry plane or an axis cuts the surface at a contact node.
fn is_mirrored(model: &Model, contact: &ContactNode) -> bool {
    let in_the_way = |held: &[f64; 3]| dot(*held, contact.facing.normal).abs() < ALONG;
    // In two dimensions, z is held, too.
    let held = match contact.coupled() {
        Some(coupled) => coupled.still.clone(),
        None => model.constraints.dofs.held(contact.node).collect(),
    };
    held.iter().filter(|held| in_the_way(held)).count() > 3 - model.mesh.dimension
}

/// Returns the patches of `boundaries`, of which those that are `together` are one.
fn patches(boundaries: &[ContactBoundary], mut together: UnionFind) -> Vec<ContactPatch> {
    let mut patches: BTreeMap<usize, (Vec<&str>, BTreeSet<usize>)> = BTreeMap::new();
    for (b, boundary) in boundaries.iter().enumerate() {
        let (names, nodes) = patches.entry(together.least(b)).or_default();
        names.push(&boundary.name);
        nodes.extend(&boundary.nodes);
    }
    let patch = |(names, nodes): (Vec<&str>, BTreeSet<usize>)| ContactPatch {
        name: names.join(", "),
        nodes: nodes.into_iter().collect(),
    };
    patches.into_values().map(patch).collect()
}

impl ContactGraph {
    /// Creates the graph of the contact nodes of `model`.
    pub fn new(model: &Model) -> Self {
        let n = model.contact.nodes.len();
        let mut graph = vec![BTreeSet::new(); n];
        let mut link = |i: usize, j: usize| {
            if i != j {
                graph[i].insert(j);
                graph[j].insert(i);
            }
        };
        let mut together = UnionFind::new(model.contact.boundaries.len());
        let mut first_of = vec![None; n];
        for (b, boundary) in model.contact.boundaries.iter().enumerate() {
            for &i in &boundary.nodes {
                together.join(b, *first_of[i].get_or_insert(b));
            }
        }
        // A surface goes on across glue and the end of a period.
        let seams = Seams::new(model);
        let tied: Vec<Vec<usize>> = (0..n).map(|i| seams.tied(model, i)).collect();
        for (i, j) in tied.iter().enumerate().filter_map(|(i, tied)| Some((i, *tied.first()?))) {
            link(i, j);
            if let (Some(b), Some(c)) = (first_of[i], first_of[j]) {
                together.join(b, c);
            }
        }
        let facets_of = |boundary: &ContactBoundary| model.mesh.facets_of(&boundary.name);
        let touching: BTreeSet<usize> =
            model.contact.boundaries.iter().flat_map(facets_of).flatten().copied().collect();
        // The sides of facets, by the contact nodes of their ends, with the facets at each, and those on seams.
        let (mut sides, mut on_seams) = (BTreeMap::<[Vec<usize>; 2], usize>::new(), BTreeSet::new());
        for boundary in &model.contact.boundaries {
            let contact: BTreeMap<usize, usize> =
                boundary.nodes.iter().map(|&i| (model.contact.nodes[i].node, i)).collect();
            let alike = |node: usize| model.constraints.dofs.moving_alike(node);
            let by_motion: BTreeMap<usize, usize> = contact.iter().map(|(&node, &i)| (alike(node), i)).collect();
            let own = |node: usize| contact.get(&node).or_else(|| by_motion.get(&alike(node))).copied();
            for facet in facets_of(boundary) {
                let closed = facet.len() > 2 && model.mesh.dimension == 3;
                let ends = if closed { facet.len() } else { facet.len() - 1 };
                for k in 0..ends {
                    let ends = [facet[k], facet[(k + 1) % facet.len()]];
                    let mut side = ends.map(|node| seams.carriers(node, &own));
                    let goes_on = |(node, at): (&usize, &Vec<usize>)| match contact.get(node) {
                        Some(&i) => !tied[i].is_empty() || alike(*node) != *node && touching.contains(&alike(*node)),
                        None => !at.is_empty(),
                    };
                    if seams.has(ends) && ends.iter().zip(&side).all(goes_on) {
                        let at = side.concat();
                        let all = at.iter().flat_map(|&i| tied[i].iter().copied().chain([i])).collect::<Vec<_>>();
                        on_seams.extend(all.iter().flat_map(|&i| all.iter().map(move |&j| [i, j])));
                        if side.iter().any(|at| at.len() > 1) {
                            continue;
                        }
                    }
                    if let ([i, ..], [j, ..]) = (&side[0][..], &side[1][..]) {
                        link(*i, *j);
                        side.sort_unstable();
                        *sides.entry(side).or_default() += 1;
                    }
                }
            }
        }
        let mirrored: Vec<bool> = model.contact.nodes.iter().map(|contact| is_mirrored(model, contact)).collect();
        let rim = if model.mesh.dimension == 2 {
            (0..n).map(|i| graph[i].len() < 2 && !mirrored[i]).collect()
        } else {
            let mut rim = vec![false; n];
            let only_node = |at: &Vec<usize>| Some(at[0]).filter(|_| at.len() == 1);
            for (side, _) in sides.iter().filter(|(_, facets)| **facets == 1) {
                let [a, b] = side.each_ref().map(only_node);
                if !a.zip(b).is_some_and(|(a, b)| on_seams.contains(&[a, b])) {
                    a.into_iter().chain(b).for_each(|i| rim[i] = !mirrored[i]);
                }
            }
            rim
        };
        ContactGraph {
            neighbours: graph.into_iter().map(|all| all.into_iter().collect()).collect(),
            rim,
            mirrored,
            surfaces: patches(&model.contact.boundaries, together),
        }
    }

    /// Returns the sum of the normal forces `p_n` (n_c, N) on each surface.
    pub(crate) fn forces(&self, p_n: &[f64]) -> impl Iterator<Item = f64> {
        self.surfaces.iter().map(|surface| surface.nodes.iter().map(|&i| p_n[i]).sum())
    }

    /// Returns `true` if the contact surface ends at contact node `i`; it does not end at a symmetry plane.
    pub fn is_at_the_rim(&self, i: usize) -> bool {
        self.rim.get(i).copied().unwrap_or(false)
    }

    /// Returns the mean pressure (Pa) of the forces `p_n` (N) on contact node `i` and its neighbours: `Σ p_n / Σ l`.
    pub(super) fn patch_pressure(&self, model: &Model, p_n: &[f64], i: usize) -> f64 {
        let around = || self.neighbours[i].iter().chain([&i]);
        around().map(|&j| p_n[j]).sum::<f64>() / around().map(|&j| model.contact.nodes[j].weight).sum::<f64>()
    }

    /// Returns the patch pressures of all contact nodes.
    pub(crate) fn patch_pressures(&self, model: &Model, p_n: &[f64]) -> Vec<f64> {
        (0..self.neighbours.len()).map(|i| self.patch_pressure(model, p_n, i)).collect()
    }

    /// Returns the contact nodes that are closed by the forces `p_n` (N) and have no closed neighbour.
    pub(crate) fn isolated(&self, p_n: &[f64]) -> impl Iterator<Item = usize> {
        let is_isolated = |i: &usize| p_n[*i] > 0.0 && self.neighbours[*i].iter().all(|&j| p_n[j] <= 0.0);
        (0..self.neighbours.len()).filter(is_isolated)
    }

    /// Returns the connected components of `nodes`, each in ascending order.
    pub(super) fn components(&self, nodes: &[usize]) -> Vec<Vec<usize>> {
        let mut left: BTreeSet<usize> = nodes.iter().copied().collect();
        let mut components = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut component = vec![first];
            let mut next = 0;
            while next < component.len() {
                let beside = self.neighbours[component[next]].iter().copied();
                let new: Vec<usize> = beside.filter(|i| left.remove(i)).collect();
                component.extend(new);
                next += 1;
            }
            component.sort_unstable();
            components.push(component);
        }
        components
    }

    /// Returns the number of edges from each of `nodes` to the nearest other node of the surface; the rim does not
    /// count. Nodes without a path are left out.
    pub(super) fn depths(&self, surface: &[usize], nodes: &[usize]) -> BTreeMap<usize, usize> {
        let inside: BTreeSet<usize> = nodes.iter().copied().collect();
        let mut depths: BTreeMap<usize, usize> = BTreeMap::new();
        let mut at: Vec<usize> = surface.iter().copied().filter(|i| !inside.contains(i)).collect();
        let mut depth = 0;
        while !at.is_empty() {
            depth += 1;
            let mut next = Vec::new();
            for &i in at.iter().flat_map(|&i| &self.neighbours[i]) {
                if inside.contains(&i) && !depths.contains_key(&i) {
                    depths.insert(i, depth);
                    next.push(i);
                }
            }
            at = next;
        }
        depths
    }
}

/// The nodes that glue and periodic boundaries tie to others, for each of them.
struct Seams(Vec<BTreeMap<usize, Vec<usize>>>);

impl Seams {
    fn new(model: &Model) -> Self {
        let masters = |row: &MortarRow| {
            let mut sharing: Vec<_> = row.master.iter().filter(|(_, share)| share.abs() > SAME_DIRECTION).collect();
            sharing.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
            (row.node, sharing.into_iter().map(|(node, _)| *node).collect())
        };
        let glued = model.contact.pairs.iter().filter(|pair| pair.glued);
        Seams(glued.map(|pair| pair.mortar.rows.iter().map(masters).collect()).collect())
    }

    /// Returns `true` if one seam ties both `ends` of a side.
    fn has(&self, ends: [usize; 2]) -> bool {
        self.0.iter().any(|seam| ends.iter().all(|node| seam.contains_key(node)))
    }

    /// Returns the nodes to which `node` is tied; in each seam the one with the largest share is first.
    fn masters(&self, node: usize) -> impl Iterator<Item = usize> {
        self.0.iter().filter_map(move |seam| seam.get(&node)).flatten().copied()
    }

    /// Returns the contact nodes that carry `node`: its `own`, or those to which it is tied, by one tie or several.
    fn carriers(&self, node: usize, own: &dyn Fn(usize) -> Option<usize>) -> Vec<usize> {
        let (mut at, mut found) = (vec![node], Vec::new());
        for _ in 0..=self.0.len() {
            let (with, without): (Vec<usize>, Vec<usize>) = at.into_iter().partition(|node| own(*node).is_some());
            found.extend(with.into_iter().filter_map(own));
            at = without.into_iter().flat_map(|node| self.masters(node)).collect();
        }
        let mut known = BTreeSet::new();
        found.retain(|i| known.insert(*i));
        found
    }

    /// Returns the contact nodes to which contact node `i` is tied and whose normals are about its own.
    fn tied(&self, model: &Model, i: usize) -> Vec<usize> {
        let own = &model.contact.nodes[i];
        let goes_on = |other: &ContactNode| dot(own.facing.normal, other.facing.normal) > CORNER.cos();
        let others = |node: usize| model.contact.nodes.iter().enumerate().filter(move |(_, other)| other.node == node);
        let all = self.masters(own.node).flat_map(others);
        all.filter(|(_, other)| goes_on(other)).map(|(j, _)| j).collect()
    }
}
