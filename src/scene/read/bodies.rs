//! The body of a scene, or its bodies, mesh, elements and materials: their tables, and what they become.

use super::{Deserialize, Document, JsonSchema, OneOrMany, Reader, given, missing, needed, only};
use crate::algebra::vector::Vector;
use crate::base::input_error::{InputError, each, ensure};
use crate::base::units::Quantity;
use crate::body::fem::{Element, Layer, Material};
use crate::body::mesh::{Body, CellKind, HalfPlane, MeshFormat, MeshSource};

/// A body of several, with a mesh and a material of its own; mesh.element and material.plane are the same in all.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "body")]
pub(super) struct BodyTable {
    /// Name of the body; its boundaries are called `roller:hub`.
    /// Example: `name = "roller"`. Value: name without a colon.
    pub name: String,
    /// Where the origin of its mesh is placed.
    /// Example: `at = [0.1, 0.15]`. Value: point, m. Default: origin.
    pub at: Option<Vector>,
    /// Mesh of the body, with all keys of [`[mesh]`](mesh.md); equal `element` in all bodies.
    /// Example: `mesh = { kind = "gmsh", file = "roller.msh" }`. Value: table.
    pub mesh: MeshTable,
    /// Material of the body, with all keys of [`[material]`](material.md) except `layers`; equal `plane` in all
    /// bodies.
    /// Example: `material = { young = 210e9, poisson = 0.3 }`. Value: table.
    pub material: Material,
}

#[derive(Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MeshKind {
    Block,
    HalfPlane,
    Gmsh,
    Abaqus,
    Unv,
}

/// The body's mesh.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename = "mesh")]
pub(super) struct MeshTable {
    /// Rectangle or box; rectangle that is fine at the left end of its top; [mesh file](#mesh-files) of Gmsh; mesh
    /// of an input file of Abaqus or CalculiX; universal file of Salome or I-DEAS.
    /// Example: `kind = "block"`.
    pub kind: MeshKind,
    /// Error of the stresses in the energy norm up to which a mesh of triangles or tetrahedra [refines
    /// itself](#meshes-that-refine-themselves); 0.02 for 2 %.
    /// Example: `refine = 0.05`.
    #[schemars(extend("exclusiveMinimum" = 0, "exclusiveMaximum" = 1))]
    pub refine: Option<f64>,
    /// Strains of the elements, see [nearly incompressible materials](#nearly-incompressible-materials): for
    /// `poisson` close to 0.5 `b-bar`, and for triangles, tetrahedra, prisms and cells of second order
    /// `nodal-volume`.
    /// Example: `element = "b-bar"`. Default: `"bilinear"`.
    pub element: Option<Element>,
    /// block: Lengths along x, y and z. A list in place of a length gives segments.
    /// Example: `size = [0.2, 0.1]`. Value: 2 or 3 lengths, m. Default: required.
    ///
    /// half-plane: Width and height.
    /// Example: `size = [1.0, 1.0]`. Value: 2 lengths, m. Default: required.
    #[schemars(length(min = 2, max = 3))]
    pub size: Option<Vec<OneOrMany<f64>>>,
    /// block: Elements along each length or segment.
    /// Example: `elements = [40, 20]`. Value: 2 or 3 integers. Default: required.
    #[schemars(length(min = 2, max = 3))]
    pub elements: Option<Vec<OneOrMany<i64>>>,
    /// block: Size of the last element over that of the first, in geometric progression.
    /// Example: `grading = [1, 0.2]`. Value: 2 or 3 numbers, 1e-6 to 1e6. Default: 1.
    #[schemars(length(min = 2, max = 3))]
    pub grading: Option<Vec<OneOrMany<f64>>>,
    /// block: Lowest corner, such as `[r, 0]` of a ring with the inner radius r.
    /// Example: `origin = [0.1, 0]`. Value: point, m. Default: origin.
    pub origin: Option<Vector>,
    /// block: Shape of the elements; names with a number of nodes are of second order.
    /// Example: `cells = "triangle6"`. Value: see below. Default: quadrilaterals, hexahedra.
    pub cells: Option<CellKind>,
    /// half-plane: Width of `contact`, from x = 0.
    /// Example: `contact_width = 0.1`. Value: length, m. Default: required.
    pub contact_width: Option<f64>,
    /// half-plane: Equal elements along `contact`.
    /// Example: `contact_elements = 40`. Value: integer. Default: required.
    #[schemars(extend("minimum" = 1))]
    pub contact_elements: Option<usize>,
    /// half-plane: Equal elements along the rest of the top.
    /// Example: `outer_elements = 20`. Value: integer. Default: required.
    #[schemars(extend("minimum" = 1))]
    pub outer_elements: Option<usize>,
    /// half-plane: Layers in geometric progression downwards, the top one square in the contact zone.
    /// Example: `layers = 30`. Value: integer. Default: required.
    #[schemars(extend("minimum" = 1))]
    pub layers: Option<usize>,
    /// gmsh, abaqus, unv: Mesh file, relative to the scene file.
    /// Example: `file = "part.msh"`. Value: path. Default: required.
    pub file: Option<String>,
    /// gmsh, abaqus, unv: Length of the file's unit; 0.001 for mm.
    /// Example: `scale = 0.001`. Value: length, m. Default: 1, or `[units]`.
    pub scale: Option<f64>,
}

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
        let (mesh, given) = (mesh.ok_or_else(|| missing("mesh"))?, material.ok_or_else(|| missing("material"))?);
        let element = mesh.element.unwrap_or_default();
        let refine = refine(&mesh)?;
        let (mesh, material) = (self::source(&mesh, reader)?, in_si(given, reader));
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

fn several(given: Vec<BodyTable>, reader: Reader<'_>) -> Result<Bodies, InputError> {
    let element = given[0].mesh.element.unwrap_or_default();
    let (mut materials, mut keys, mut refine) = (Vec::new(), Vec::new(), None::<f64>);
    let bodies = each("body", given, |k, BodyTable { name, at, mesh, material }| {
        let own = mesh.element.unwrap_or_default();
        if own != element {
            let (own, before) = (own.name(), element.name());
            let message = format!("the elements of `{name}` are \"{own}\", those before it \"{before}\"");
            let help = "all bodies have the same mesh.element, which is \"bilinear\" where it is left out";
            return Err(InputError::new("mesh.element", message, help));
        }
        refine = [refine, self::refine(&mesh)?].into_iter().flatten().reduce(f64::min);
        keys.push(format!("body[{k}].material"));
        keys.extend((0..material.groups.len()).map(|j| format!("body[{k}].material.group[{j}]")));
        materials.push((name.clone(), in_si(material, reader)));
        Ok(Body { name, mesh: self::source(&mesh, reader)?, at: at.map(|at| reader.point(at)) })
    })?;
    let material = Material::of_bodies(materials)?;
    Ok(Bodies { mesh: MeshSource::Bodies(bodies), element, refine, material, keys })
}

/// Converts a material as it was written to SI.
fn in_si(mut material: Material, reader: Reader<'_>) -> Material {
    let stress = |x: &mut f64| *x = reader.si(Quantity::Stress, *x);
    let density = |given: &mut Option<f64>| *given = given.map(|x| reader.si(Quantity::Density, x));
    let length = |x: &mut f64| *x = reader.length(*x);
    stress(&mut material.young);
    density(&mut material.density);
    material.thickness.iter_mut().for_each(length);
    for Layer { thickness, young, .. } in &mut material.layers {
        length(thickness);
        stress(young);
    }
    for group in &mut material.groups {
        stress(&mut group.young);
        density(&mut group.density);
    }
    material
}

/// Returns the error up to which the table `mesh` asks to refine it.
fn refine(mesh: &MeshTable) -> Result<Option<f64>, InputError> {
    let help = "the error of the stresses in the energy norm, such as 0.02 for 2 %";
    let is_valid = mesh.refine.is_none_or(|share| share > 0.0 && share < 1.0);
    ensure(is_valid, "mesh.refine", &mesh.refine.unwrap_or_default(), "above 0 and below 1", help)?;
    Ok(mesh.refine)
}

const KIND: &str = "mesh.kind";

/// Converts the table `mesh` of the table of `reader`.
pub(super) fn source(mesh: &MeshTable, reader: Reader<'_>) -> Result<MeshSource, InputError> {
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

fn block(mesh: &MeshTable, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, InputError> {
    let given = needed("mesh.elements", mesh.elements.as_ref(), KIND, "a block")?;
    let elements: Option<Vec<Vec<usize>>> =
        lists(given).into_iter().map(|axis| axis.into_iter().map(|n| usize::try_from(n).ok()).collect()).collect();
    let help = "give the numbers of elements along each axis";
    // Negative numbers of elements are invalid.
    ensure(elements.is_some(), "mesh.elements", given, "numbers of at least 1", help)?;
    let grading = mesh.grading.as_deref().map(lists);
    let mut source = MeshSource::segmented(size, &elements.unwrap_or_default(), grading.as_deref(), mesh.cells)?;
    if let MeshSource::Block { origin, .. } = &mut source {
        *origin = mesh.origin.map(|origin| reader.point(origin));
    }
    Ok(source)
}

fn half_plane(mesh: &MeshTable, size: &[Vec<f64>], reader: Reader<'_>) -> Result<MeshSource, InputError> {
    let whose = "a half-plane";
    let Ok(size) = <[f64; 2]>::try_from(size.concat()) else {
        return Err(InputError::new(KIND, "a half-plane has two lengths", "give mesh.size as [width, height]"));
    };
    let count = |key: &str, given: Option<usize>| needed(key, given, KIND, whose);
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
