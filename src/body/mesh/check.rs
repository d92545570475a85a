//! Meshes from arrays, and the checks of a mesh for inverted, degenerate, overlapping and loosely connected cells and for
//! unused and coincident nodes.

use std::collections::HashSet;
use std::fmt::Write;

use super::sides::{Joint, Outline, from_least};
use super::{Boundary, Cell, Geometry, Jacobian, Mesh, Notes, fine_quadrature, quadrature_of};
use crate::algebra::vector::{cross, dot, minus};

/// Corner determinants and distances below this, relative to the size of the cell or body, count as rounding of
/// coordinates. Coordinates have about sixteen digits, and a cell of size 1e-6 of the body loses six of them.
const NEGLIGIBLE: f64 = 1e-9;

/// The numbers of cells and nodes in the file they come from, for messages.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers<'a> {
    /// The number of each cell.
    pub cells: &'a [usize],
    /// The number of each node.
    pub nodes: &'a [usize],
}

/// The fault of an invalid mesh. Numbers are those of its file; without a file they count from 0, for elements of a
/// boundary within that boundary.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshFault {
    /// The mesh has no cells.
    #[error("the mesh has no elements")]
    Empty,
    /// Coordinates are NaN or infinite.
    #[error("the coordinates of these nodes are not finite: {}", list(.0))]
    NotFinite(Vec<usize>),
    /// Nodes of a plane mesh are off the plane z = 0.
    #[error("the mesh is plane, but these nodes have z other than 0: {}", list(.0))]
    OutOfPlane(Vec<usize>),
    /// The section of a body of revolution has three dimensions.
    #[error("the mesh has three dimensions, so that it is no section of a body of revolution")]
    NoSection,
    /// Nodes of the section of a body of revolution are on the wrong side of the axis.
    #[error("x is the distance from the axis, but negative at these nodes: {}", list(.0))]
    LeftOfAxis(Vec<usize>),
    /// The dimension of a cell differs from that of the mesh.
    #[error("element {element} has {cell} dimensions, but the mesh has {mesh}")]
    Dimensions {
        /// The cell.
        element: usize,
        /// Its dimension.
        cell: usize,
        /// The dimension of the mesh.
        mesh: usize,
    },
    /// The number of nodes of a cell is wrong.
    #[error("element {element} has {given} nodes, but its kind has {needed}")]
    Corners {
        /// The cell.
        element: usize,
        /// The number of nodes given.
        given: usize,
        /// The number of nodes of its kind.
        needed: usize,
    },
    /// Cells with and without nodes at the middles of their edges are in one body.
    #[error("element {} is of another order than element {}: one has nodes at the middles of its edges", .elements.1, .elements.0)]
    MixedOrders {
        /// The cells.
        elements: (usize, usize),
    },
    /// A cell refers to a missing node.
    #[error("element {element} names the node {node}, but there are {nodes} nodes, counted from 0")]
    NoNode {
        /// The cell.
        element: usize,
        /// The missing node.
        node: usize,
        /// The number of nodes.
        nodes: usize,
    },
    /// A cell refers to a missing group.
    #[error("element {element} is of group {group}, but there are {groups} groups, counted from 0")]
    NoGroup {
        /// The cell.
        element: usize,
        /// The missing group.
        group: usize,
        /// The number of groups.
        groups: usize,
    },
    /// Two boundaries have the same name.
    #[error("two boundaries have the name `{0}`")]
    RepeatedName(String),
    /// The orientation of a facet is wrong.
    #[error("element {element} of the boundary `{boundary}` runs the wrong way round")]
    TurnedFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
    },
    /// Cells have a negative volume at one corner at least.
    #[error("the {} inverted: their corners run the wrong way round", elements(.0))]
    Inverted(Vec<usize>),
    /// Cells have no volume at one corner at least.
    #[error("the {} degenerate: without volume at a corner", elements(.0))]
    Degenerate(Vec<usize>),
    /// Curved edges make the volume of cells negative or zero at a node or an integration point.
    #[error("the {} folded: inside out, or without volume, at a node or an integration point", elements(.0))]
    Folded(Vec<usize>),
    /// Nodes belong to no cell.
    #[error("nodes belong to no element of the body: {}", list(.0))]
    UnusedNodes(Vec<usize>),
    /// Nodes of one body coincide.
    #[error("nodes coincide in pairs: {}", pairs(.0))]
    CoincidentNodes(Vec<(usize, usize)>),
    /// Two cells are on the same side of a common facet.
    #[error("elements lie on one another, in pairs: {}", pairs(.0))]
    Overlapping(Vec<(usize, usize)>),
    /// A quadrilateral side of a cell meets triangular sides of others.
    #[error("elements meet in a side that is a quadrilateral of one and triangles of the other, in pairs: {}", pairs(.0))]
    Unmatched(Vec<(usize, usize)>),
    /// Parts of a body share nodes but no whole side.
    #[error(
        "the body is in {} pieces that share no whole side, an element of each: {}; two of them only touch at node {node}",
        .elements.len(), list(.elements)
    )]
    Jointed {
        /// An element of each part.
        elements: Vec<usize>,
        /// A node that two of them share.
        node: usize,
    },
    /// A facet of a boundary is between two cells.
    #[error("element {element} of the boundary `{boundary}` lies inside the body, between two elements")]
    InnerFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
    },
    /// A boundary contains a facet twice.
    #[error("the elements {} and {} of the boundary `{boundary}` are the same facet", .elements.0, .elements.1)]
    RepeatedFacet {
        /// The boundary.
        boundary: String,
        /// The elements of the facet.
        elements: (usize, usize),
    },
    /// A facet of a boundary is not a side of a cell.
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

/// Formats the first few items of a list.
fn list<T: ToString>(items: &[T]) -> String {
    let shown: Vec<String> = items.iter().take(5).map(ToString::to_string).collect();
    let mut text = shown.join(", ");
    if items.len() > shown.len() {
        // Writing to a string cannot fail.
        let _ = write!(text, " and {} more", items.len() - shown.len());
    }
    text
}

/// Fails with a fault of the cells or nodes that were `found`, if there are any.
pub(super) fn none<T>(found: Vec<T>, fault: fn(Vec<T>) -> MeshFault) -> Result<(), MeshFault> {
    if found.is_empty() { Ok(()) } else { Err(fault(found)) }
}

impl MeshFault {
    /// Returns the correction, in words.
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
                 triangle, 8 or 9 of a quadrilateral, 10 of a tetrahedron, 15 of a prism, 20 of a hexahedron"
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
    /// Checks the mesh: cells must be complete and have positive volumes, bodies must be connected by whole sides, and
    /// boundaries must be on the outside. Nodes of different bodies may coincide.
    ///
    /// # Errors
    /// The first fault found, with all cells or nodes concerned, counted from 0.
    pub fn check(&self) -> Result<(), MeshFault> {
        self.check_indices()?;
        let all: Vec<usize> = (0..self.nodes.len().max(self.cells.len())).collect();
        self.check_cells(&Numbers { cells: &all, nodes: &all })?;
        self.check_boundaries()
    }

    /// Checks the cells, whose nodes must exist.
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
        let is = |e: &usize, is_valid: fn(f64, f64) -> bool| {
            self.corner_volumes(&self.cells[*e]).iter().any(|&(volume, size)| is_valid(volume, NEGLIGIBLE * size))
        };
        let inverted = named(&mut (0..self.cells.len()).filter(|e| is(e, |volume, least| volume < -least)));
        none(inverted, MeshFault::Inverted)?;
        let degenerate = named(&mut (0..self.cells.len()).filter(|e| is(e, |volume, least| volume <= least)));
        none(degenerate, MeshFault::Degenerate)?;
        let folded = named(&mut (0..self.cells.len()).filter(|&e| self.is_folded(&self.cells[e])));
        none(folded, MeshFault::Folded)?;
        let mut used = vec![false; self.nodes.len()];
        self.cells.iter().flat_map(|cell| &cell.nodes).for_each(|&node| used[node] = true);
        let unused: Vec<usize> = (0..used.len()).filter(|&k| !used[k]).map(|k| numbers.nodes[k]).collect();
        none(unused, MeshFault::UnusedNodes)?;
        let numbered =
            |all: &[usize], pairs: Vec<(usize, usize)>| pairs.iter().map(|&(a, b)| (all[a], all[b])).collect();
        let of = bodies.of_nodes();
        none(numbered(numbers.nodes, self.coincident_nodes(of)), MeshFault::CoincidentNodes)?;
        let sides = self.sides().map_err(|pairs| MeshFault::Overlapping(numbered(numbers.cells, pairs)))?;
        none(numbered(numbers.cells, self.unmatched(&sides)), MeshFault::Unmatched)?;
        match self.joint(&sides, bodies.of_cells()) {
            Some(Joint { cells, node }) => {
                Err(MeshFault::Jointed { elements: named(&mut cells.into_iter()), node: numbers.nodes[node] })
            }
            None => Ok(()),
        }
    }

    /// Computes for each corner of `cell` the signed area (m²) or volume (m³) that its edges span, and the square or
    /// cube of the longest edge.
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

    /// Returns `true` if the map of a cell of second order with valid corners is invalid at a node or an integration
    /// point.
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

    /// Finds coincident nodes of one body, where `of` is the body of each node. Each node is paired with the next one,
    /// so that n coincident nodes are n - 1 pairs.
    fn coincident_nodes(&self, of: &[usize]) -> Vec<(usize, usize)> {
        // The search is body by body, so that coincident nodes of many bodies cost no time.
        let mut order = self.in_order();
        order.sort_by_key(|&(_, node)| of[node]);
        let near = self.near();
        order.chunk_by(|a, b| of[a.1] == of[b.1]).flat_map(|body| self.pairs_in(body, near, |_, _| true)).collect()
    }

    /// Returns the nodes in order along a direction, with their coordinate along it. The direction is not that of a
    /// lattice, so that few nodes have the same coordinate and few pairs are compared.
    pub(super) fn in_order(&self) -> Vec<(f64, usize)> {
        let along = |x: [f64; 3]| dot(x, [0.742, 0.534, 0.406]);
        let mut order: Vec<(f64, usize)> = self.nodes.iter().enumerate().map(|(k, &x)| (along(x), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order
    }

    /// Returns the largest distance of coincident nodes, m.
    pub(super) fn near(&self) -> f64 {
        NEGLIGIBLE * self.size()
    }

    /// Finds pairs of nodes within the distance `near` for which `paired` returns `true`, each node with the next such
    /// one in `order`.
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

    /// Creates a mesh of `nodes` (m; z = 0 in two dimensions) and `cells`, whose kind determines the dimension.
    ///
    /// `groups` are the names of the material groups, to which the group numbers of cells refer; if it is empty, there
    /// is one group `body`. Facets of `boundaries` may have any orientation and order: they are oriented with their
    /// outside on the right and, in two dimensions, ordered consecutively.
    ///
    /// # Errors
    /// The first fault found, with all cells or nodes concerned, counted from 0.
    ///
    /// ```
    /// use stickslip::body::mesh::{Boundary, Cell, CellKind, Mesh};
    ///
    /// let nodes = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let cells = vec![Cell { kind: CellKind::Triangle, nodes: vec![0, 1, 2], group: 0 }];
    /// let foot = Boundary { name: "foot".into(), facets: vec![vec![1, 0]] };
    /// let mesh = Mesh::new(nodes, cells, Vec::new(), vec![foot])?;
    /// assert_eq!(mesh.boundary("foot").unwrap().facets, [[0, 1]]);
    /// # Ok::<(), stickslip::body::mesh::MeshFault>(())
    /// ```
    pub fn new(
        nodes: Vec<[f64; 3]>,
        cells: Vec<Cell>,
        groups: Vec<String>,
        boundaries: Vec<Boundary>,
    ) -> Result<Self, MeshFault> {
        let dimension = cells.first().ok_or(MeshFault::Empty)?.kind.dimension();
        let groups = if groups.is_empty() { vec!["body".to_string()] } else { groups };
        let mut mesh = Mesh {
            dimension,
            geometry: Geometry::Cartesian,
            nodes,
            cells,
            groups,
            boundaries: Vec::new(),
            notes: Notes::default(),
        };
        mesh.check_indices()?;
        let all: Vec<usize> = (0..mesh.nodes.len().max(mesh.cells.len())).collect();
        mesh.check_cells(&Numbers { cells: &all, nodes: &all })?;
        let outline = Outline::new(&mesh.cells);
        for Boundary { name, facets } in boundaries {
            let facets: Vec<_> = facets.into_iter().enumerate().collect();
            mesh.boundaries.push(outline.boundary(&name, &facets)?);
        }
        mesh.check_names()?;
        Ok(mesh)
    }

    /// Checks that every cell has the dimension of the mesh and refers to existing nodes and an existing group.
    pub(super) fn check_indices(&self) -> Result<(), MeshFault> {
        if self.cells.is_empty() {
            return Err(MeshFault::Empty);
        }
        let those = |bad: &dyn Fn(&[f64; 3]) -> bool| -> Vec<usize> {
            (0..self.nodes.len()).filter(|&k| bad(&self.nodes[k])).collect()
        };
        let not_finite = those(&|x| x.iter().any(|c| !c.is_finite()));
        none(not_finite, MeshFault::NotFinite)?;
        let lifted = those(&|x| self.dimension == 2 && x[2] != 0.0);
        none(lifted, MeshFault::OutOfPlane)?;
        self.check_section()?;
        let (nodes, groups) = (self.nodes.len(), self.groups.len());
        for (element, Cell { kind, nodes: own, group }) in self.cells.iter().enumerate() {
            if kind.dimension() != self.dimension {
                return Err(MeshFault::Dimensions { element, cell: kind.dimension(), mesh: self.dimension });
            }
            if own.len() != kind.nodes() {
                return Err(MeshFault::Corners { element, given: own.len(), needed: kind.nodes() });
            }
            if let Some(&node) = own.iter().find(|&&node| node >= nodes) {
                return Err(MeshFault::NoNode { element, node, nodes });
            }
            if *group >= groups {
                return Err(MeshFault::NoGroup { element, group: *group, groups });
            }
        }
        Ok(())
    }

    /// Checks that every boundary consists of outer facets, each once and with its outside on the right.
    fn check_boundaries(&self) -> Result<(), MeshFault> {
        self.check_names()?;
        let outline = Outline::new(&self.cells);
        for Boundary { name, facets } in &self.boundaries {
            let numbered: Vec<_> = facets.iter().cloned().enumerate().collect();
            let expected: HashSet<_> = outline.boundary(name, &numbered)?.facets.into_iter().map(from_least).collect();
            if let Some(element) = facets.iter().position(|facet| !expected.contains(&from_least(facet.clone()))) {
                return Err(MeshFault::TurnedFacet { boundary: name.clone(), element });
            }
        }
        Ok(())
    }

    fn check_names(&self) -> Result<(), MeshFault> {
        let mut known = HashSet::new();
        let mut names = self.boundaries.iter().map(|boundary| &boundary.name);
        names.find(|name| !known.insert(*name)).map_or(Ok(()), |name| Err(MeshFault::RepeatedName(name.clone())))
    }
}
