//! From elements and physical groups to cells, material groups and boundaries.

use std::collections::HashMap;

use super::read::{Block, File};
use super::{ElementKind, GmshError};
use crate::mesh::check::MeshFault;
use crate::mesh::{Boundary, Cell, Facet, Mesh};

/// The mesh without its boundaries, and Gmsh's number of each cell.
pub(super) fn mesh(file: File, name: &str) -> Result<(Mesh, Vec<usize>), GmshError> {
    let at = |line: usize, message: String, help: &str| GmshError {
        file: name.to_string(),
        line,
        message,
        help: help.to_string(),
    };
    let dimension = file.blocks.iter().map(|block| block.kind.dimension()).max().unwrap_or(0);
    if dimension < 2 {
        let help = "mesh the surfaces (gmsh -2) or volumes (gmsh -3), and put them in a physical group";
        return Err(at(1, "the file has no elements of two or three dimensions".to_string(), help));
    }
    let (mut cells, mut numbers, mut groups) = (Vec::new(), Vec::new(), Vec::<String>::new());
    for Block { kind, groups: names, elements, line } in &file.blocks {
        let ElementKind::Cell(kind) = *kind else { continue };
        if kind.dimension() < dimension {
            continue;
        }
        if names.len() > 1 {
            let message = format!("elements are in several physical groups: {}", names.join(", "));
            return Err(at(*line, message, "keep one physical group, the material, for each part of the body"));
        }
        // What is in no group is a group of its own, without a name.
        let group = names.first().cloned().unwrap_or_default();
        let group = groups.iter().position(|known| *known == group).unwrap_or_else(|| {
            groups.push(group);
            groups.len() - 1
        });
        for (number, nodes) in elements {
            cells.push(Cell { kind, nodes: nodes.clone(), group });
            numbers.push(*number);
        }
    }
    let mut nodes = file.nodes;
    if dimension == 2 {
        let extent = nodes.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
        let level = nodes.first().map_or(0.0, |x| x[2]);
        // Coordinates are written with about sixteen digits; nine leave room for what made them.
        if let Some(k) = nodes.iter().position(|x| (x[2] - level).abs() > 1e-9 * extent) {
            let message =
                format!("the mesh is a surface that is not plane: node {} has z = {}", file.numbers[k], nodes[k][2]);
            return Err(at(
                1,
                message,
                "a plane mesh has to lie in a plane z = const; a body needs volume elements (gmsh -3)",
            ));
        }
        for x in &mut nodes {
            x[2] = 0.0;
        }
    }
    let mut mesh = Mesh { dimension, nodes, cells, groups, boundaries: Vec::new() };
    let clockwise = |cell: &Cell| mesh.corner_volumes(cell).iter().all(|&(volume, _)| volume < 0.0);
    if dimension == 2 && mesh.cells.iter().all(clockwise) {
        mesh.cells.iter_mut().for_each(|cell| cell.nodes.reverse());
    }
    Ok((mesh, numbers))
}

/// Adds a boundary for each physical group of facets, each facet with its outside on the right side.
pub(super) fn boundaries(mesh: &mut Mesh, file: &File) -> Result<(), MeshFault> {
    let key = |nodes: &[usize]| {
        let mut key = nodes.to_vec();
        key.sort_unstable();
        key
    };
    let mut outer: HashMap<Vec<usize>, Option<Facet>> = HashMap::new();
    for cell in &mesh.cells {
        for facet in cell.facets() {
            // A facet of two cells is inside the body.
            outer.entry(key(&facet)).and_modify(|facet| *facet = None).or_insert(Some(facet));
        }
    }
    let mut boundaries: Vec<Boundary> = Vec::new();
    // The element of each facet of each boundary.
    let mut taken = HashMap::new();
    for block in file.blocks.iter().filter(|block| block.kind.dimension() + 1 == mesh.dimension) {
        for name in &block.groups {
            let k = boundaries.iter().position(|boundary| boundary.name == *name).unwrap_or_else(|| {
                boundaries.push(Boundary { name: name.clone(), facets: Vec::new() });
                boundaries.len() - 1
            });
            for (number, nodes) in &block.elements {
                if let Some(first) = taken.insert((k, key(nodes)), *number) {
                    return Err(MeshFault::RepeatedFacet { boundary: name.clone(), elements: (first, *number) });
                }
                match outer.get(&key(nodes)) {
                    Some(Some(facet)) => boundaries[k].facets.push(facet.clone()),
                    Some(None) => return Err(MeshFault::InnerFacet { boundary: name.clone(), element: *number }),
                    None => return Err(MeshFault::LooseFacet { boundary: name.clone(), element: *number }),
                }
            }
        }
    }
    if mesh.dimension == 2 {
        for boundary in &mut boundaries {
            boundary.facets = in_a_row(&boundary.facets);
        }
    }
    mesh.boundaries = boundaries;
    Ok(())
}

/// Edges in the order in which they follow one another, chain by chain.
fn in_a_row(edges: &[Facet]) -> Vec<Facet> {
    let from: HashMap<usize, usize> = edges.iter().enumerate().map(|(k, edge)| (edge[0], k)).collect();
    let ends: std::collections::HashSet<usize> = edges.iter().map(|edge| edge[1]).collect();
    let begins = |k: &usize| !ends.contains(&edges[*k][0]);
    let mut taken = vec![false; edges.len()];
    let mut row = Vec::with_capacity(edges.len());
    // First the chains from their beginnings, then what is left: closed ones.
    for first in (0..edges.len()).filter(begins).chain(0..edges.len()) {
        let mut next = Some(first);
        while let Some(k) = next.filter(|&k| !taken[k]) {
            taken[k] = true;
            row.push(edges[k].clone());
            next = from.get(&edges[k][1]).copied();
        }
    }
    row
}

#[cfg(test)]
mod tests {
    use super::in_a_row;

    #[test]
    fn edges_follow_one_another() {
        let edges = [vec![3, 4], vec![1, 2], vec![2, 3], vec![8, 7], vec![7, 8]];
        let row: Vec<usize> = in_a_row(&edges).iter().map(|edge| edge[0]).collect();
        assert_eq!(row, [1, 2, 3, 8, 7]);
    }
}
