//! Conversion of elements and their groups to cells, material groups and boundaries.

use std::collections::{HashMap, HashSet};

use super::raw::{Block, ElementKind, RawMesh, SAME_PLACE};
use super::{MeshFormat, MeshFormatError, Place};
use crate::body::mesh::boundaries::Outline;
use crate::body::mesh::{Cell, Facet, Geometry, Mesh, Notes};

/// Creates the mesh without its boundaries; returns also the number of each cell in the file, whose name and format are
/// for messages.
pub(super) fn mesh(file: &mut RawMesh, name: &str, format: MeshFormat) -> Result<(Mesh, Vec<usize>), MeshFormatError> {
    let error = |message: String, help: &str| MeshFormatError {
        file: name.to_string(),
        place: Place::Line(1),
        message,
        help: help.to_string(),
    };
    let dimension = file.blocks.iter().map(|block| block.kind.dimension()).max().unwrap_or(0);
    if dimension < 2 {
        let help = match format {
            MeshFormat::Gmsh => {
                "mesh the surfaces (gmsh -2) or volumes (gmsh -3), and put them in a physical group: where there are any \
                 groups, Gmsh writes nothing else"
            }
            MeshFormat::Abaqus => "let the file, or one that it includes, have *NODE and *ELEMENT",
            MeshFormat::Unv => "export the faces of a plane mesh, the volumes of a body in space, in the dataset 2412",
        };
        return Err(error("the file has no elements of two or three dimensions".to_string(), help));
    }
    let mut notes = Notes { remarks: std::mem::take(&mut file.remarks), ..Notes::default() };
    let unused = file.leave_out_unused_nodes(dimension);
    if unused > 0 {
        notes.remarks.push(match unused {
            1 => "1 node is left out: no element of the body has it".to_string(),
            _ => format!("{unused} nodes are left out: no element of the body has them"),
        });
    }
    let (mut cells, mut numbers, mut groups) = (Vec::new(), Vec::new(), Vec::<String>::new());
    let mut places = HashMap::new();
    for Block { kind, groups: names, elements } in &file.blocks {
        let ElementKind::Cell(kind) = *kind else { continue };
        if kind.dimension() < dimension {
            continue;
        }
        // Cells in no group form a group without a name.
        let mut names = names.clone();
        names.sort();
        let group = names.join("+");
        if names.len() > 1 && !notes.combined.iter().any(|(known, _)| *known == group) {
            notes.combined.push((group.clone(), names.clone()));
        }
        let group = *places.entry(group).or_insert_with_key(|group| {
            groups.push(group.clone());
            groups.len() - 1
        });
        for (number, nodes) in elements {
            cells.push(Cell { kind, nodes: nodes.clone(), group });
            numbers.push(*number);
        }
    }
    let mut nodes = file.nodes.clone();
    if dimension == 2 {
        let help = match format {
            MeshFormat::Gmsh => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volume \
                 elements: mesh it with gmsh -3 and put its volumes into a physical group, too, for where there are any \
                 groups, Gmsh writes nothing else"
            }
            MeshFormat::Abaqus => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volume \
                 elements, C3D4 or others"
            }
            MeshFormat::Unv => {
                "turn a plane mesh into the x-y plane of the file (x-z and y-z are read, too); a body in space needs volumes: \
                 mesh it in three dimensions and export it again"
            }
        };
        let axes = plane(file).map_err(|message| error(message, help))?;
        for x in &mut nodes {
            *x = [x[axes[0]], x[axes[1]], 0.0];
        }
        if axes != [0, 1] {
            let [first, second] = axes.map(|axis| ["x", "y", "z"][axis]);
            let remark =
                format!("the mesh lies in the {first}-{second} plane of its file: {first} is x here, {second} is y");
            notes.remarks.push(remark);
        }
    }
    let boundaries = Vec::new();
    let mut mesh = Mesh { dimension, geometry: Geometry::Cartesian, nodes, cells, groups, boundaries, notes };
    turn_over(&mut mesh);
    Ok((mesh, numbers))
}

/// Returns the axes of the coordinate plane that contains all nodes. The error is the reason, in words, why there is
/// none.
fn plane(file: &RawMesh) -> Result<[usize; 2], String> {
    let extent = file.nodes.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    let origin = file.nodes.first().copied().unwrap_or_default();
    let off = |axis: usize| file.nodes.iter().position(|x| (x[axis] - origin[axis]).abs() > SAME_PLACE * extent);
    match (off(2), off(1), off(0)) {
        (None, ..) => Ok([0, 1]),
        (_, None, _) => Ok([0, 2]),
        (.., None) => Ok([1, 2]),
        (Some(k), ..) => {
            let (node, z) = (file.numbers[k], file.nodes[k][2]);
            Err(format!("the mesh is a surface that is not plane: node {node} has z = {z}"))
        }
    }
}

/// Renumbers the cells with the wrong orientation. If a renumbered cell would overlap a neighbour, its node positions
/// are wrong instead of the order, and it remains as it was.
fn turn_over(mesh: &mut Mesh) {
    let inverted = |cell: &Cell| mesh.corner_volumes(cell).iter().all(|&(volume, _)| volume < 0.0);
    let turned: Vec<bool> = mesh.cells.iter().map(inverted).collect();
    let turn = |cells: &mut [Cell], which: &dyn Fn(usize) -> bool| {
        cells.iter_mut().enumerate().filter(|(e, _)| which(*e)).for_each(|(_, cell)| cell.turn_over());
    };
    turn(&mut mesh.cells, &|e| turned[e]);
    // If all cells are renumbered, no new overlaps arise.
    if turned.contains(&true) && turned.contains(&false) {
        let pairs = mesh.sides().err().unwrap_or_default();
        let overlapping: HashSet<usize> = pairs.into_iter().flat_map(|(a, b)| [a, b]).collect();
        turn(&mut mesh.cells, &|e| turned[e] && overlapping.contains(&e));
    }
}

/// Adds a boundary for each group of facets that can be a boundary.
pub(super) fn boundaries(mesh: &mut Mesh, file: &RawMesh) {
    let mut named: Vec<(String, Vec<(usize, Facet)>)> = Vec::new();
    let mut places = HashMap::new();
    for block in file.blocks.iter().filter(|block| block.kind.dimension() + 1 == mesh.dimension) {
        for name in &block.groups {
            let k = *places.entry(name).or_insert_with(|| {
                named.push((name.clone(), Vec::new()));
                named.len() - 1
            });
            named[k].1.extend(block.elements.iter().cloned());
        }
    }
    let outline = Outline::new(&mesh.cells);
    for (name, facets) in named {
        match outline.boundary(&name, &facets) {
            Ok(boundary) => mesh.boundaries.push(boundary),
            Err(fault) => mesh.notes.unusable.push((name, fault)),
        }
    }
}
