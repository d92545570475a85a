//! The body of a scene, or its bodies: mesh, elements and materials.

use crate::base::input_error::InputError;
use crate::body::fem::{Element, Layer, Material, MaterialGroup};
use crate::body::mesh::{Body, MeshSource};
use crate::scene::document::{self, Document, Tuple};
use crate::scene::error::Source;

use super::mesh;

/// Mesh, elements and materials of all bodies of a scene.
pub(super) struct Bodies {
    pub mesh: MeshSource,
    pub element: Element,
    pub material: Material,
    /// The key of the material of each group of `material`, if there are several bodies.
    pub keys: Vec<String>,
}

/// Takes the bodies out of `document`.
pub(super) fn bodies(document: &mut Document, source: &Source) -> Result<Bodies, InputError> {
    let (mesh, material, body) = (document.mesh.take(), document.material.take(), std::mem::take(&mut document.body));
    if body.is_empty() {
        let missing = |table: &str| {
            let help = "add the key; `stickslip init block` shows a complete scene";
            InputError::new("", format!("missing field `{table}`"), help)
        };
        let (mesh, given) = (mesh.ok_or_else(|| missing("mesh"))?, material.ok_or_else(|| missing("material"))?);
        let element = mesh.element.unwrap_or_default();
        return Ok(Bodies {
            mesh: mesh::source(&mesh, source)?,
            element,
            material: self::material(given),
            keys: Vec::new(),
        });
    }
    for (table, given) in [("mesh", mesh.is_some()), ("material", material.is_some())] {
        if given {
            let message = format!("the scene has [{table}] and [[body]]");
            let help = format!("give each body a [body.{table}] of its own and remove [{table}], or remove [[body]]");
            return Err(InputError::new(table, message, help));
        }
    }
    several(body, source)
}

fn several(given: Vec<document::BodyTable>, source: &Source) -> Result<Bodies, InputError> {
    let element = given[0].mesh.element.unwrap_or_default();
    let (mut bodies, mut materials, mut keys) = (Vec::new(), Vec::new(), Vec::new());
    for (k, document::BodyTable { name, at, mesh, material }) in given.into_iter().enumerate() {
        let key = format!("body[{k}]");
        if mesh.element.unwrap_or_default() != element {
            let message = format!(
                "the elements of `{name}` are \"{}\", those before it \"{}\"",
                mesh.element.unwrap_or_default().name(),
                element.name()
            );
            let help = "all bodies have the same mesh.element, which is \"bilinear\" where it is left out";
            return Err(InputError::new(format!("{key}.mesh.element"), message, help));
        }
        let mesh = mesh::source(&mesh, source).map_err(|fault| fault.with_key(&key))?;
        keys.push(format!("{key}.material"));
        keys.extend((0..material.group.len()).map(|j| format!("{key}.material.group[{j}]")));
        materials.push((name.clone(), self::material(material)));
        bodies.push(Body { name, mesh, at });
    }
    Ok(Bodies { mesh: MeshSource::Bodies(bodies), element, material: Material::of_bodies(materials)?, keys })
}

fn material(given: document::Material) -> Material {
    let document::Material { young, poisson, plane, thickness, density, expansion, layers, group: group_list } = given;
    let layer = |Tuple([thickness, young, poisson])| Layer { thickness, young, poisson };
    let group = |document::MaterialGroup { name, young, poisson, density, expansion }| MaterialGroup {
        name,
        young,
        poisson,
        density,
        expansion,
    };
    let (layers, groups) = (layers.into_iter().map(layer).collect(), group_list.into_iter().map(group).collect());
    Material { young, poisson, plane, thickness, density, expansion, layers, groups }
}
