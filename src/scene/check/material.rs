//! Checks of `[material]`.

use toml::Spanned;

use super::Check;
use crate::scene::document::{self, Tuple};
use crate::scene::{Layer, Material, SceneError};

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
        Ok(Material { young, poisson, plane: material.plane, layers })
    }

    fn limited(&self, name: &str, value: &Spanned<f64>, limit: &Limit) -> Result<f64, SceneError> {
        let x = self.finite(name, value)?;
        self.demand((limit.holds)(x), name, value, limit.must, limit.help)?;
        Ok(x)
    }
}
