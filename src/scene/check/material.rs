//! Checks of `[material]`.

use toml::Spanned;

use super::{Check, name};
use crate::scene::document::{self, Tuple};
use crate::scene::{Layer, Material, MaterialGroup, Plane, SceneError};

/// What a constant of a material must be.
struct Limit {
    holds: fn(f64) -> bool,
    must: &'static str,
    help: &'static str,
}

const THICKNESS: Limit = Limit { holds: |t| t > 0.0, must: "positive", help: "give the thickness of the layer in m" };

const YOUNG: Limit = Limit { holds: |young| young > 0.0, must: "positive", help: "give Young's modulus in Pa" };

const POISSON: Limit = Limit {
    holds: |poisson| poisson > -1.0 && poisson < 0.5,
    must: "above -1 and below 0.5",
    help: "thermodynamics sets the lower limit; an incompressible material is beyond displacements alone, \
           use e.g. 0.49, or 0.4999 with mesh.element = \"b-bar\"",
};

impl Check<'_> {
    pub(super) fn material(&self, material: &document::Material) -> Result<Material, SceneError> {
        let young = self.limited("material.young", &material.young, &YOUNG)?;
        let poisson = self.limited("material.poisson", &material.poisson, &POISSON)?;
        let mut layers = Vec::with_capacity(material.layers.len());
        let mut top = 0.0;
        for (k, given) in material.layers.iter().enumerate() {
            let Tuple([thickness, young, poisson]) = given.get_ref();
            let name = |what: &str| format!("{what} in material.layers[{k}]");
            top += self.limited(&name("the thickness"), thickness, &THICKNESS)?;
            let young = self.limited(&name("Young's modulus"), young, &YOUNG)?;
            let poisson = self.limited(&name("Poisson's ratio"), poisson, &POISSON)?;
            layers.push(Layer { top, young, poisson, span: given.span() });
        }
        let groups = self.material_groups(&material.group)?;
        if let (Some(layer), Some(_)) = (material.layers.first(), groups.first()) {
            let message = "the material has layers and groups, which both say what an element is made of";
            return self.fail(layer.span(), message, "keep material.layers or [[material.group]]");
        }
        let plane = material.plane.as_ref().map_or(Plane::default(), |plane| *plane.get_ref());
        let plane_span = material.plane.as_ref().map(Spanned::span);
        Ok(Material { young, poisson, plane, plane_span, layers, groups })
    }

    fn material_groups(&self, given: &[document::MaterialGroup]) -> Result<Vec<MaterialGroup>, SceneError> {
        let mut groups: Vec<MaterialGroup> = Vec::with_capacity(given.len());
        for group in given {
            let name = name(group.name.clone());
            if groups.iter().any(|other| other.name.as_str() == name.as_str()) {
                let message = format!("the group `{name}` has a [[material.group]] already");
                return self.fail(name.span(), message, "keep one [[material.group]] for each group");
            }
            let young = self.limited(&format!("Young's modulus of the group `{name}`"), &group.young, &YOUNG)?;
            let poisson = self.limited(&format!("Poisson's ratio of the group `{name}`"), &group.poisson, &POISSON)?;
            groups.push(MaterialGroup { name, young, poisson });
        }
        Ok(groups)
    }

    fn limited(&self, name: &str, value: &Spanned<f64>, limit: &Limit) -> Result<f64, SceneError> {
        let x = self.finite(name, value)?;
        self.demand((limit.holds)(x), name, value, limit.must, limit.help)?;
        Ok(x)
    }
}
