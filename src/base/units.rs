//! Units: those of the internal numbers ([`Scaling`], numbers of order one), and those of input and output
//! ([`Units`]). All other numbers are SI.

mod rounded;
mod system;
mod user;

pub use rounded::six_digits;
pub use system::{Depth, Quantity, UnitSystem};
pub use user::{LengthUnit, StressUnit, Units};

use serde::{Deserialize, Serialize};

/// A unit of force and a unit of length for the unknowns of one run.
///
/// Contact forces, displacements and stiffness of order one make the factorisation of the mixed system `(u, p)`
/// reliable. With newtons and metres its pivots span eleven more decades than necessary. The units chosen by
/// [`Scaling::near`] are powers of two, so that conversions are exact. The constants `paper` of the interior point
/// method have MN and 10⁻⁵ m, as in the paper.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// The unit of force, N.
    pub force: f64,
    /// The unit of displacement, m.
    pub length: f64,
}

impl Scaling {
    /// Newtons and metres: no scaling.
    pub const SI: Scaling = Scaling { force: 1.0, length: 1.0 };

    /// Returns the powers of two nearest to the given `stiffness` (N/m) and `length` (m).
    pub fn near(stiffness: f64, length: f64) -> Self {
        let length = power_of_two(length);
        Scaling { force: power_of_two(stiffness) * length, length }
    }

    /// Returns the unit of stiffness, N/m.
    pub fn stiffness(&self) -> f64 {
        self.force / self.length
    }
}

/// Returns the power of two nearest to `x`; 1 if `x` is zero or not finite.
fn power_of_two(x: f64) -> f64 {
    if x.is_normal() { x.abs().log2().round().exp2() } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_powers_of_two() {
        let scaling = Scaling::near(210e9, 3e-5);
        for unit in [scaling.force, scaling.length, scaling.stiffness()] {
            assert_eq!(unit.log2().fract(), 0.0);
        }
        assert!((0.7..1.5).contains(&(210e9 / scaling.stiffness())));
        assert_eq!(Scaling::near(0.0, f64::INFINITY), Scaling::SI);
    }
}
