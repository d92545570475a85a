//! The sides of cells, the connection of cells by sides, and named boundaries, whose facets have their outside on the right.

use std::collections::{HashMap, HashSet};

use super::{Boundary, Cell, Facet, Mesh, MeshFault};
use crate::algebra::union_find::UnionFind;

/// A place where parts of one body touch without a common side.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Joint {
    /// A cell of each part of the body.
    pub cells: Vec<usize>,
    /// A node that two of them share.
    pub node: usize,
}

impl Cell {
    /// Returns the sides of the cell, oriented as in [`Facet`].
    pub(super) fn facets(&self) -> Vec<Facet> {
        let sides = self.kind.properties().sides;
        sides.iter().map(|side| side.iter().map(|&k| self.nodes[k]).collect()).collect()
    }

    /// Returns those of `nodes` that are corners of the cell.
    fn corners_among(&self, nodes: &[usize]) -> Facet {
        let corners = &self.nodes[..self.kind.corners()];
        nodes.iter().copied().filter(|node| corners.contains(node)).collect()
    }

    /// Returns the nodes around a plane cell.
    pub fn around(&self) -> Vec<usize> {
        self.facets().iter().flat_map(|side| &side[..side.len() - 1]).copied().collect()
    }
}

impl Mesh {
    /// Returns the cell on the inner side of each facet, whose nodes begin with the least one. The error contains pairs
    /// of cells of positive volume on the same side of a facet, which therefore overlap.
    pub(super) fn sides(&self) -> Result<HashMap<Facet, usize>, Vec<(usize, usize)>> {
        let (mut sides, mut overlapping) = (HashMap::new(), Vec::new());
        for (e, cell) in self.cells.iter().enumerate() {
            for facet in cell.facets() {
                if let Some(other) = sides.insert(from_least(facet), e) {
                    overlapping.push((other, e));
                }
            }
        }
        overlapping.sort_unstable();
        overlapping.dedup();
        if overlapping.is_empty() { Ok(sides) } else { Err(overlapping) }
    }

    /// Returns the surface of the mesh: the sides that belong to only one cell, oriented as in [`Facet`], each with the
    /// number of that cell; in the order of the cells.
    pub fn surface(&self) -> Vec<(Facet, usize)> {
        self.surface_at(|_| true)
    }

    /// Returns the facets of the surface with a `wanted` node. Other cells are not examined.
    pub fn surface_at(&self, wanted: impl Fn(usize) -> bool) -> Vec<(Facet, usize)> {
        let inward = |facet: &Facet| from_least(facet.iter().rev().copied().collect());
        let is_wanted = |facet: &Facet| facet.iter().any(|node| wanted(*node));
        let sides: Vec<(Facet, usize)> = self
            .cells
            .iter()
            .enumerate()
            .filter(|(_, cell)| cell.nodes.iter().any(|node| wanted(*node)))
            .flat_map(|(e, cell)| cell.facets().into_iter().filter(is_wanted).map(move |facet| (facet, e)))
            .collect();
        let all = || sides.iter().cloned();
        let known: HashSet<Facet> = all().map(|(facet, _)| from_least(facet)).collect();
        all().filter(|(facet, _)| !known.contains(&inward(facet))).collect()
    }

    /// Returns a joint, if there is one; `body` is the body of each cell.
    pub(super) fn joint(&self, sides: &HashMap<Facet, usize>, body: &[usize]) -> Option<Joint> {
        // The first cell represents its part.
        let mut joined = UnionFind::new(self.cells.len());
        for (facet, &cell) in sides {
            let from_outside = from_least(facet.iter().rev().copied().collect());
            if let Some(&neighbour) = sides.get(&from_outside) {
                joined.join(cell, neighbour);
            }
        }
        let mut part_at: Vec<Option<usize>> = vec![None; self.nodes.len()];
        let (node, own) = self.cells.iter().enumerate().find_map(|(e, cell)| {
            let component = joined.least(e);
            let meets = |&node: &usize| *part_at[node].get_or_insert(component) != component;
            Some((cell.nodes.iter().copied().find(meets)?, body[e]))
        })?;
        let cells = (0..self.cells.len()).filter(|&e| body[e] == own && joined.least(e) == e).collect();
        Some(Joint { cells, node })
    }

    /// Returns pairs of cells of which one has a quadrilateral side, of those in `sides`, and the other a triangle with
    /// three of its corners.
    pub(super) fn unmatched(&self, sides: &HashMap<Facet, usize>) -> Vec<(usize, usize)> {
        let has = |counts: [usize; 2]| sides.keys().any(|facet| counts.contains(&facet.len()));
        if self.dimension == 2 || !has([4, 8]) || !has([3, 6]) {
            return Vec::new();
        }
        let corners: Vec<(Facet, usize)> =
            sides.iter().map(|(facet, &e)| (self.cells[e].corners_among(facet), e)).collect();
        let of = |count: usize| corners.iter().filter(move |(facet, _)| facet.len() == count);
        let triangles: HashMap<Facet, usize> = of(3).map(|(facet, e)| (sorted(facet), *e)).collect();
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (facet, e) in of(4) {
            let without = |k: usize| sorted(&(0..4).filter(|j| *j != k).map(|j| facet[j]).collect::<Facet>());
            let others = (0..4).filter_map(|k| triangles.get(&without(k))).filter(|other| *other != e);
            pairs.extend(others.map(|other| (*e.min(other), *e.max(other))));
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

/// Rotates the nodes of a facet to begin with the least one, with the same orientation. An edge is not changed.
pub(super) fn from_least(mut facet: Facet) -> Facet {
    if facet.len() > 2 {
        let least = (0..facet.len()).min_by_key(|&k| facet[k]).unwrap_or(0);
        facet.rotate_left(least);
    }
    facet
}

/// The outer facets of a mesh by their sorted nodes.
pub(super) struct Outline {
    outer: HashMap<Facet, Option<Facet>>,
    dimension: Option<usize>,
}

/// Returns the nodes of a facet in ascending order.
pub(crate) fn sorted(nodes: &[usize]) -> Facet {
    let mut key = nodes.to_vec();
    key.sort_unstable();
    key
}

impl Outline {
    pub(super) fn new(cells: &[Cell]) -> Self {
        let mut outer: HashMap<Facet, Option<Facet>> = HashMap::new();
        for facet in cells.iter().flat_map(Cell::facets) {
            // A facet of two cells is inside the body.
            outer.entry(sorted(&facet)).and_modify(|facet| *facet = None).or_insert(Some(facet));
        }
        Outline { outer, dimension: cells.first().map(|cell| cell.kind.dimension()) }
    }

    /// Creates the boundary `name` of `facets`, each with its number for messages; in two dimensions the edges are
    /// ordered consecutively.
    pub(super) fn boundary(&self, name: &str, facets: &[(usize, Facet)]) -> Result<Boundary, MeshFault> {
        let boundary = || name.to_string();
        let mut of_edge = HashMap::new();
        let mut outwards = Vec::with_capacity(facets.len());
        for (number, nodes) in facets {
            if let Some(first) = of_edge.insert(sorted(nodes), *number) {
                return Err(MeshFault::RepeatedFacet { boundary: boundary(), elements: (first, *number) });
            }
            match self.outer.get(&sorted(nodes)) {
                Some(Some(facet)) => outwards.push(facet.clone()),
                Some(None) => return Err(MeshFault::InnerFacet { boundary: boundary(), element: *number }),
                None => return Err(MeshFault::LooseFacet { boundary: boundary(), element: *number }),
            }
        }
        Ok(Boundary {
            name: boundary(),
            facets: if self.dimension == Some(2) { in_a_row(&outwards) } else { outwards },
        })
    }
}

/// Orders edges consecutively, chain by chain.
fn in_a_row(edges: &[Facet]) -> Vec<Facet> {
    let from: HashMap<usize, usize> = edges.iter().enumerate().map(|(k, edge)| (edge[0], k)).collect();
    let end = |edge: &Facet| edge[edge.len() - 1];
    let ends: std::collections::HashSet<usize> = edges.iter().map(end).collect();
    let begins = |k: &usize| !ends.contains(&edges[*k][0]);
    let mut used = vec![false; edges.len()];
    let mut row = Vec::with_capacity(edges.len());
    // Open chains are first, from their beginnings; closed chains follow.
    for first in (0..edges.len()).filter(begins).chain(0..edges.len()) {
        let mut next = Some(first);
        while let Some(k) = next.filter(|&k| !used[k]) {
            used[k] = true;
            row.push(edges[k].clone());
            next = from.get(&end(&edges[k])).copied();
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::super::block::half_plane;
    use super::super::{CellKind, block};
    use super::*;

    fn joint(mesh: &Mesh) -> Option<(Vec<usize>, usize)> {
        let Joint { cells, node } = mesh.joint(&mesh.sides().unwrap(), mesh.bodies().of_cells())?;
        Some((cells, node))
    }

    #[test]
    fn what_is_made_here_is_one_piece() {
        let plane = block(&[2.0, 1.0], &[3, 2]);
        let space = block(&[2.0, 1.0, 1.0], &[3, 2, 2]);
        let half = half_plane([10.0, 10.0], 1.0, 4, 4, 4);
        for mesh in [plane.clone().into_simplices(), space.clone().into_simplices(), plane, space, half] {
            assert_eq!((joint(&mesh), mesh.bodies().count()), (None, 1));
        }
    }

    /// Returns the block with only the cells `kept`.
    fn submesh<const D: usize>(size: &[f64; D], elements: &[usize; D], kept: &[usize]) -> Mesh {
        let whole = block(size, elements);
        Mesh { cells: kept.iter().map(|&e| whole.cells[e].clone()).collect(), ..whole }
    }

    #[test]
    fn the_surface_is_what_has_a_cell_on_one_side_only() {
        let box_of = block(&[2.0, 1.0, 1.0], &[3, 2, 2]);
        for (mesh, sides, area) in [
            (block(&[2.0, 1.0], &[3, 2]), 10, 6.0),
            (block(&[2.0, 1.0], &[3, 2]).into_simplices(), 10, 6.0),
            (box_of.clone(), 32, 10.0),
            (box_of.into_simplices(), 64, 10.0),
        ] {
            let surface = mesh.surface();
            assert_eq!(surface.len(), sides);
            let vectors: Vec<[f64; 3]> = surface.iter().map(|(facet, _)| mesh.area_vector(facet)).collect();
            let all: f64 = vectors.iter().map(|v| v.iter().map(|c| c * c).sum::<f64>().sqrt()).sum();
            // The area vectors of a closed surface add up to 0.
            assert!((all - area).abs() < 1e-14 * area);
            assert!((0..3).all(|c| vectors.iter().map(|v| v[c]).sum::<f64>().abs() < 1e-14));
            assert!(surface.iter().all(|(facet, e)| facet.iter().all(|node| mesh.cells[*e].nodes.contains(node))));
        }
    }

    #[test]
    fn what_meets_in_a_node_or_an_edge_is_a_joint() {
        let corner = submesh(&[2.0, 2.0], &[2, 2], &[0, 3]);
        assert_eq!(joint(&corner), Some((vec![0, 1], 4)));
        assert_eq!(joint(&submesh(&[2.0, 2.0], &[2, 2], &[0, 3, 1])), None);
        // Cells without common nodes are different bodies, not a joint.
        assert_eq!(joint(&submesh(&[3.0, 1.0], &[3, 1], &[0, 2])), None);
        assert_eq!(joint(&submesh(&[4.0, 2.0], &[4, 2], &[0, 5, 3])), Some((vec![0, 1], 6)));
        let cube: [(&[usize], Option<usize>); 4] =
            [(&[0, 7], Some(13)), (&[0, 3], Some(4)), (&[0, 3, 7], Some(4)), (&[0, 1, 3], None)];
        for (kept, node) in cube {
            let expected = node.map(|node| (vec![0, 1], node));
            assert_eq!(joint(&submesh(&[1.0; 3], &[2; 3], kept)), expected, "{kept:?}");
        }
    }

    #[test]
    fn cells_on_one_another_are_found() {
        let mut mesh = block(&[2.0, 1.0], &[2, 1]);
        // The second cell again, from another corner on; and half of the first.
        let mut again = mesh.cells[1].clone();
        again.nodes.rotate_left(1);
        let half = Cell { kind: CellKind::Triangle, nodes: mesh.cells[0].nodes[..3].to_vec(), group: 0 };
        mesh.cells.extend([again, half]);
        assert_eq!(mesh.sides().unwrap_err(), [(0, 3), (1, 2)]);
        let mut mesh = block(&[1.0; 3], &[1; 3]).into_simplices();
        let [a, b, c, d] = mesh.cells[2].nodes[..] else { panic!() };
        mesh.cells.push(Cell { nodes: vec![b, c, a, d], ..mesh.cells[2].clone() });
        assert_eq!(mesh.sides().unwrap_err(), [(2, 6)]);
    }

    #[test]
    fn edges_follow_one_another() {
        let edges = [vec![3, 4], vec![1, 2], vec![2, 9, 3], vec![8, 7], vec![7, 8]];
        let row: Vec<usize> = in_a_row(&edges).iter().map(|edge| edge[0]).collect();
        assert_eq!(row, [1, 2, 3, 8, 7]);
    }
}
