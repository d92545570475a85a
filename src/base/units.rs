//! Units: those of the internal numbers ([`Scaling`], numbers of order one), and those of input and output
//! ([`Units`]). All other numbers are SI.

mod system;

use serde::{Deserialize, Serialize};

pub use system::{Depth, Quantity, UnitSystem, six_digits};

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

/// The units of an input and of its output: one of length and one of stress. Time is in s, temperature in K, angles
/// are in rad, and all other units follow from these, such as the unit of force, stress · length².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, schemars::JsonSchema)]
#[serde(deny_unknown_fields, rename = "units")]
pub struct Units {
    /// Unit of length.
    /// Example: `length = "mm"`.
    pub length: LengthUnit,
    /// Unit of stress.
    /// Example: `stress = "MPa"`.
    pub stress: StressUnit,
}

/// Declares the units of a quantity: the name of each in a scene, and the digits and the power of ten of its SI size.
macro_rules! units {
    ($(#[$of:meta])* $unit:ident { $($(#[$meta:meta])* $variant:ident = $name:literal $digits:tt e $power:literal,)* }) => {
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, schemars::JsonSchema)]
        $(#[$of])*
        pub enum $unit {
            $($(#[$meta])* #[serde(rename = $name)] $variant,)*
        }

        impl $unit {
            /// Returns the name in a scene.
            pub fn name(self) -> &'static str {
                match self { $($unit::$variant => $name,)* }
            }

            fn size(self) -> Size {
                match self { $($unit::$variant => Size { digits: $digits, power: $power },)* }
            }
        }
    };
}

units! {
    /// A unit of length.
    #[schemars(extend("enum" = ["µm", "μm"]))]
    LengthUnit {
        /// Metre.
        #[default]
        Metre = "m" 1.0 e 0,
        /// Millimetre.
        Millimetre = "mm" 1.0 e -3,
        /// Centimetre.
        Centimetre = "cm" 1.0 e -2,
        /// Micrometre.
        #[serde(alias = "µm", alias = "μm")]
        Micrometre = "um" 1.0 e -6,
        /// Kilometre.
        Kilometre = "km" 1.0 e 3,
        /// Inch.
        Inch = "in" 254.0 e -4,
        /// Foot.
        Foot = "ft" 3048.0 e -4,
    }
}

units! {
    /// A unit of stress.
    StressUnit {
        /// Pascal.
        #[default]
        Pascal = "Pa" 1.0 e 0,
        /// Kilopascal.
        Kilopascal = "kPa" 1.0 e 3,
        /// Megapascal.
        Megapascal = "MPa" 1.0 e 6,
        /// Gigapascal.
        Gigapascal = "GPa" 1.0 e 9,
        /// Bar.
        Bar = "bar" 1.0 e 5,
        /// Pound-force per square inch.
        Psi = "psi" PSI e 0,
        /// A thousand psi.
        Ksi = "ksi" PSI e 3,
    }
}

/// A size in SI units: `digits · 10^power`. A power of ten is converted with one rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Size {
    pub digits: f64,
    pub power: i32,
}

impl Units {
    /// Metres and pascals.
    pub const SI: Units = Units { length: LengthUnit::Metre, stress: StressUnit::Pascal };

    /// Creates units of length and stress.
    pub fn new(length: LengthUnit, stress: StressUnit) -> Self {
        Units { length, stress }
    }
}

/// A pound-force, 0.45359237 kg · 9.80665 m/s², per square inch, Pa.
const PSI: f64 = 4.448_221_615_260_5 / (0.0254 * 0.0254);

impl Size {
    /// Returns `self^a · other^b`.
    fn product(self, a: i32, other: Size, b: i32) -> Size {
        Size { digits: self.digits.powi(a) * other.digits.powi(b), power: a * self.power + b * other.power }
    }

    /// Converts `x` of this unit to SI.
    fn to_si(self, x: f64) -> f64 {
        let x = x * self.digits;
        if self.power < 0 { x / ten(-self.power) } else { x * ten(self.power) }
    }

    /// Converts `x` from SI to this unit.
    fn of_si(self, x: f64) -> f64 {
        let x = if self.power < 0 { x * ten(-self.power) } else { x / ten(self.power) };
        x / self.digits
    }
}

/// Returns `10^n`, exact up to n = 22.
fn ten(n: i32) -> f64 {
    10.0_f64.powi(n)
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
