//! Named boundaries from lists of facets, each oriented with its outside on the right.

use std::collections::HashMap;

use super::{Boundary, Cell, Facet, MeshFault};

/// The outer facets of a mesh by their sorted nodes.
pub(super) struct Outline {
    outer: HashMap<Facet, Option<Facet>>,
    dimension: Option<usize>,
}

/// Returns the nodes of a facet in ascending order.
pub(super) fn sorted(nodes: &[usize]) -> Facet {
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
        let mut taken = HashMap::new();
        let mut outwards = Vec::with_capacity(facets.len());
        for (number, nodes) in facets {
            if let Some(first) = taken.insert(sorted(nodes), *number) {
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
    let mut taken = vec![false; edges.len()];
    let mut row = Vec::with_capacity(edges.len());
    // Open chains are first, from their beginnings; closed chains follow.
    for first in (0..edges.len()).filter(begins).chain(0..edges.len()) {
        let mut next = Some(first);
        while let Some(k) = next.filter(|&k| !taken[k]) {
            taken[k] = true;
            row.push(edges[k].clone());
            next = from.get(&end(&edges[k])).copied();
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::in_a_row;

    #[test]
    fn edges_follow_one_another() {
        let edges = [vec![3, 4], vec![1, 2], vec![2, 9, 3], vec![8, 7], vec![7, 8]];
        let row: Vec<usize> = in_a_row(&edges).iter().map(|edge| edge[0]).collect();
        assert_eq!(row, [1, 2, 3, 8, 7]);
    }
}
