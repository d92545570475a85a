//! Joining the meshes of several bodies.

use super::Mesh;
use crate::algebra::vector::{Vector, plus};
use crate::base::input_error::InputError;

/// Adds the name of the body `name` to the boundaries and groups of `mesh` and moves its origin to `at` (m).
pub(super) fn named(mut mesh: Mesh, name: &str, at: Option<Vector>) -> Mesh {
    if let Some(at) = at {
        mesh.nodes.iter_mut().for_each(|x| *x = plus(*x, 1.0, at.components()));
    }
    let alone = matches!(&mesh.groups[..], [one] if one == "body");
    for group in &mut mesh.groups {
        *group = if alone || group.is_empty() { name.to_string() } else { format!("{name}:{group}") };
    }
    for boundary in &mut mesh.boundaries {
        boundary.name = format!("{name}:{}", boundary.name);
    }
    mesh.notes = mesh.notes.of_body(name);
    mesh
}

/// Appends the body `name` with this `mesh` to `all`.
pub(super) fn append(all: &mut Mesh, name: &str, mut mesh: Mesh) -> Result<(), InputError> {
    let differs = |what: &str, help: &str| InputError::new("mesh", format!("the mesh of `{name}` {what}"), help);
    if mesh.dimension != all.dimension {
        let what = format!("has {} dimensions, those before it have {}", mesh.dimension, all.dimension);
        return Err(differs(&what, "let all bodies be plane, or all have a volume"));
    }
    if mesh.geometry != all.geometry {
        let what = "is the section of a body of revolution and those before it are not, or the other way round";
        return Err(differs(what, "let all meshes be sections, or none"));
    }
    let (first, group) = (all.nodes.len(), all.groups.len());
    for cell in &mut mesh.cells {
        cell.nodes.iter_mut().for_each(|node| *node += first);
        cell.group += group;
    }
    let facets = mesh.boundaries.iter_mut().flat_map(|boundary| &mut boundary.facets);
    facets.flatten().for_each(|node| *node += first);
    all.nodes.extend(mesh.nodes);
    all.cells.extend(mesh.cells);
    all.groups.extend(mesh.groups);
    all.boundaries.extend(mesh.boundaries);
    all.notes.append(mesh.notes);
    Ok(())
}
