//! Is a mesh sound? Inverted, degenerate and unconnected cells, unused and coincident nodes.

use std::fmt::Write;

use super::{Cell, CellKind, Mesh};
use crate::vector::{cross, dot, minus};

/// Corner determinants and distances below this, relative to the size of the cell or body, are zero up to
/// the rounding of coordinates: these have about sixteen digits, and a cell of size 1e-6 of the body
/// loses six of them.
const NEGLIGIBLE: f64 = 1e-9;

/// The numbers of cells and nodes in the file they come from, for messages.
#[derive(Debug, Clone, Copy)]
pub struct Numbers<'a> {
    /// Of each cell.
    pub cells: &'a [usize],
    /// Of each node.
    pub nodes: &'a [usize],
}

/// What is wrong with a mesh. Numbers are those of the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MeshFault {
    /// Cells of negative volume, at one corner at least.
    #[error("the {} inverted: their corners run the wrong way round", elements(.0))]
    Inverted(Vec<usize>),
    /// Cells without volume, at one corner at least.
    #[error("the {} degenerate: without volume at a corner", elements(.0))]
    Degenerate(Vec<usize>),
    /// Nodes that belong to no cell.
    #[error("nodes belong to no element of the body: {}", list(.0))]
    UnusedNodes(Vec<usize>),
    /// Two nodes in one place.
    #[error("nodes coincide in pairs: {}", list(&.0.iter().map(|(a, b)| format!("{a} and {b}")).collect::<Vec<_>>()))]
    CoincidentNodes(Vec<(usize, usize)>),
    /// Parts of the body that share no node; an element of each.
    #[error("the body is in {} pieces that share no node; an element of each: {}", .0.len(), list(.0))]
    Pieces(Vec<usize>),
    /// A facet of a boundary between two cells.
    #[error("element {element} of the boundary `{boundary}` lies inside the body, between two elements")]
    InnerFacet {
        /// The boundary.
        boundary: String,
        /// The element of the facet.
        element: usize,
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
    /// How to mend it.
    pub fn help(&self) -> &'static str {
        match self {
            MeshFault::Inverted(_) => "reverse the surface or volume in Gmsh, or mesh it again",
            MeshFault::Degenerate(_) => "mesh again; look for slivers, and for edges or angles of zero size",
            MeshFault::UnusedNodes(_) => "put only lines, surfaces and volumes of the body into physical groups",
            MeshFault::CoincidentNodes(_) => "join the parts in Gmsh (Coherence, or Coherence Mesh) and mesh again",
            MeshFault::Pieces(_) => "one body is wanted: join the parts in Gmsh (Coherence), or leave some out",
            MeshFault::InnerFacet { .. } | MeshFault::LooseFacet { .. } => {
                "name a physical group of the outer surface (in two dimensions, of the outline)"
            }
        }
    }
}

impl Mesh {
    /// Whether the mesh is sound.
    ///
    /// # Errors
    /// The first fault found, with all cells or nodes that have it, by their `numbers`.
    pub fn check(&self, numbers: &Numbers<'_>) -> Result<(), MeshFault> {
        let named = |bad: &mut dyn Iterator<Item = usize>| bad.map(|e| numbers.cells[e]).collect::<Vec<usize>>();
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
        let mut used = vec![false; self.nodes.len()];
        self.cells.iter().flat_map(|cell| &cell.nodes).for_each(|&node| used[node] = true);
        let unused: Vec<usize> = (0..used.len()).filter(|&k| !used[k]).map(|k| numbers.nodes[k]).collect();
        if !unused.is_empty() {
            return Err(MeshFault::UnusedNodes(unused));
        }
        let coincident = self.coincident_nodes();
        if !coincident.is_empty() {
            let named = |(a, b): (usize, usize)| (numbers.nodes[a], numbers.nodes[b]);
            return Err(MeshFault::CoincidentNodes(coincident.into_iter().map(named).collect()));
        }
        let pieces = named(&mut self.pieces().into_iter());
        if pieces.len() > 1 { Err(MeshFault::Pieces(pieces)) } else { Ok(()) }
    }

    /// For each corner of `cell`, the area (m²) or volume (m³) that its edges span, with its sign, and the
    /// square or cube of the longest of all edges at corners.
    pub(super) fn corner_volumes(&self, cell: &Cell) -> Vec<(f64, f64)> {
        let points = self.points(&cell.nodes);
        let n = points.len();
        let neighbours: Vec<Vec<usize>> = match cell.kind {
            CellKind::Triangle | CellKind::Quadrilateral => {
                (0..n).map(|k| vec![(k + 1) % n, (k + n - 1) % n]).collect()
            }
            CellKind::Tetrahedron => vec![vec![1, 2, 3]],
            CellKind::Hexahedron => {
                let lower = |k: usize| vec![(k + 1) % 4, (k + 3) % 4, k + 4];
                let upper = |k: usize| vec![(k + 3) % 4 + 4, (k + 1) % 4 + 4, k];
                (0..4).map(lower).chain((0..4).map(upper)).collect()
            }
        };
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

    fn coincident_nodes(&self) -> Vec<(usize, usize)> {
        let extent = (0..3)
            .map(|c| {
                let along = || self.nodes.iter().map(|x| x[c]);
                along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
            })
            .fold(0.0, f64::max);
        let near = NEGLIGIBLE * extent;
        // Along a direction of no lattice few nodes share a place, so few pairs have to be looked at.
        let along = |x: [f64; 3]| dot(x, [0.742, 0.534, 0.406]);
        let mut order: Vec<(f64, usize)> = self.nodes.iter().enumerate().map(|(k, &x)| (along(x), k)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut pairs = Vec::new();
        for (k, &(s, a)) in order.iter().enumerate() {
            for &(_, b) in order[k + 1..].iter().take_while(|(t, _)| t - s <= near) {
                let apart = minus(self.nodes[b], self.nodes[a]);
                if dot(apart, apart) <= near * near {
                    pairs.push((a.min(b), a.max(b)));
                }
            }
        }
        pairs
    }

    /// A cell of each connected part.
    fn pieces(&self) -> Vec<usize> {
        let mut parent: Vec<usize> = (0..self.nodes.len()).collect();
        for cell in &self.cells {
            let first = root(&mut parent, cell.nodes[0]);
            for &node in &cell.nodes[1..] {
                let other = root(&mut parent, node);
                parent[other] = first;
            }
        }
        let mut seen = std::collections::HashSet::new();
        (0..self.cells.len()).filter(|&e| seen.insert(root(&mut parent, self.cells[e].nodes[0]))).collect()
    }
}

/// The representative of the part that `k` belongs to.
fn root(parent: &mut [usize], mut k: usize) -> usize {
    while parent[k] != k {
        parent[k] = parent[parent[k]];
        k = parent[k];
    }
    k
}

impl Cell {
    /// Its sides, each with its outside as [`Facet`](super::Facet) wants it.
    pub(super) fn facets(&self) -> Vec<Vec<usize>> {
        let n = self.nodes.len();
        let sides: Vec<Vec<usize>> = match self.kind {
            CellKind::Triangle | CellKind::Quadrilateral => (0..n).map(|k| vec![k, (k + 1) % n]).collect(),
            CellKind::Tetrahedron => vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![0, 3, 2]],
            CellKind::Hexahedron => {
                let around = |k: usize| vec![k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4];
                [vec![0, 3, 2, 1], vec![4, 5, 6, 7]].into_iter().chain((0..4).map(around)).collect()
            }
        };
        sides.iter().map(|side| side.iter().map(|&k| self.nodes[k]).collect()).collect()
    }
}
