//! The body of a scene, or its bodies: mesh, elements and materials.

use super::{Reader, given, needed, only};
use crate::base::input_error::{InputError, each, ensure};
use crate::base::units::Quantity;
use crate::body::fem::{Element, Layer, Material, MaterialGroup};
use crate::body::mesh::{Body, HalfPlane, MeshFormat, MeshSource};
use crate::scene::document::{self, Document, Mesh, MeshKind, OneOrMany, Tuple};

/// Mesh, elements and materials of all bodies of a scene.
pub(super) struct Bodies {
    pub mesh: MeshSource,
    pub element: Element,
    /// The least error that `mesh.refine` of a body asks for.
    pub refine: Option<f64>,
    pub material: Material,
    /// The key of the material of each group of `material`, if there are several bodies.
    pub keys: Vec<String>,
}

/// Takes the bodies out of `document`.
pub(super) fn bodies(document: &mut Document, reader: Reader<'_>) -> Result<Bodies, InputError> {
    let (mesh, material, body) = (document.mesh.take(), document.material.take(), std::mem::take(&mut document.body));
    if body.is_empty() {
        let missing = |table: &str| {
            let help = "add the key; `stickslip init block` shows a complete scene";
            InputError::new("", format!("missing field `{table}`"), help)
        };
        let (mesh, given) = (mesh.ok_or_else(|| missing("mesh"))?, material.ok_or_else(|| missing("material"))?);
        let element = mesh.element.unwrap_or_default();
        let refine = refine(&mesh)?;
        let (mesh, material) = (self::source(&mesh, reader)?, self::material(given, reader));
        return Ok(Bodies { mesh, element, refine, material, keys: Vec::new() });
    }
    for (table, given) in [("mesh", mesh.is_some()), ("material", material.is_some())] {
        if given {
            let message = format!("the scene has [{table}] and [[body]]");
            let help = format!("give each body a [body.{table}] of its own and remove [{table}], or remove [[body]]");
            return Err(InputError::new(table, message, help));
        }
    }
    several(body, reader)
}

fn several(given: Vec<document::BodyTable>, reader: Reader<'_>) -> Result<Bodies, InputError> {
    let element = given[0].mesh.element.unwrap_or_default();
    let (mut materials, mut keys, mut refine) = (Vec::new(), Vec::new(), None::<f64>);
    let bodies = each("body", given, |k, document::BodyTable { name, at, mesh, material }| {
        let own = mesh.element.unwrap_or_default();
        if own != element {
            let (own, before) = (own.name(), element.name());
            let message = format!("the elements of `{name}` are \"{own}\", those before it \"{before}\"");
            let help = "all bodies have the same mesh.element, which is \"bilinear\" where it is left out";
            return Err(InputError::new("mesh.element", message, help));
        }
        refine = [refine, self::refine(&mesh)?].into_iter().flatten().reduce(f64::min);
        keys.push(format!("body[{k}].material"));
        keys.extend((0..material.group.len()).map(|j| format!("body[{k}].material.group[{j}]")));
        materials.push((name.clone(), self::material(material, reader)));
        Ok(Body { name, mesh: self::source(&mesh, reader)?, at: at.map(|at| reader.point(at)) })
    })?;
    let material = Material::of_bodies(materials)?;
    Ok(Bodies { mesh: MeshSource::Bodies(bodies), element, refine, material, keys })
}

fn material(given: document::Material, reader: Reader<'_>) -> Material {
    let stress = |x| reader.si(Quantity::Stress, x);
    let density = |density: Option<f64>| density.map(|x| reader.si(Quantity::Density, x));
    let layer = |Tuple([thickness, young, poisson])| Layer {
        thickness: reader.length(thickness),
        young: stress(young),
        poisson,
    };
    let group =
        |group: MaterialGroup| MaterialGroup { young: stress(group.young), density: density(group.density), ..group };
    Material {
        young: stress(given.young),
        poisson: given.poisson,
        plane: given.plane,
        thickness: given.thickness.map(|x| reader.length(x)),
        density: density(given.density),
        expansion: given.expansion,
        layers: given.layers.into_iter().map(layer).collect(),
        groups: given.group.into_iter().map(group).collect(),
    }
}

/// Returns the error up to which the table `mesh` asks to refine it.
fn refine(mesh: &Mesh) -> Result<Option<f64>, InputError> {
    let help = "the error of the stresses in the energy norm, such as 0.02 for 2 %";
    let is_valid = mesh.refine.is_none_or(|share| share > 0.0 && share < 1.0);
    ensure(is_valid, "mesh.refine", &mesh.refine.unwrap_or_default(), "above 0 and below 1", help)?;
    Ok(mesh.refine)
}

const KIND: &str = "mesh.kind";

/// Converts the table `mesh` of the table of `reader`.
pub(super) fn source(mesh: &Mesh, reader: Reader<'_>) -> Result<MeshSource, InputError> {
    let of_file = &["mesh.file", "mesh.scale"][..];
    let of_block = &["mesh.size", "mesh.elements", "mesh.grading", "mesh.origin", "mesh.cells"];
    let of_half_plane =
        &["mesh.size", "mesh.contact_width", "mesh.contact_elements", "mesh.outer_elements", "mesh.layers"];
    let (whose, format, own) = match mesh.kind {
        MeshKind::Block => ("a block", None, &of_block[..]),
        MeshKind::HalfPlane => ("a half-plane", None, &of_half_plane[..]),
        MeshKind::Gmsh => ("a mesh from Gmsh", Some(MeshFormat::Gmsh), of_file),
        MeshKind::Abaqus => ("a mesh from Abaqus or CalculiX", Some(MeshFormat::Abaqus), of_file),
        MeshKind::Unv => ("a mesh in the format UNV", Some(MeshFormat::Unv), of_file),
    };
    let given = given!("mesh.", mesh; size elements grading origin cells contact_width contact_elements
        outer_elements layers file scale);
    only(whose, own, given)?;
    if let Some(format) = format {
        let file = reader.source.beside(needed("mesh.file", mesh.file.as_ref(), KIND, whose)?);
        return Ok(MeshSource::File { format, file, scale: reader.length(mesh.scale.unwrap_or(1.0)) });
    }
    let size = lists(needed("mesh.size", mesh.size.as_deref(), KIND, whose)?);
    let size: Vec<Vec<f64>> =
        size.into_iter().map(|axis| axis.into_iter().map(|x| reader.length(x)).collect()).collect();
    match mesh.kind {
        MeshKind::Block => block(mesh, &size, reader),
        _ => half_plane(mesh, &size, reader),
    }
}

fn block(mesh: &Mesh, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, InputError> {
    let given = needed("mesh.elements", mesh.elements.as_ref(), KIND, "a block")?;
    let elements: Option<Vec<Vec<usize>>> =
        lists(given).into_iter().map(|axis| axis.into_iter().map(|n| usize::try_from(n).ok()).collect()).collect();
    let help = "give the numbers of elements along each axis";
    // Negative numbers of elements are invalid.
    ensure(elements.is_some(), "mesh.elements", given, "numbers of at least 1", help)?;
    let grading = mesh.grading.as_deref().map(lists);
    let source = MeshSource::segmented(size, &elements.unwrap_or_default(), grading.as_deref(), mesh.cells);
    Ok(match source? {
        MeshSource::Block { axes, cells, .. } => {
            MeshSource::Block { axes, cells, origin: mesh.origin.map(|origin| reader.point(origin)) }
        }
        other => other,
    })
}

fn half_plane(mesh: &Mesh, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, InputError> {
    let whose = "a half-plane";
    let Ok(size) = <[f64; 2]>::try_from(size.concat()) else {
        return Err(InputError::new(KIND, "a half-plane has two lengths", "give mesh.size as [width, height]"));
    };
    let count = |key: &str, given: Option<i64>| {
        let given = needed(key, given, KIND, whose)?;
        ensure(given >= 0, key, &given, "at least 1 and at most 50 million", "give a number of elements")?;
        Ok(given as usize)
    };
    let contact_width = needed("mesh.contact_width", mesh.contact_width, KIND, whose)?;
    Ok(MeshSource::HalfPlane(HalfPlane {
        size,
        contact_width: reader.length(contact_width),
        contact_elements: count("mesh.contact_elements", mesh.contact_elements)?,
        outer_elements: count("mesh.outer_elements", mesh.outer_elements)?,
        layers: count("mesh.layers", mesh.layers)?,
    }))
}

fn lists<T: Clone>(given: &[OneOrMany<T>]) -> Vec<Vec<T>> {
    given.iter().cloned().map(OneOrMany::into_vec).collect()
}
