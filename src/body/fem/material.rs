//! The materials of a body, and the isotropic elastic law of each cell of its mesh.

use serde::{Deserialize, Serialize};

use crate::algebra::vector::dot;
use crate::base::input_error::{InputError, ensure, finite, positive};
use crate::base::units::Depth;
use crate::body::mesh::{Cell, Mesh, is_called};

/// The isotropic linear elastic materials of a body; in two dimensions it is of unit thickness, or axisymmetric.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, rename = "material")]
pub struct Material {
    /// Young's modulus.
    /// Example: `young = 210e9`. Value: number, Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio.
    /// Example: `poisson = 0.3`.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Plane body, or half the section of a body of revolution about x = 0.
    /// Example: `plane = "stress"`. Default: `"strain"`.
    pub plane: Option<Plane>,
    /// Thickness of a plane body, equal in all bodies. Forces, moments, point springs and energies of scene and
    /// results are then those of the whole body.
    /// Example: `thickness = 0.02`. Value: length, m. Default: unit depth.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: Option<f64>,
    /// Mass density, for the loads `acceleration` and `rotation`.
    /// Example: `density = 7850`. Value: number, kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// Coefficient of thermal expansion, for the load `temperature`; bodies that stay cold need none.
    /// Example: `expansion = 12e-6`. Value: number, 1/K.
    pub expansion: Option<f64>,
    /// Layers from the bottom up (along y, in space z). An element belongs to the layer at its centre; above them
    /// is the material itself.
    /// Example: `layers = [[0.01, 70e9, 0.33]]`. Value: list of `[thickness, young, poisson]`, m, Pa, –.
    #[serde(default)]
    pub layers: Vec<Layer>,
    /// The materials of groups of elements; other groups are of the material itself.
    #[serde(default, rename = "group")]
    pub groups: Vec<MaterialGroup>,
}

/// The material of a group of elements.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, rename = "material_group")]
pub struct MaterialGroup {
    /// Physical group of the Gmsh file; a block is the one group `body`.
    /// Example: `name = "core"`. Value: name.
    pub name: String,
    /// Young's modulus.
    /// Example: `young = 70e9`. Value: number, Pa.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub young: f64,
    /// Poisson's ratio.
    /// Example: `poisson = 0.33`.
    #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 0.5))]
    pub poisson: f64,
    /// Mass density.
    /// Example: `density = 2700`. Value: number, kg/m³. Default: of `[material]`.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub density: Option<f64>,
    /// Coefficient of thermal expansion.
    /// Example: `expansion = 23e-6`. Value: number, 1/K. Default: of `[material]`.
    pub expansion: Option<f64>,
}

/// A horizontal layer of the body.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, schemars::JsonSchema)]
#[serde(try_from = "Vec<f64>")]
#[schemars(inline, with = "Vec<f64>", extend("minItems" = 3, "maxItems" = 3))]
pub struct Layer {
    /// The thickness, m.
    pub thickness: f64,
    /// Young's modulus, Pa.
    pub young: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub poisson: f64,
}

impl TryFrom<Vec<f64>> for Layer {
    type Error = String;

    fn try_from(values: Vec<f64>) -> Result<Self, String> {
        match values[..] {
            [thickness, young, poisson] => Ok(Layer { thickness, young, poisson }),
            _ => Err(format!("invalid length {}, expected 3 values", values.len())),
        }
    }
}

/// The state of a body in two dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// Plane strain, `ε_zz = 0`: a slice of a long body.
    #[default]
    Strain,
    /// Plane stress, `σ_zz = 0`: a thin plate.
    Stress,
    /// Half the section of a body of revolution about the y axis, with `ε_zz = u_x / x`.
    Axisymmetric,
    /// As [`Plane::Axisymmetric`], with displacements `u_z` around the axis: `γ_yz = ∂u_z/∂y`, `γ_zx = ∂u_z/∂x - u_z / x`.
    #[serde(rename = "axisymmetric-torsion")]
    Torsion,
}

/// A check of a material constant with its key.
type Limit = fn(&str, f64) -> Result<(), InputError>;

const THICKNESS: Limit = |name, value| positive(name, value, "give the thickness of the layer in m or as [units] says");

const YOUNG: Limit = |name, value| positive(name, value, "give Young's modulus in Pa or as [units] says");

const POISSON: Limit = |name, value| {
    let help = "thermodynamics sets the lower limit; an incompressible material is beyond displacements alone, \
                use e.g. 0.49, or 0.4999 with mesh.element = \"b-bar\" or \"nodal-volume\"";
    finite(name, value)?;
    ensure(value > -1.0 && value < 0.5, name, &value, "above -1 and below 0.5", help)
};

const DENSITY: Limit = |name, value| positive(name, value, "give the density in kg/m³ or as [units] says");

const EXPANSION: Limit = |name, value| finite(name, value);

impl Material {
    /// Creates one material for the whole body with Young's modulus (Pa) and Poisson's ratio; in two dimensions in
    /// plane strain.
    pub fn new(young: f64, poisson: f64) -> Self {
        Material { young, poisson, ..Material::default() }
    }

    /// Combines the materials of `bodies`, by their names, as groups of the joined mesh, see
    /// [`crate::body::mesh::MeshSource::Bodies`]. A group of a body is called `name:group` there.
    ///
    /// # Errors
    /// [`InputError`] with the key of the body, such as `body[1].material.plane`: layers, which only a single body may
    /// have; a plane state different from that of the first body; no body.
    pub fn of_bodies(bodies: impl IntoIterator<Item = (String, Material)>) -> Result<Self, InputError> {
        let mut all: Option<Material> = None;
        for (k, (name, material)) in bodies.into_iter().enumerate() {
            let Material { young, poisson, plane, thickness, density, expansion, layers, groups } = material;
            let fault = |key: &str, message: String, help: &str| {
                InputError::new(format!("body[{k}].material.{key}"), message, help)
            };
            if !layers.is_empty() {
                let message = format!("the body `{name}` has layers, which are those of a scene with a single body");
                return Err(fault("layers", message, "use groups of its mesh, or a body for each layer"));
            }
            // Density and expansion of one body do not apply to others.
            let all = all.get_or_insert_with(|| Material { young, poisson, plane, thickness, ..Material::default() });
            if plane.unwrap_or_default() != all.plane.unwrap_or_default() {
                let message = format!("the body `{name}` is in another plane state than those before it");
                let help = "all bodies have the same material.plane, which is \"strain\" where it is left out";
                return Err(fault("plane", message, help));
            }
            if thickness != all.thickness {
                let message = format!("the body `{name}` has another thickness than those before it");
                return Err(fault("thickness", message, "give all bodies the same material.thickness, or none"));
            }
            all.plane = all.plane.or(plane);
            all.groups.push(MaterialGroup { name: name.clone(), young, poisson, density, expansion });
            all.groups.extend(groups.into_iter().map(|group| MaterialGroup {
                name: format!("{name}:{}", group.name),
                density: group.density.or(density),
                expansion: group.expansion.or(expansion),
                ..group
            }));
        }
        all.ok_or_else(|| InputError::new("body", "there is no body", "give one at least"))
    }

    /// Sets the plane state.
    #[must_use]
    pub fn in_plane(self, plane: Plane) -> Self {
        Material { plane: Some(plane), ..self }
    }

    /// Returns `true` for a body of revolution.
    pub fn is_axisymmetric(&self) -> bool {
        matches!(self.plane, Some(Plane::Axisymmetric | Plane::Torsion))
    }

    /// Returns the depth to which the forces of a body with `dimension` dimensions belong.
    pub fn depth(&self, dimension: usize) -> Depth {
        match self.thickness {
            _ if dimension == 3 || self.is_axisymmetric() => Depth::Whole,
            Some(thickness) => Depth::Thickness(thickness),
            None => Depth::Unit,
        }
    }

    /// Checks that all constants are valid and that layers and groups do not contradict each other.
    ///
    /// # Errors
    /// [`InputError`] with the key of the wrong value, such as `material.young`.
    pub fn check(&self) -> Result<(), InputError> {
        YOUNG("material.young", self.young)?;
        POISSON("material.poisson", self.poisson)?;
        self.density.map_or(Ok(()), |density| DENSITY("material.density", density))?;
        self.expansion.map_or(Ok(()), |expansion| EXPANSION("material.expansion", expansion))?;
        if let Some(thickness) = self.thickness {
            THICKNESS("material.thickness", thickness)?;
            if self.is_axisymmetric() {
                let message = "a body of revolution has no thickness";
                let help = "remove the key: forces are those all around";
                return Err(InputError::new("material.thickness", message, help));
            }
        }
        for (k, &Layer { thickness, young, poisson }) in self.layers.iter().enumerate() {
            let key = format!("material.layers[{k}]");
            let of_layer = |what: &str, value: f64, limit: Limit| {
                limit(&format!("{what} in {key}"), value).map_err(|fault| InputError { key: key.clone(), ..fault })
            };
            of_layer("the thickness", thickness, THICKNESS)?;
            of_layer("Young's modulus", young, YOUNG)?;
            of_layer("Poisson's ratio", poisson, POISSON)?;
        }
        for (k, MaterialGroup { name, young, poisson, density, expansion }) in self.groups.iter().enumerate() {
            let key = |what: &str| format!("material.group[{k}].{what}");
            if self.groups[..k].iter().any(|other| other.name == *name) {
                let message = format!("the group `{name}` has a [[material.group]] already");
                return Err(InputError::new(key("name"), message, "keep one [[material.group]] for each group"));
            }
            let of_group = |what: &str, key: String, value: f64, limit: Limit| {
                limit(&format!("{what} of the group `{name}`"), value).map_err(|fault| InputError { key, ..fault })
            };
            of_group("Young's modulus", key("young"), *young, YOUNG)?;
            of_group("Poisson's ratio", key("poisson"), *poisson, POISSON)?;
            density.map_or(Ok(()), |density| of_group("the density", key("density"), density, DENSITY))?;
            expansion.map_or(Ok(()), |value| of_group("the expansion", key("expansion"), value, EXPANSION))?;
        }
        if !self.layers.is_empty() && !self.groups.is_empty() {
            let message = "the material has layers and groups, which both say what an element is made of";
            return Err(InputError::new("material.layers", message, "keep material.layers or [[material.group]]"));
        }
        Ok(())
    }

    /// Returns the heights of the upper sides of the layers above the bottom of the body, m.
    pub fn tops(&self) -> Vec<f64> {
        let mut top = 0.0;
        let above = |layer: &Layer| {
            top += layer.thickness;
            top
        };
        self.layers.iter().map(above).collect()
    }

    /// Returns the number of the layer at `height` (m) above the bottom of the body; `None` in the main material.
    pub fn layer(&self, height: f64) -> Option<usize> {
        self.tops().iter().position(|top| height < *top)
    }

    /// Returns the law of each cell of `mesh`: that of its group, of the layer that contains its centre, or of the main
    /// material.
    ///
    /// # Errors
    /// [`InputError`] with the key that contradicts `mesh`: a plane state in three dimensions, a missing group, a layer
    /// without a cell.
    pub fn laws(&self, mesh: &Mesh) -> Result<Vec<Elasticity>, InputError> {
        if mesh.dimension == 3 && self.plane.is_some() {
            let message = "the material has a plane state, but the body has three dimensions";
            return Err(InputError::new("material.plane", message, "remove material.plane"));
        }
        if mesh.dimension == 3 && self.thickness.is_some() {
            let message = "the material has a thickness, but the body has three dimensions";
            return Err(InputError::new("material.thickness", message, "remove material.thickness"));
        }
        let law = |young, poisson| match (mesh.dimension, self.plane.unwrap_or_default()) {
            (2, Plane::Stress) => Elasticity::plane_stress(young, poisson),
            // Plane strain and axisymmetry use the law in three dimensions.
            _ => Elasticity::isotropic(young, poisson),
        };
        let base = law(self.young, self.poisson);
        if self.layers.is_empty() {
            let groups = self.groups_of(mesh)?;
            let of_group = |k: Option<usize>| k.map_or(base, |k| law(self.groups[k].young, self.groups[k].poisson));
            let laws: Vec<Elasticity> = groups.into_iter().map(of_group).collect();
            return Ok(mesh.cells.iter().map(|cell| laws[cell.group]).collect());
        }
        let height = |e: usize| mesh.centre(e)[mesh.dimension - 1];
        let of_cell: Vec<Option<usize>> = (0..mesh.cells.len()).map(|e| self.layer(height(e))).collect();
        if let Some(k) = (0..self.layers.len()).find(|k| !of_cell.contains(&Some(*k))) {
            let message = format!("no element of the mesh has its centre in material.layers[{k}]");
            let help = "use more elements, a thicker layer or fewer layers; thicknesses are in m or as [units] says, from the bottom up";
            return Err(InputError::new(format!("material.layers[{k}]"), message, help));
        }
        let laws: Vec<Elasticity> = self.layers.iter().map(|layer| law(layer.young, layer.poisson)).collect();
        Ok(of_cell.into_iter().map(|layer| layer.map_or(base, |k| laws[k])).collect())
    }

    /// Returns the density (kg/m³) of each cell of `mesh`.
    ///
    /// # Errors
    /// [`InputError`] with the missing key, or the key of a group that `mesh` does not have.
    pub fn densities(&self, mesh: &Mesh) -> Result<Vec<f64>, InputError> {
        let help = "give the density, e.g. 7850 kg/m³ for steel, 7.85e-9 t/mm³ where [units] has mm and MPa";
        self.of_cells(mesh, "density", help, self.density, |group| group.density, |_| true)
    }

    /// Returns the coefficient of thermal expansion (1/K) of each cell of `mesh`; 0 where it is missing and not `needed`.
    ///
    /// # Errors
    /// [`InputError`] with the key that is missing and needed, or the key of a group that `mesh` does not have.
    pub fn expansions(&self, mesh: &Mesh, needed: impl Fn(usize) -> bool) -> Result<Vec<f64>, InputError> {
        let help = "give the coefficient of thermal expansion in 1/K, e.g. 12e-6 for steel";
        self.of_cells(mesh, "expansion", help, self.expansion, |group| group.expansion, needed)
    }

    /// Returns a constant of each cell: that of its group, otherwise that of the main material, `itself`; 0 where both are
    /// missing and it is not `needed`.
    fn of_cells(
        &self,
        mesh: &Mesh,
        key: &str,
        help: &str,
        itself: Option<f64>,
        of_group: impl Fn(&MaterialGroup) -> Option<f64>,
        needed: impl Fn(usize) -> bool,
    ) -> Result<Vec<f64>, InputError> {
        let groups = self.groups_of(mesh)?;
        let missing = |group: usize| match groups[group] {
            Some(k) => {
                let message = format!("a load needs the {key} of the group `{}`", self.groups[k].name);
                InputError::new(format!("material.group[{k}].{key}"), message, help)
            }
            None => InputError::new(format!("material.{key}"), format!("a load needs the {key} of the material"), help),
        };
        let value = |group: usize| groups[group].and_then(|k| of_group(&self.groups[k])).or(itself);
        let of_cell = |(e, cell): (usize, &Cell)| match value(cell.group) {
            Some(value) => Ok(value),
            None if needed(e) => Err(missing(cell.group)),
            None => Ok(0.0),
        };
        mesh.cells.iter().enumerate().map(of_cell).collect()
    }

    /// Returns for each group of `mesh` the index of its material group. A group `upper:rim` that is not named has the
    /// material of `upper`, if that is named.
    fn groups_of(&self, mesh: &Mesh) -> Result<Vec<Option<usize>>, InputError> {
        let body = |group: &'_ str| group.split_once(':').map(|(body, _)| body.to_string());
        for (k, MaterialGroup { name, .. }) in self.groups.iter().enumerate() {
            let has = |group: &String| {
                let members = mesh.notes.members(group).iter().cloned().chain([group.clone()]).chain(body(group));
                members.into_iter().any(|other| is_called(&other, name))
            };
            if !mesh.groups.iter().any(has) {
                let message = format!("the mesh has no material group `{name}`");
                let named: Vec<_> = mesh.groups.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
                let help = format!("the mesh has the groups {}", named.join(", "));
                return Err(InputError::new(format!("material.group[{k}].name"), message, help));
            }
        }
        let called = |name: &str| {
            let exact = self.groups.iter().position(|group| group.name == name);
            exact.or_else(|| self.groups.iter().position(|group| is_called(name, &group.name)))
        };
        let one_of = |group: &String| -> Result<Option<usize>, InputError> {
            let members: Vec<usize> = mesh.notes.members(group).iter().filter_map(|member| called(member)).collect();
            match members[..] {
                [] => Ok(called(group).or_else(|| called(&body(group)?))),
                [one] => Ok(Some(one)),
                [first, second, ..] => {
                    let [first, name] = [first, second].map(|k| &self.groups[k].name);
                    let message =
                        format!("elements are in the groups `{first}` and `{name}`, which have a material each");
                    let help = "name one of the two groups, or let them share no element";
                    Err(InputError::new(format!("material.group[{second}].name"), message, help))
                }
            }
        };
        mesh.groups.iter().map(one_of).collect()
    }
}

/// An isotropic elastic law with Lamé's coefficients: `σ = λ tr(ε) 1 + 2 μ ε`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elasticity {
    /// `λ`, Pa.
    pub lambda: f64,
    /// The shear modulus `μ`, Pa.
    pub mu: f64,
}

impl Elasticity {
    /// Creates the law in three dimensions, in plane strain and of bodies of revolution. `young` in Pa,
    /// `-1 < poisson < 0.5`.
    pub fn isotropic(young: f64, poisson: f64) -> Self {
        // 1 - 2ν is exact for ν > 1/4, so that λ keeps its digits for ν arbitrarily close to 1/2.
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        Elasticity { lambda, mu: shear_modulus(young, poisson) }
    }

    /// Creates the law of plane stress, `σ_zz = 0`, for a thin plate. `young` in Pa. Here `λ` is `2λμ / (λ + 2μ)` of
    /// the material, which results from the elimination of `ε_zz`.
    pub fn plane_stress(young: f64, poisson: f64) -> Self {
        let lambda = young * poisson / ((1.0 + poisson) * (1.0 - poisson));
        Elasticity { lambda, mu: shear_modulus(young, poisson) }
    }

    /// Computes the stress `(σ_xx, σ_yy, σ_zz, τ_xy, τ_yz, τ_zx)` (Pa) of the strain
    /// `(ε_xx, ε_yy, ε_zz, γ_xy, γ_yz, γ_zx)`. In plane stress, `ε_zz` must be 0 and `σ_zz` has no meaning.
    pub fn stress(&self, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 6] {
        let pressure = self.lambda * (xx + yy + zz);
        let direct = |strain: f64| pressure + 2.0 * self.mu * strain;
        [direct(xx), direct(yy), direct(zz), self.mu * xy, self.mu * yz, self.mu * zx]
    }

    /// Changes a strain such that a surface with unit normal `n` has no traction; the strains along the surface stay.
    pub fn released(&self, mut strain: [f64; 6], n: [f64; 3]) -> [f64; 6] {
        let [xx, yy, zz, xy, yz, zx] = self.stress(strain);
        let traction = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]].map(|row| dot(row, n));
        // (λ + μ) (n·a) n + μ a is the traction of the strain of n ⊗ a.
        let share = (self.lambda + self.mu) / (self.lambda + 2.0 * self.mu) * dot(traction, n);
        let a: [f64; 3] = std::array::from_fn(|c| (share * n[c] - traction[c]) / self.mu);
        for (k, (r, c)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].into_iter().enumerate() {
            strain[k] += if r == c { n[r] * a[r] } else { n[r] * a[c] + n[c] * a[r] };
        }
        strain
    }

    /// Computes the energy density `½ ε D ε` (J/m³) of a strain, with components as in [`Elasticity::stress`].
    pub fn energy_density(&self, strain: &[f64; 6]) -> f64 {
        0.5 * self.stress(*strain).iter().zip(strain).map(|(s, e)| s * e).sum::<f64>()
    }

    /// Returns the deviatoric part of the law: `2 μ (ε - ⅓ tr(ε) 1)`.
    #[must_use]
    pub fn deviatoric(&self) -> Self {
        Elasticity { lambda: -2.0 / 3.0 * self.mu, ..*self }
    }

    /// Returns the bulk modulus `λ + 2/3 μ`, Pa.
    pub fn bulk(&self) -> f64 {
        self.lambda + 2.0 / 3.0 * self.mu
    }
}

/// Returns a number for each law; equal laws have the same number.
pub fn numbered(laws: impl Iterator<Item = Elasticity>) -> Vec<usize> {
    let mut different: Vec<Elasticity> = Vec::new();
    let number = |law: Elasticity| {
        different.iter().position(|other| *other == law).unwrap_or_else(|| {
            different.push(law);
            different.len() - 1
        })
    };
    laws.map(number).collect()
}

fn shear_modulus(young: f64, poisson: f64) -> f64 {
    0.5 * young / (1.0 + poisson)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniaxial_states() {
        let (young, poisson) = (210e9, 0.3);
        let plate = Elasticity::plane_stress(young, poisson).stress([1e-3, -poisson * 1e-3, 0.0, 0.0, 0.0, 0.0]);
        assert!((plate[0] - young * 1e-3).abs() < 1e-3 && plate[1].abs() < 1e-3);
        // In plane strain, σ_zz = ν (σ_xx + σ_yy) makes the modulus E / (1 - ν²).
        let strain = Elasticity::isotropic(young, poisson);
        let lateral = -poisson / (1.0 - poisson) * 1e-3;
        let stress = strain.stress([1e-3, lateral, 0.0, 0.0, 0.0, 0.0]);
        assert!((stress[0] / (young / (1.0 - poisson * poisson) * 1e-3) - 1.0).abs() < 1e-14);
        assert!((stress[2] / (poisson * stress[0]) - 1.0).abs() < 1e-14);
        assert!(stress[1].abs() < 1e-3);
    }

    #[test]
    fn the_bulk_modulus_keeps_its_digits_near_incompressibility() {
        // 1 - 2ν = 2⁻³⁰ exactly.
        let compressibility = 2.0_f64.powi(-30);
        let poisson = 0.5 * (1.0 - compressibility);
        let material = Elasticity::isotropic(1.0, poisson);
        let bulk = 1.0 / (3.0 * compressibility);
        assert!(((material.lambda + 2.0 / 3.0 * material.mu) / bulk - 1.0).abs() < 1e-15);
    }
}
