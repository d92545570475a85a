//! The mesh of a scene.

use super::{Reader, given};
use crate::base::input_error::ensure;
use crate::body::mesh::{HalfPlane, MeshFormat, MeshSource};
use crate::scene::SceneError;
use crate::scene::document::{Mesh, MeshKind, Segments};

const KIND: &str = "mesh.kind";

/// Converts the table `mesh` of the table of `reader`.
pub(super) fn source(mesh: &Mesh, reader: Reader<'_>) -> Result<MeshSource, SceneError> {
    let (whose, format) = match mesh.kind {
        MeshKind::Block => ("a block", None),
        MeshKind::HalfPlane => ("a half-plane", None),
        MeshKind::Gmsh => ("a mesh from Gmsh", Some(MeshFormat::Gmsh)),
        MeshKind::Abaqus => ("a mesh from Abaqus or CalculiX", Some(MeshFormat::Abaqus)),
        MeshKind::Unv => ("a mesh in the format UNV", Some(MeshFormat::Unv)),
    };
    let [of_file, of_any]: [&[_]; 2] = [given!("mesh.", mesh; file scale), given!("mesh.", mesh; size)];
    let of_block = given!("mesh.", mesh; elements cells grading origin);
    let of_half_plane = given!("mesh.", mesh; contact_width contact_elements outer_elements layers);
    let foreign = match mesh.kind {
        MeshKind::Block => [of_file, of_half_plane].concat(),
        MeshKind::HalfPlane => [of_file, of_block].concat(),
        _ => [of_any, of_block, of_half_plane].concat(),
    };
    reader.foreign(whose, &foreign)?;
    if let Some(format) = format {
        let file = reader.source.beside(reader.needed("mesh.file", mesh.file.as_ref(), KIND, whose)?);
        return Ok(MeshSource::File { format, file, scale: reader.length(mesh.scale.unwrap_or(1.0)) });
    }
    let size = lists(reader.needed("mesh.size", mesh.size.as_deref(), KIND, whose)?);
    let size: Vec<Vec<f64>> =
        size.into_iter().map(|axis| axis.into_iter().map(|x| reader.length(x)).collect()).collect();
    match mesh.kind {
        MeshKind::Block => block(mesh, &size, reader),
        _ => half_plane(mesh, &size, reader),
    }
}

fn block(mesh: &Mesh, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, SceneError> {
    let given = reader.needed("mesh.elements", mesh.elements.as_ref(), KIND, "a block")?;
    let elements: Option<Vec<Vec<usize>>> =
        given.iter().map(|Segments(axis)| axis.iter().map(|&n| usize::try_from(n).ok()).collect()).collect();
    let help = "give the numbers of elements along each axis";
    // Negative numbers of elements are invalid.
    let sound = ensure(elements.is_some(), "mesh.elements", given, "numbers of at least 1", help);
    sound.map_err(|fault| reader.at(fault))?;
    let grading = mesh.grading.as_deref().map(lists);
    let source = MeshSource::segmented(size, &elements.unwrap_or_default(), grading.as_deref(), mesh.cells);
    Ok(match source.map_err(|fault| reader.at(fault))? {
        MeshSource::Block { axes, cells, .. } => {
            MeshSource::Block { axes, cells, origin: mesh.origin.map(|origin| reader.point(origin)) }
        }
        other => other,
    })
}

fn half_plane(mesh: &Mesh, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, SceneError> {
    let whose = "a half-plane";
    let Ok(size) = <[f64; 2]>::try_from(size.concat()) else {
        return reader.fault(KIND, "a half-plane has two lengths", "give mesh.size as [width, height]");
    };
    let count = |key: &str, given: Option<i64>| {
        let given = reader.needed(key, given, KIND, whose)?;
        let sound = ensure(given >= 0, key, &given, "at least 1 and at most 50 million", "give a number of elements");
        sound.map_or_else(|fault| Err(reader.at(fault)), |()| Ok(given as usize))
    };
    let contact_width = reader.needed("mesh.contact_width", mesh.contact_width, KIND, whose)?;
    Ok(MeshSource::HalfPlane(HalfPlane {
        size,
        contact_width: reader.length(contact_width),
        contact_elements: count("mesh.contact_elements", mesh.contact_elements)?,
        outer_elements: count("mesh.outer_elements", mesh.outer_elements)?,
        layers: count("mesh.layers", mesh.layers)?,
    }))
}

fn lists<T: Clone>(given: &[Segments<T>]) -> Vec<Vec<T>> {
    given.iter().map(|Segments(values)| values.clone()).collect()
}
