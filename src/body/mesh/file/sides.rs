//! Outer sides of elements, and the sets of nodes that are boundaries.

use std::collections::{HashMap, HashSet};

use super::raw::{ElementKind, RawMesh};
use crate::body::mesh::Facet;

/// An element: its number, its kind and the indices of its nodes.
pub(super) struct Element {
    pub number: usize,
    pub kind: ElementKind,
    pub nodes: Vec<usize>,
}

/// A side: the index of the element and the number of its side from 0.
pub(super) type Side = (usize, usize);

/// Returns the sides of elements of this `dimension` that belong to one element only.
pub(super) fn outer(elements: &[Element], dimension: usize) -> Vec<Side> {
    let mut count: HashMap<Facet, usize> = HashMap::new();
    let mut all = Vec::new();
    for (e, Element { kind, nodes, .. }) in elements.iter().enumerate() {
        for (k, side) in kind.sides().iter().enumerate().filter(|_| kind.dimension() == dimension) {
            let mut key: Facet = side.iter().map(|&k| nodes[k]).collect();
            key.sort_unstable();
            *count.entry(key.clone()).or_default() += 1;
            all.push((key, (e, k)));
        }
    }
    all.into_iter().filter(|(key, _)| count.get(key) == Some(&1)).map(|(_, side)| side).collect()
}

/// Returns the `outer` sides all of whose nodes are in the set `nodes`.
pub(super) fn within(elements: &[Element], outer: &[Side], nodes: &[usize]) -> Vec<Side> {
    let chosen: HashSet<usize> = nodes.iter().copied().collect();
    let whole = |&(e, side): &Side| {
        let Element { kind, nodes, .. } = &elements[e];
        kind.sides()[side].iter().all(|&k| chosen.contains(&nodes[k]))
    };
    outer.iter().copied().filter(whole).collect()
}

/// The remark on a set of `nodes` that is no boundary.
pub(super) fn no_side(mesh: &RawMesh, dimension: usize, name: &str, nodes: &[usize]) -> String {
    let place = |node: &usize| {
        let [x, y, z] = mesh.nodes[*node];
        if dimension == 2 { format!("({x}, {y})") } else { format!("({x}, {y}, {z})") }
    };
    let places: Vec<String> = nodes.iter().take(4).map(place).collect();
    let more = if nodes.len() > 4 { ", ..." } else { "" };
    format!("the node set {name} has no whole side, so that it is no boundary; its nodes: {}{more}", places.join(", "))
}

/// Adds the boundary `name` of these `sides` to the mesh.
pub(super) fn add_boundary(mesh: &mut RawMesh, elements: &[Element], name: &str, sides: &[Side]) {
    for &(e, side) in sides {
        let Element { number, kind, ref nodes } = elements[e];
        let nodes: Facet = kind.sides()[side].iter().map(|&k| nodes[k]).collect();
        mesh.add(ElementKind::of_side(kind.dimension(), nodes.len()), vec![name.to_string()], (number, nodes));
    }
}
