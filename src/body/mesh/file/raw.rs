//! The mesh of a file of any format, as it is before its elements become cells and boundaries.

use std::collections::{HashMap, HashSet};
use std::fmt;

use crate::algebra::vector::{dot, minus, norm};
use crate::body::mesh::{CellKind, Facet, sorted};

/// The supported kinds of elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum ElementKind {
    Point,
    Line,
    /// A line with a node at its middle.
    Line3,
    Cell(CellKind),
}

impl ElementKind {
    pub(super) fn dimension(self) -> usize {
        match self {
            ElementKind::Point => 0,
            ElementKind::Line | ElementKind::Line3 => 1,
            ElementKind::Cell(kind) => kind.dimension(),
        }
    }

    pub(super) fn nodes(self) -> usize {
        match self {
            ElementKind::Point => 1,
            ElementKind::Line => 2,
            ElementKind::Line3 => 3,
            ElementKind::Cell(kind) => kind.nodes(),
        }
    }

    /// Returns the kind of the sides with so many `nodes` of the cells of a `dimension`.
    pub(super) fn of_side(dimension: usize, nodes: usize) -> Self {
        match (dimension, nodes) {
            (2, 2) => ElementKind::Line,
            (2, _) => ElementKind::Line3,
            _ => {
                let mut flat = CellKind::ALL.into_iter().filter(|kind| kind.dimension() == 2);
                ElementKind::Cell(flat.find(|kind| kind.nodes() == nodes).unwrap_or(CellKind::Triangle))
            }
        }
    }

    /// Returns the nodes of each side of a cell.
    pub(super) fn sides(self) -> &'static [&'static [usize]] {
        match self {
            ElementKind::Cell(kind) => kind.sides(),
            ElementKind::Point | ElementKind::Line | ElementKind::Line3 => &[],
        }
    }
}

impl fmt::Display for ElementKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ElementKind::Point => "point",
            ElementKind::Line => "line",
            ElementKind::Line3 => "line of three nodes",
            ElementKind::Cell(kind) => kind.name(),
        })
    }
}

/// Elements of one kind and of the same groups.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Block {
    pub kind: ElementKind,
    /// The names of the groups that contain the elements.
    pub groups: Vec<String>,
    /// The number of each element in the file, and its nodes, as indices into [`RawMesh::nodes`], in the order of
    /// [`CellKind`].
    pub elements: Vec<(usize, Vec<usize>)>,
}

/// The mesh of a file: nodes, elements of all dimensions and the names of their groups.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct RawMesh {
    /// Coordinates in the file's unit.
    pub nodes: Vec<[f64; 3]>,
    /// The number of each node in the file.
    pub numbers: Vec<usize>,
    pub blocks: Vec<Block>,
    /// The parts of the file that were left aside, in words.
    pub remarks: Vec<String>,
}

impl RawMesh {
    /// Adds an element, its number and its nodes, to the last block if that has its kind and groups, otherwise to a new
    /// one.
    pub(super) fn add(&mut self, kind: ElementKind, groups: Vec<String>, element: (usize, Vec<usize>)) {
        match self.blocks.last_mut() {
            Some(last) if last.kind == kind && last.groups == groups => last.elements.push(element),
            _ => self.blocks.push(Block { kind, groups, elements: vec![element] }),
        }
    }

    /// Removes the nodes that belong to no element of this `dimension`, such as the centres of arcs, and returns their
    /// number. In elements of lower dimension they are replaced by the coincident used node, if there is one, otherwise
    /// by an index beyond the end.
    pub(super) fn leave_out_unused_nodes(&mut self, dimension: usize) -> usize {
        let mut used = vec![false; self.nodes.len()];
        let cells = self.blocks.iter().filter(|block| block.kind.dimension() == dimension);
        cells.flat_map(|block| &block.elements).flat_map(|(_, nodes)| nodes).for_each(|&node| used[node] = true);
        let count = used.iter().filter(|used| **used).count();
        let unused = used.len() - count;
        if unused == 0 {
            return 0;
        }
        let twins = self.twins(&used);
        let (mut next_used, mut next_unused) = (0, count);
        let mut places: Vec<usize> = used
            .iter()
            .map(|&used| {
                let next = if used { &mut next_used } else { &mut next_unused };
                *next += 1;
                *next - 1
            })
            .collect();
        for (unused, twin) in twins {
            places[unused] = places[twin];
        }
        let mut used_nodes = used.iter();
        self.nodes.retain(|_| used_nodes.next() == Some(&true));
        let mut used_nodes = used.iter();
        self.numbers.retain(|_| used_nodes.next() == Some(&true));
        let nodes = self.blocks.iter_mut().flat_map(|block| &mut block.elements).flat_map(|(_, nodes)| nodes);
        nodes.for_each(|node| *node = places[*node]);
        unused
    }

    /// Returns the nodes that are not `used`, each with the coincident used node; copied curves have such nodes. Places
    /// with nodes of several bodies are ambiguous and left out.
    fn twins(&self, used: &[bool]) -> Vec<(usize, usize)> {
        let bound = |c: usize, pick: fn(f64, f64) -> f64| self.nodes.iter().map(|x| x[c]).reduce(pick).unwrap_or(0.0);
        let size = (0..3).map(|c| bound(c, f64::max) - bound(c, f64::min)).fold(0.0, f64::max);
        let near = SAME_PLACE * size;
        // Along a direction that is not that of a lattice, few nodes have the same coordinate.
        let along = |node: usize| dot(self.nodes[node], [0.742, 0.534, 0.406]);
        let mut order: Vec<(f64, usize)> = (0..used.len()).filter(|&k| used[k]).map(|k| (along(k), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let twin = |node: usize| {
            let share = along(node);
            let from = order.partition_point(|(other, _)| *other < share - near);
            let beside = order[from..].iter().take_while(|(other, _)| *other <= share + near);
            let mut there = beside
                .filter(|(_, other)| norm(minus(self.nodes[*other], self.nodes[node])) <= near)
                .map(|(_, other)| *other);
            there.next().filter(|_| there.next().is_none())
        };
        (0..used.len()).filter(|&k| !used[k]).filter_map(|k| Some((k, twin(k)?))).collect()
    }
}

/// The largest distance of coincident nodes, as a share of the size of the mesh. Coordinates are written with about
/// sixteen digits; nine leave room for the errors of the program that made them.
pub(super) const SAME_PLACE: f64 = 1e-9;

/// Reads a finite number, whose exponent may begin with D, as Fortran writes it.
pub(super) fn real(word: &str) -> Option<f64> {
    let value = word.parse().or_else(|_| word.replace(['D', 'd'], "e").parse());
    value.ok().filter(|value: &f64| value.is_finite())
}

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
            let key = sorted(&side.iter().map(|&k| nodes[k]).collect::<Facet>());
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

/// Shortens a line for messages.
pub(super) fn shortened(line: &str) -> String {
    line.trim().chars().take(40).flat_map(char::escape_debug).collect()
}
