//! The body of a scene, or its bodies: mesh, elements and materials.

use super::{Reader, mesh};
use crate::base::input_error::InputError;
use crate::base::units::Quantity;
use crate::body::fem::{Element, Layer, Material, MaterialGroup};
use crate::body::mesh::{Body, MeshSource};
use crate::scene::SceneError;
use crate::scene::document::{self, Document, Tuple};

/// Mesh, elements and materials of all bodies of a scene.
pub(super) struct Bodies {
    pub mesh: MeshSource,
    pub element: Element,
    pub material: Material,
    /// The key of the material of each group of `material`, if there are several bodies.
    pub keys: Vec<String>,
}

/// Takes the bodies out of `document`.
pub(super) fn bodies(document: &mut Document, reader: Reader<'_>) -> Result<Bodies, SceneError> {
    let (mesh, material, body) = (document.mesh.take(), document.material.take(), std::mem::take(&mut document.body));
    if body.is_empty() {
        let missing = |table: &str| {
            let help = "add the key; `stickslip init block` shows a complete scene";
            reader.at(InputError::new("", format!("missing field `{table}`"), help))
        };
        let (mesh, given) = (mesh.ok_or_else(|| missing("mesh"))?, material.ok_or_else(|| missing("material"))?);
        let element = mesh.element.unwrap_or_default();
        let (mesh, material) = (mesh::source(&mesh, reader)?, self::material(given, reader));
        return Ok(Bodies { mesh, element, material, keys: Vec::new() });
    }
    for (table, given) in [("mesh", mesh.is_some()), ("material", material.is_some())] {
        if given {
            let message = format!("the scene has [{table}] and [[body]]");
            let help = format!("give each body a [body.{table}] of its own and remove [{table}], or remove [[body]]");
            return reader.fault(table, message, help);
        }
    }
    several(body, reader)
}

fn several(given: Vec<document::BodyTable>, reader: Reader<'_>) -> Result<Bodies, SceneError> {
    let element = given[0].mesh.element.unwrap_or_default();
    let (mut materials, mut keys) = (Vec::new(), Vec::new());
    let bodies = reader.each("body", given, |document::BodyTable { name, at, mesh, material }, reader| {
        let own = mesh.element.unwrap_or_default();
        if own != element {
            let (own, before) = (own.name(), element.name());
            let message = format!("the elements of `{name}` are \"{own}\", those before it \"{before}\"");
            let help = "all bodies have the same mesh.element, which is \"bilinear\" where it is left out";
            return reader.fault("mesh.element", message, help);
        }
        keys.push(reader.path("material"));
        keys.extend((0..material.group.len()).map(|j| reader.path(&format!("material.group[{j}]"))));
        materials.push((name.clone(), self::material(material, reader)));
        Ok(Body { name, mesh: mesh::source(&mesh, reader)?, at: at.map(|at| reader.point(at)) })
    })?;
    let material = Material::of_bodies(materials).map_err(|fault| reader.at(fault))?;
    Ok(Bodies { mesh: MeshSource::Bodies(bodies), element, material, keys })
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
