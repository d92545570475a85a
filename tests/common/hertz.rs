//! The pressures of Hertz and the shear of Cattaneo and Mindlin (K. L. Johnson, Contact Mechanics, 1985, chapters 4
//! and 7), from the load, and how far what was found is from such a closed form.

use std::f64::consts::PI;

use stickslip::model::Model;
use stickslip::vector::norm;

/// `√(1 - x²/a²)`, 0 outside.
fn bow(x: f64, a: f64) -> f64 {
    (1.0 - (x / a).powi(2)).max(0.0).sqrt()
}

/// Contact of half-width or radius `a` (m) with the largest pressure `p0` (Pa).
#[derive(Debug, Clone, Copy)]
pub struct Hertz {
    pub a: f64,
    pub p0: f64,
}

impl Hertz {
    /// A cylinder of `radius` (m) under `load` (N/m) on a half-plane of `modulus` E/(1 - ν²) (Pa).
    pub fn line(load: f64, radius: f64, modulus: f64) -> Self {
        let a = (4.0 * load * radius / (PI * modulus)).sqrt();
        Hertz { a, p0: 2.0 * load / (PI * a) }
    }

    /// A sphere under `load` (N) on a half-space.
    pub fn sphere(load: f64, radius: f64, modulus: f64) -> Self {
        let a = (0.75 * load * radius / modulus).cbrt();
        Hertz { a, p0: 1.5 * load / (PI * a * a) }
    }

    /// The pressure (Pa) at the distance `x` (m) from the middle.
    pub fn pressure(&self, x: f64) -> f64 {
        self.p0 * bow(x, self.a)
    }

    /// The half-width (m) of the zone that sticks under the share `q` = Q/(μ P) of the load that slides.
    pub fn stick(&self, q: f64) -> f64 {
        self.a * (1.0 - q).sqrt()
    }

    /// The same for a sphere: the radius (m) of the zone that sticks.
    pub fn stick_of_sphere(&self, q: f64) -> f64 {
        self.a * (1.0 - q).cbrt()
    }

    /// The traction (Pa) over μ under a sphere at the distance `r` (m) from the middle, for the share `q`.
    pub fn shear_of_sphere(&self, r: f64, q: f64) -> f64 {
        self.shear_inside(r, self.stick_of_sphere(q))
    }

    /// The traction (Pa) over μ after the share `q` was reached for the first time.
    pub fn shear(&self, x: f64, q: f64) -> f64 {
        self.shear_inside(x, self.stick(q))
    }

    /// The traction (Pa) over μ with stick within `c` (m).
    fn shear_inside(&self, x: f64, c: f64) -> f64 {
        self.p0 * (bow(x, self.a) - c / self.a * bow(x, c))
    }

    /// The traction (Pa) over μ after unloading from the share `most` to `q`: reverse slip needs twice the friction.
    pub fn shear_unloaded(&self, x: f64, most: f64, q: f64) -> f64 {
        self.shear(x, most) - 2.0 * self.shear(x, 0.5 * (most - q))
    }
}

/// Points of the midpoint rule along a side of a facet: the edge of the contact runs through it anywhere.
const POINTS: usize = 20;

/// `∫ N exact dA` at each contact node, `exact` by position: the forces that the exact stress puts on the nodes of `boundary`. Facets
/// are straight or rectangles.
fn nodal(model: &Model, boundary: &str, exact: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    let mesh = &model.mesh;
    let mut at_node = vec![0.0; mesh.nodes.len()];
    for facet in &mesh.boundary(boundary).unwrap().facets {
        let corners = mesh.points(facet);
        let across = if corners.len() == 2 { 1 } else { POINTS };
        let area = norm(mesh.area_vector(facet)) / (POINTS * across) as f64;
        for k in 0..POINTS * across {
            let [s, t] = [k % POINTS, k / POINTS].map(|k| (k as f64 + 0.5) / POINTS as f64);
            let shape = match corners.len() {
                2 => vec![1.0 - s, s],
                _ => vec![(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t],
            };
            let x = [0, 1, 2].map(|c| shape.iter().zip(&corners).map(|(n, corner)| n * corner[c]).sum());
            let stress = exact(x) * mesh.geometry.depth(x);
            facet.iter().zip(&shape).for_each(|(&node, n)| at_node[node] += n * stress * area);
        }
    }
    model.contacts.iter().map(|contact| at_node[contact.node]).collect()
}

/// The distance of the contact forces from those of an exact stress on `boundary`, as stresses in the L2 norm:
/// `√(Σ (p - p_exact)² / l / Σ p_exact² / l)` over the contact nodes.
pub fn distance(model: &Model, boundary: &str, forces: &[f64], exact: impl Fn([f64; 3]) -> f64) -> f64 {
    let (mut error, mut size) = (0.0, 0.0);
    for ((contact, found), exact) in model.contacts.iter().zip(forces).zip(nodal(model, boundary, exact)) {
        error += (found - exact).powi(2) / contact.weight;
        size += exact * exact / contact.weight;
    }
    (error / size).sqrt()
}

/// The power of the element size with which `errors` fall from the first to the last of meshes with so many `elements`.
pub fn order(elements: &[usize], errors: &[f64]) -> f64 {
    let fall = |values: &[f64]| (values[0] / values[values.len() - 1]).abs().ln();
    fall(errors) / -fall(&elements.iter().map(|&n| n as f64).collect::<Vec<_>>())
}
