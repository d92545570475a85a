//! From elements and physical groups to cells, material groups and boundaries.

use super::read::{Block, File};
use super::{ElementKind, GmshError};
use crate::mesh::boundaries::Outline;
use crate::mesh::{Cell, Facet, Geometry, Mesh, MeshFault};

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
        let help = "mesh the surfaces (gmsh -2) or volumes (gmsh -3), and put them in a physical group: where there are \
                    any groups, Gmsh writes nothing else";
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
            let nodes = kind.properties().gmsh_order.iter().map(|&place| nodes[place]).collect();
            cells.push(Cell { kind, nodes, group });
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
                "a plane mesh has to lie in a plane z = const; a body needs volume elements: mesh it with gmsh -3 and put \
                 its volumes into a physical group, too, for where there are any groups, Gmsh writes nothing else",
            ));
        }
        for x in &mut nodes {
            x[2] = 0.0;
        }
    }
    let mut mesh = Mesh { dimension, geometry: Geometry::Cartesian, nodes, cells, groups, boundaries: Vec::new() };
    let clockwise = |cell: &Cell| mesh.corner_volumes(cell).iter().all(|&(volume, _)| volume < 0.0);
    if dimension == 2 && mesh.cells.iter().all(clockwise) {
        mesh.cells.iter_mut().for_each(Cell::turn_over);
    }
    Ok((mesh, numbers))
}

/// Adds a boundary for each physical group of facets.
pub(super) fn boundaries(mesh: &mut Mesh, file: &File) -> Result<(), MeshFault> {
    let mut named: Vec<(String, Vec<(usize, Facet)>)> = Vec::new();
    for block in file.blocks.iter().filter(|block| block.kind.dimension() + 1 == mesh.dimension) {
        for name in &block.groups {
            let k = named.iter().position(|(known, _)| known == name).unwrap_or_else(|| {
                named.push((name.clone(), Vec::new()));
                named.len() - 1
            });
            named[k].1.extend(block.elements.iter().cloned());
        }
    }
    let outline = Outline::new(&mesh.cells);
    mesh.boundaries = named.iter().map(|(name, facets)| outline.boundary(name, facets)).collect::<Result<_, _>>()?;
    Ok(())
}
