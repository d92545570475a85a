//! The mesh of a scene.

use crate::base::input_error::{InputError, ensure};
use crate::body::mesh::{HalfPlane, MeshFormat, MeshSource};
use crate::scene::document::{Mesh, MeshKind, Segments};
use crate::scene::error::Source;

use super::{foreign, needed};

const KIND: &str = "mesh.kind";

/// Converts the table `mesh` of the scene `source`.
pub(super) fn source(mesh: &Mesh, source: &Source) -> Result<MeshSource, InputError> {
    match mesh.kind {
        MeshKind::Block => block(mesh),
        MeshKind::HalfPlane => half_plane(mesh),
        MeshKind::Gmsh => file(mesh, source, MeshFormat::Gmsh, "a mesh from Gmsh"),
        MeshKind::Abaqus => file(mesh, source, MeshFormat::Abaqus, "a mesh from Abaqus or CalculiX"),
        MeshKind::Unv => file(mesh, source, MeshFormat::Unv, "a mesh in the format UNV"),
    }
}

fn block(mesh: &Mesh) -> Result<MeshSource, InputError> {
    let whose = "a block";
    let size = size(mesh, whose)?;
    no_half_plane(mesh, whose)?;
    let given = needed("mesh.elements", mesh.elements.as_ref(), KIND, whose)?;
    let elements: Option<Vec<Vec<usize>>> =
        given.iter().map(|Segments(axis)| axis.iter().map(|&n| usize::try_from(n).ok()).collect()).collect();
    let help = "give the numbers of elements along each axis";
    // Negative numbers of elements are invalid.
    ensure(elements.is_some(), "mesh.elements", given, "numbers of at least 1", help)?;
    let grading = mesh.grading.as_deref().map(lists);
    let source = MeshSource::segmented(&size, &elements.unwrap_or_default(), grading.as_deref(), mesh.cells)?;
    Ok(match source {
        MeshSource::Block { axes, cells, .. } => MeshSource::Block { axes, cells, origin: mesh.origin },
        other => other,
    })
}

fn half_plane(mesh: &Mesh) -> Result<MeshSource, InputError> {
    let whose = "a half-plane";
    let Ok(size) = <[f64; 2]>::try_from(size(mesh, whose)?.concat()) else {
        return Err(InputError::new(KIND, "a half-plane has two lengths", "give mesh.size as [width, height]"));
    };
    no_block(mesh, whose)?;
    let count = |key: &str, given: Option<i64>| {
        let given = needed(key, given, KIND, whose)?;
        let help = "give a number of elements";
        ensure(given >= 0, key, &given, "at least 1 and at most 50 million", help)?;
        Ok(given as usize)
    };
    Ok(MeshSource::HalfPlane(HalfPlane {
        size,
        contact_width: needed("mesh.contact_width", mesh.contact_width, KIND, whose)?,
        contact_elements: count("mesh.contact_elements", mesh.contact_elements)?,
        outer_elements: count("mesh.outer_elements", mesh.outer_elements)?,
        layers: count("mesh.layers", mesh.layers)?,
    }))
}

fn file(mesh: &Mesh, source: &Source, format: MeshFormat, whose: &str) -> Result<MeshSource, InputError> {
    foreign("mesh.size", mesh.size.as_ref(), whose)?;
    no_block(mesh, whose)?;
    no_half_plane(mesh, whose)?;
    let file = needed("mesh.file", mesh.file.as_ref(), KIND, whose)?;
    Ok(MeshSource::File { format, file: source.beside(file), scale: mesh.scale.unwrap_or(1.0) })
}

/// Returns the lengths of the segments along each axis of a generated mesh.
fn size(mesh: &Mesh, whose: &str) -> Result<Vec<Vec<f64>>, InputError> {
    foreign("mesh.file", mesh.file.as_ref(), whose)?;
    foreign("mesh.scale", mesh.scale.as_ref(), whose)?;
    Ok(lists(needed("mesh.size", mesh.size.as_ref(), KIND, whose)?))
}

fn lists<T: Clone>(given: &[Segments<T>]) -> Vec<Vec<T>> {
    given.iter().map(|Segments(values)| values.clone()).collect()
}

/// Refuses the keys of a block.
fn no_block(mesh: &Mesh, whose: &str) -> Result<(), InputError> {
    foreign("mesh.elements", mesh.elements.as_ref(), whose)?;
    foreign("mesh.cells", mesh.cells.as_ref(), whose)?;
    foreign("mesh.grading", mesh.grading.as_ref(), whose)?;
    foreign("mesh.origin", mesh.origin.as_ref(), whose)
}

/// Refuses the keys of a half-plane.
fn no_half_plane(mesh: &Mesh, whose: &str) -> Result<(), InputError> {
    foreign("mesh.contact_width", mesh.contact_width.as_ref(), whose)?;
    foreign("mesh.contact_elements", mesh.contact_elements.as_ref(), whose)?;
    foreign("mesh.outer_elements", mesh.outer_elements.as_ref(), whose)?;
    foreign("mesh.layers", mesh.layers.as_ref(), whose)
}
