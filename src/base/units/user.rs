//! The base units of an input.

use serde::Deserialize;

/// The units of an input and of its output: one of length and one of stress. Time is in s, temperature in K, angles
/// are in rad, and all other units follow from these, such as the unit of force, stress · length².
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Units {
    /// The unit of length.
    pub length: LengthUnit,
    /// The unit of stress.
    pub stress: StressUnit,
}

/// A unit of length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum LengthUnit {
    /// Metre.
    #[default]
    #[serde(rename = "m")]
    Metre,
    /// Millimetre.
    #[serde(rename = "mm")]
    Millimetre,
    /// Centimetre.
    #[serde(rename = "cm")]
    Centimetre,
    /// Micrometre.
    #[serde(rename = "um", alias = "µm", alias = "μm")]
    Micrometre,
    /// Kilometre.
    #[serde(rename = "km")]
    Kilometre,
    /// Inch.
    #[serde(rename = "in")]
    Inch,
    /// Foot.
    #[serde(rename = "ft")]
    Foot,
}

/// A unit of stress.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
pub enum StressUnit {
    /// Pascal.
    #[default]
    #[serde(rename = "Pa")]
    Pascal,
    /// Kilopascal.
    #[serde(rename = "kPa")]
    Kilopascal,
    /// Megapascal, N/mm².
    #[serde(rename = "MPa")]
    Megapascal,
    /// Gigapascal.
    #[serde(rename = "GPa")]
    Gigapascal,
    /// Bar.
    #[serde(rename = "bar")]
    Bar,
    /// Pound-force per square inch.
    #[serde(rename = "psi")]
    Psi,
    /// A thousand psi.
    #[serde(rename = "ksi")]
    Ksi,
}

/// A size in SI units: `digits · 10^power`. A power of ten is converted with one rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Size {
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

impl LengthUnit {
    /// Returns the name in a scene.
    pub fn name(self) -> &'static str {
        self.named().0
    }

    pub(super) fn size(self) -> Size {
        let (_, digits, power) = self.named();
        Size { digits, power }
    }

    /// Returns the name, and the digits and the power of ten of the size, m.
    fn named(self) -> (&'static str, f64, i32) {
        match self {
            LengthUnit::Metre => ("m", 1.0, 0),
            LengthUnit::Millimetre => ("mm", 1.0, -3),
            LengthUnit::Centimetre => ("cm", 1.0, -2),
            LengthUnit::Micrometre => ("um", 1.0, -6),
            LengthUnit::Kilometre => ("km", 1.0, 3),
            LengthUnit::Inch => ("in", 254.0, -4),
            LengthUnit::Foot => ("ft", 3048.0, -4),
        }
    }
}

impl StressUnit {
    /// Returns the name in a scene.
    pub fn name(self) -> &'static str {
        self.named().0
    }

    pub(super) fn size(self) -> Size {
        let (_, digits, power) = self.named();
        Size { digits, power }
    }

    /// Returns the name, and the digits and the power of ten of the size, Pa.
    fn named(self) -> (&'static str, f64, i32) {
        match self {
            StressUnit::Pascal => ("Pa", 1.0, 0),
            StressUnit::Kilopascal => ("kPa", 1.0, 3),
            StressUnit::Megapascal => ("MPa", 1.0, 6),
            StressUnit::Gigapascal => ("GPa", 1.0, 9),
            StressUnit::Bar => ("bar", 1.0, 5),
            StressUnit::Psi => ("psi", PSI, 0),
            StressUnit::Ksi => ("ksi", PSI, 3),
        }
    }
}

/// A pound-force, 0.45359237 kg · 9.80665 m/s², per square inch, Pa.
const PSI: f64 = 4.448_221_615_260_5 / (0.0254 * 0.0254);

impl Size {
    /// Returns `self^a · other^b`.
    pub(super) fn product(self, a: i32, other: Size, b: i32) -> Size {
        Size { digits: self.digits.powi(a) * other.digits.powi(b), power: a * self.power + b * other.power }
    }

    /// Converts `x` of this unit to SI.
    pub(super) fn times(self, x: f64) -> f64 {
        let x = x * self.digits;
        if self.power < 0 { x / ten(-self.power) } else { x * ten(self.power) }
    }

    /// Converts `x` from SI to this unit.
    pub(super) fn parts(self, x: f64) -> f64 {
        let x = if self.power < 0 { x * ten(-self.power) } else { x / ten(self.power) };
        x / self.digits
    }
}

/// Returns `10^n`, exact up to n = 22.
fn ten(n: i32) -> f64 {
    10.0_f64.powi(n)
}
