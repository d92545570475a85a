//! Is a mesh sound? Inverted, degenerate, overlapping and loosely connected cells, unused and coincident nodes.

use std::fmt::Write;

use super::sides::{Joint, unmatched};
use super::{Cell, Jacobian, Mesh, fine_quadrature, quadrature_of};
use crate::algebra::vector::{cross, dot, minus};

/// Corner determinants and distances below this, relative to the size of the cell or body, are zero up to
/// the rounding of coordinates: these have about sixteen digits, and a cell of size 1e-6 of the body
/// loses six of them.
const NEGLIGIBLE: f64 = 1e-9;

/// The numbers of cells and nodes in the file they come from, for messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers<'a> {
    /// Of each cell.
    pub cells: &'a [usize],
    /// Of each node.
    pub nodes: &'a [usize],
}

/// What is wrong with a mesh. Numbers are those of its file; without a file they count from 0, the elements of a
/// boundary within that boundary.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshFault {
    /// A mesh without cells.
    #[error("the mesh has no elements")]
    Empty,
    /// Coordinates that are nan or infinite.
    #[error("the coordinates of these nodes are not finite: {}", list(.0))]
    NotFinite(Vec<usize>),
    /// Nodes of a plane mesh off the plane z = 0.
    #[error("the mesh is plane, but these nodes have z other than 0: {}", list(.0))]
    OutOfPlane(Vec<usize>),
    /// A mesh in space for the section of a body of revolution.
    #[error("the mesh has three dimensions, so that it is no section of a body of revolution")]
    NoSection,
    /// Nodes of the section of a body of revolution on the other side of its axis.
    #[error("x is the distance from the axis, but negative at these nodes: {}", list(.0))]
    LeftOfAxis(Vec<usize>),
    /// A cell of another dimension than the mesh.
    #[error("element {element} has {cell} dimensions, but the mesh has {mesh}")]
    Dimensions {
        /// The cell.
        element: usize,
        /// Its dimension.
        cell: usize,
        /// That of the mesh.
        mesh: usize,
    },
    /// A cell with too few corners, or too many.
    #[error("element {element} has {given} nodes, but its kind has {needed}")]
    Corners {
        /// The cell.
        element: usize,
        /// How many nodes it names.
        given: usize,
        /// How many its kind has.
        needed: usize,
    },
    /// Cells with nodes at the middles of their edges beside others without, in one body.
    #[error("element {} is of another order than element {}: one has nodes at the middles of its edges", .elements.1, .elements.0)]
    MixedOrders {
        /// The cells.
        elements: (usize, usize),
    },
    /// A cell with a node that is not there.
    #[error("element {element} names the node {node}, but there are {nodes} nodes, counted from 0")]
    NoNode {
        /// The cell.
        element: usize,
        /// The node it names.
        node: usize,
        /// How many there are.
        nodes: usize,
    },
    /// A cell of a group that is not there.
    #[error("element {element} is of group {group}, but there are {groups} groups, counted from 0")]
    NoGroup {
        /// The cell.
        element: usize,
        /// The group it names.
        group: usize,
        /// How many there are.
        groups: usize,
    },
    /// Two boundaries of one name.
    #[error("two boundaries have the name `{0}`")]
    RepeatedName(String),
    /// A facet with its outside on the wrong side.
    #[error("element {element} of the boundary `{boundary}` runs the wrong way round")]
    TurnedFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
    },
    /// Cells of negative volume, at one corner at least.
    #[error("the {} inverted: their corners run the wrong way round", elements(.0))]
    Inverted(Vec<usize>),
    /// Cells without volume, at one corner at least.
    #[error("the {} degenerate: without volume at a corner", elements(.0))]
    Degenerate(Vec<usize>),
    /// Cells whose curved edges turn them inside out, or leave no volume, at a node or an integration point.
    #[error("the {} folded: inside out, or without volume, at a node or an integration point", elements(.0))]
    Folded(Vec<usize>),
    /// Nodes that belong to no cell.
    #[error("nodes belong to no element of the body: {}", list(.0))]
    UnusedNodes(Vec<usize>),
    /// Two nodes of one body in one place.
    #[error("nodes coincide in pairs: {}", pairs(.0))]
    CoincidentNodes(Vec<(usize, usize)>),
    /// Two cells on the same side of a facet of both.
    #[error("elements lie on one another, in pairs: {}", pairs(.0))]
    Overlapping(Vec<(usize, usize)>),
    /// Cells that meet in a quadrilateral of the one and in triangles of the other.
    #[error("elements meet in a side that is a quadrilateral of one and triangles of the other, in pairs: {}", pairs(.0))]
    Unmatched(Vec<(usize, usize)>),
    /// Parts of a body that share nodes, but no whole side.
    #[error(
        "the body is in {} pieces that share no whole side, an element of each: {}; two of them only touch at node {node}",
        .elements.len(), list(.elements)
    )]
    Jointed {
        /// An element of each.
        elements: Vec<usize>,
        /// A node of two of them.
        node: usize,
    },
    /// A facet of a boundary between two cells.
    #[error("element {element} of the boundary `{boundary}` lies inside the body, between two elements")]
    InnerFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
    },
    /// A facet that a boundary has twice.
    #[error("the elements {} and {} of the boundary `{boundary}` are the same facet", .elements.0, .elements.1)]
    RepeatedFacet {
        /// The boundary.
        boundary: String,
        /// The elements of the facet.
        elements: (usize, usize),
    },
    /// A facet of a boundary that is no side of a cell.
    #[error("element {element} of the boundary `{boundary}` is no side of any element of the body")]
    LooseFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
    },
}

fn elements(numbers: &[usize]) -> String {
    let (s, are) = if numbers.len() == 1 { ("", "is") } else { ("s", "are") };
    format!("element{s} {} {are}", list(numbers))
}

fn pairs(pairs: &[(usize, usize)]) -> String {
    list(&pairs.iter().map(|(a, b)| format!("{a} and {b}")).collect::<Vec<_>>())
}

/// The first few of a list, in words.
fn list<T: ToString>(items: &[T]) -> String {
    let shown: Vec<String> = items.iter().take(5).map(ToString::to_string).collect();
    let mut text = shown.join(", ");
    if items.len() > shown.len() {
        // Writing to a string cannot fail.
        let _ = write!(text, " and {} more", items.len() - shown.len());
    }
    text
}

impl MeshFault {
    /// What mends the fault, in words.
    pub fn help(&self) -> &'static str {
        match self {
            MeshFault::Empty => "give the cells of the body",
            MeshFault::NotFinite(_) => "give coordinates other than nan or inf",
            MeshFault::OutOfPlane(_) => "give z = 0 in two dimensions; a body in space needs cells with a volume",
            MeshFault::NoSection => "give a mesh of two dimensions, x from the axis and y along it",
            MeshFault::LeftOfAxis(_) => "mesh one half of the section, on the side where x is positive",
            MeshFault::Dimensions { .. } => "let all cells be plane, or all have a volume",
            MeshFault::Corners { .. } => {
                "give 3 nodes of a triangle, 4 of a quadrilateral or tetrahedron, 8 of a hexahedron; of second order 6 of a \
                 triangle, 10 of a tetrahedron"
            }
            MeshFault::NoNode { .. } => "number nodes from 0 on",
            MeshFault::NoGroup { .. } => "number groups from 0 on; without names there is the one group 0",
            MeshFault::RepeatedName(_) => "give every boundary a name of its own",
            MeshFault::TurnedFacet { .. } => "make the mesh by Mesh::new, which turns facets",
            MeshFault::Inverted(_) => "mesh it again; in arrays, number the corners of the cells the other way round",
            MeshFault::Degenerate(_) => "mesh again; look for slivers, and for edges or angles of zero size",
            MeshFault::Folded(_) => {
                "make elements smaller where the surface is curved, or let Gmsh straighten them (Mesh.HighOrderOptimize = 2); look \
                 at the order of their nodes, too"
            }
            MeshFault::MixedOrders { .. } => "mesh the whole body with one order (Mesh.ElementOrder)",
            MeshFault::UnusedNodes(_) => "put only lines, surfaces and volumes of the body into physical groups",
            MeshFault::CoincidentNodes(_) => {
                "join the parts in Gmsh (Coherence, or Coherence Mesh) and mesh again; only bodies that share no node can be in contact"
            }
            MeshFault::Overlapping(_) | MeshFault::RepeatedFacet { .. } => {
                "look for parts that are there twice, join them in Gmsh (Coherence, or Coherence Mesh) and mesh again"
            }
            MeshFault::Unmatched(_) => {
                "let quadrilaterals meet quadrilaterals: mesh both parts with triangles on the surface that they share, or both with \
                 quadrilaterals (Mesh.RecombineAll)"
            }
            MeshFault::Jointed { .. } => {
                "join the parts along whole edges (in space, faces) in Gmsh: at a node or an edge alone they could turn"
            }
            MeshFault::InnerFacet { .. } => {
                "name a physical group of the outer surface (in two dimensions, of the outline); where two bodies are to touch, \
                 the mesh joins them: leave out Coherence, BooleanFragments and Coherence Mesh, so that each has nodes of its own, \
                 or separate the nodes with Plugin(Crack)"
            }
            MeshFault::LooseFacet { .. } => {
                "name a physical group of the outer surface (in two dimensions, of the outline) of what is meshed with volume \
                 elements (in two dimensions, surface elements); a copy of its curves or surfaces in the same place is no part of it: remove \
                 the copy (Coherence)"
            }
        }
    }
}

impl Mesh {
    /// Whether the mesh is sound, however it was made: cells that are whole and of positive volume, bodies that hang together by
    /// whole sides, and boundaries on its outside. Nodes of different bodies may be in one place.
    ///
    /// # Errors
    /// The first fault found, with all cells or nodes that have it, counted from 0.
    pub fn check(&self) -> Result<(), MeshFault> {
        self.check_indices()?;
        let all: Vec<usize> = (0..self.nodes.len().max(self.cells.len())).collect();
        self.check_cells(&Numbers { cells: &all, nodes: &all })?;
        self.check_boundaries()
    }

    /// Whether the cells, which name nodes that are there, are sound.
    pub(super) fn check_cells(&self, numbers: &Numbers<'_>) -> Result<(), MeshFault> {
        let named = |bad: &mut dyn Iterator<Item = usize>| bad.map(|e| numbers.cells[e]).collect::<Vec<usize>>();
        let quadratic = |e: usize| self.cells[e].kind.is_quadratic();
        let bodies = self.bodies();
        let mut first_of = vec![None; bodies.count()];
        for (e, &body) in bodies.of_cells().iter().enumerate() {
            let first = *first_of[body].get_or_insert(e);
            if quadratic(e) != quadratic(first) {
                return Err(MeshFault::MixedOrders { elements: (numbers.cells[first], numbers.cells[e]) });
            }
        }
        let is = |e: &usize, sound: fn(f64, f64) -> bool| {
            self.corner_volumes(&self.cells[*e]).iter().any(|&(volume, size)| sound(volume, NEGLIGIBLE * size))
        };
        let inverted = named(&mut (0..self.cells.len()).filter(|e| is(e, |volume, least| volume < -least)));
        if !inverted.is_empty() {
            return Err(MeshFault::Inverted(inverted));
        }
        let degenerate = named(&mut (0..self.cells.len()).filter(|e| is(e, |volume, least| volume <= least)));
        if !degenerate.is_empty() {
            return Err(MeshFault::Degenerate(degenerate));
        }
        let folded = named(&mut (0..self.cells.len()).filter(|&e| self.is_folded(&self.cells[e])));
        if !folded.is_empty() {
            return Err(MeshFault::Folded(folded));
        }
        let mut used = vec![false; self.nodes.len()];
        self.cells.iter().flat_map(|cell| &cell.nodes).for_each(|&node| used[node] = true);
        let unused: Vec<usize> = (0..used.len()).filter(|&k| !used[k]).map(|k| numbers.nodes[k]).collect();
        if !unused.is_empty() {
            return Err(MeshFault::UnusedNodes(unused));
        }
        let numbered =
            |all: &[usize], pairs: Vec<(usize, usize)>| pairs.iter().map(|&(a, b)| (all[a], all[b])).collect();
        let of = bodies.of_nodes();
        let coincident = self.coincident_nodes(of);
        if !coincident.is_empty() {
            return Err(MeshFault::CoincidentNodes(numbered(numbers.nodes, coincident)));
        }
        let sides = self.sides().map_err(|pairs| MeshFault::Overlapping(numbered(numbers.cells, pairs)))?;
        let unmatched = unmatched(&sides);
        if !unmatched.is_empty() {
            return Err(MeshFault::Unmatched(numbered(numbers.cells, unmatched)));
        }
        match self.joint(&sides, bodies.of_cells()) {
            Some(Joint { cells, node }) => {
                Err(MeshFault::Jointed { elements: named(&mut cells.into_iter()), node: numbers.nodes[node] })
            }
            None => Ok(()),
        }
    }

    /// For each corner of `cell`, the area (m²) or volume (m³) that its edges span, with its sign, and the
    /// square or cube of the longest of all edges at corners.
    pub(super) fn corner_volumes(&self, cell: &Cell) -> Vec<(f64, f64)> {
        let points = self.points(&cell.nodes);
        let neighbours = cell.kind.properties().neighbours;
        let corners = neighbours.iter().enumerate().map(|(k, others)| {
            let edges: Vec<[f64; 3]> = others.iter().map(|&other| minus(points[other], points[k])).collect();
            let span = cross(edges[0], edges[1]);
            edges.get(2).map_or(span[2], |third| dot(span, *third))
        });
        let corners: Vec<f64> = corners.collect();
        let edge = |k: usize| neighbours[k].iter().map(|&other| minus(points[other], points[k])).collect::<Vec<_>>();
        let longest = (0..neighbours.len()).flat_map(edge).map(|edge| dot(edge, edge)).fold(0.0, f64::max).sqrt();
        let size = longest.powi(cell.kind.dimension() as i32);
        corners.into_iter().map(|volume| (volume, size)).collect()
    }

    /// Whether the map of a cell of second order, whose corners are sound, is not so at a node or an integration point.
    fn is_folded(&self, cell: &Cell) -> bool {
        if !cell.kind.is_quadratic() {
            return false;
        }
        let points = self.points(&cell.nodes);
        let size = self.corner_volumes(cell).iter().fold(0.0_f64, |m, (_, size)| m.max(*size));
        let nodes = (0..cell.kind.nodes()).map(|k| cell.kind.reference_node(k));
        let rules = [quadrature_of(cell.kind, self.geometry, &points), fine_quadrature(cell.kind)];
        let inner = rules.iter().flatten().map(|(point, _)| *point);
        nodes.chain(inner).any(|at| Jacobian::new(cell.kind, at, &points).determinant <= NEGLIGIBLE * size)
    }

    /// Nodes of one body in one place, `of` being the bodies of all nodes: each with the next of them, so that a stack of n nodes makes
    /// n - 1 pairs.
    fn coincident_nodes(&self, of: &[usize]) -> Vec<(usize, usize)> {
        // Body by body, so that in a stack of nodes of many bodies none is looked at in vain.
        let mut order = self.in_order();
        order.sort_by_key(|&(_, node)| of[node]);
        let near = self.near();
        order.chunk_by(|a, b| of[a.1] == of[b.1]).flat_map(|body| self.pairs_in(body, near, |_, _| true)).collect()
    }

    /// The nodes along a direction of no lattice, with where they are: few share a place, so few pairs have to be looked at.
    pub(super) fn in_order(&self) -> Vec<(f64, usize)> {
        let along = |x: [f64; 3]| dot(x, [0.742, 0.534, 0.406]);
        let mut order: Vec<(f64, usize)> = self.nodes.iter().enumerate().map(|(k, &x)| (along(x), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order
    }

    /// Nodes that are no farther apart are in one place, m.
    pub(super) fn near(&self) -> f64 {
        NEGLIGIBLE * self.size()
    }

    /// Nodes that are as `near` as in one place and a pair for `paired`, each with the next of them in this `order`.
    pub(super) fn pairs_in(
        &self,
        order: &[(f64, usize)],
        near: f64,
        paired: impl Fn(usize, usize) -> bool,
    ) -> Vec<(usize, usize)> {
        let mut pairs = Vec::new();
        for (k, &(s, a)) in order.iter().enumerate() {
            for &(_, b) in order[k + 1..].iter().take_while(|(t, _)| t - s <= near) {
                let apart = minus(self.nodes[b], self.nodes[a]);
                if dot(apart, apart) <= near * near && paired(a, b) {
                    pairs.push((a.min(b), a.max(b)));
                    break;
                }
            }
        }
        pairs
    }
}
