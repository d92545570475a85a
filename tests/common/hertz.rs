//! The pressures of Hertz and the shear of Cattaneo and Mindlin (K. L. Johnson, Contact Mechanics, 1985, chapters 4
//! and 7), from the load.

use std::f64::consts::PI;

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
