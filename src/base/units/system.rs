//! The derived units of each kind of quantity, and numbers for people: few digits and, in SI, a prefix.

use super::{Size, StressUnit, Units};

/// A kind of physical quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A quantity without a unit, or with the same unit in every system: counts, ratios, times (s), temperatures (K),
    /// angles (rad).
    Number,
    /// A length, m.
    Length,
    /// A stress, Pa.
    Stress,
    /// A force, N. In two dimensions it is per depth, N per m, except for bodies of revolution and bodies of given
    /// thickness; so are the following quantities.
    Force,
    /// An area, m²; in two dimensions per depth.
    Area,
    /// A moment, N m.
    Moment,
    /// An energy, J.
    Energy,
    /// An energy per area, J/m², also in two dimensions.
    EnergyPerArea,
    /// A stress times an energy per area, Pa J/m², also in two dimensions.
    StressEnergyPerArea,
    /// A mass density, kg/m³.
    Density,
    /// An acceleration, m/s².
    Acceleration,
    /// The stiffness of a foundation, N/m³, also in two dimensions.
    Foundation,
    /// The stiffness of a spring at a point, N/m.
    Spring,
}

/// The units of each quantity of a two- or three-dimensional body. A result with such a system is reported in these
/// units, but the numbers in its fields are SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnitSystem {
    /// The base units.
    pub units: Units,
    /// The dimension of the body, 2 or 3.
    pub dimension: usize,
    /// The number of components of its displacements and forces: the dimension, and 3 with torsion.
    pub components: usize,
    /// The relation of forces, and of quantities derived from them, to the SI numbers.
    pub depth: Depth,
}

/// The depth of a body to which its forces belong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Depth {
    /// The whole body: in three dimensions, and for bodies of revolution.
    Whole,
    /// A plane body, forces per unit of depth.
    Unit,
    /// A plane body of this thickness (m): forces are those of the whole body, while the SI numbers are per m of depth.
    Thickness(f64),
}

/// The units of force that have a name of their own, N.
const FORCES: [(f64, &str); 9] = [
    (1e-9, "nN"),
    (1e-6, "uN"),
    (1e-3, "mN"),
    (1.0, "N"),
    (1e3, "kN"),
    (1e6, "MN"),
    (1e9, "GN"),
    (4.448_221_615_260_5, "lbf"),
    (4_448.221_615_260_5, "kip"),
];

/// The units of energy that have a name of their own, J.
const ENERGIES: [(f64, &str); 8] =
    [(1e-12, "pJ"), (1e-9, "nJ"), (1e-6, "uJ"), (1e-3, "mJ"), (1.0, "J"), (1e3, "kJ"), (1e6, "MJ"), (1e9, "GJ")];

/// The units of mass that have a name of their own, kg.
const MASSES: [(f64, &str); 4] = [(1e-6, "mg"), (1e-3, "g"), (1.0, "kg"), (1e3, "t")];

/// Returns the name of the unit of this size.
fn named(size: Size, names: &[(f64, &'static str)]) -> Option<&'static str> {
    let size = size.to_si(1.0);
    // Products are compared up to rounding.
    names.iter().find(|(known, _)| (size - known).abs() <= 1e-12 * known).map(|(_, name)| *name)
}

impl UnitSystem {
    /// Returns SI units for a body of this dimension that is not axisymmetric.
    pub fn si(dimension: usize) -> Self {
        Self::new(Units::SI, dimension)
    }

    /// Returns a system of these units for a body of this dimension that is not axisymmetric.
    pub fn new(units: Units, dimension: usize) -> Self {
        UnitSystem {
            units,
            dimension,
            components: dimension,
            depth: if dimension == 2 { Depth::Unit } else { Depth::Whole },
        }
    }

    /// Returns `true` if all numbers are the SI numbers.
    pub fn is_si(&self) -> bool {
        self.has_si_units() && !matches!(self.depth, Depth::Thickness(_))
    }

    /// Returns `true` if all units are SI units.
    pub fn has_si_units(&self) -> bool {
        self.units == Units::SI
    }

    /// Returns the units for plots: MPa instead of Pa, otherwise unchanged.
    #[must_use]
    pub fn of_pictures(self) -> Self {
        let units =
            if self.has_si_units() { Units { stress: StressUnit::Megapascal, ..self.units } } else { self.units };
        UnitSystem { units, ..self }
    }

    /// Converts `x` from these units to SI.
    pub fn to_si(&self, quantity: Quantity, x: f64) -> f64 {
        self.size(quantity).to_si(x / self.thickness(quantity))
    }

    /// Converts `x` from SI to these units.
    pub fn of_si(&self, quantity: Quantity, x: f64) -> f64 {
        self.size(quantity).of_si(x * self.thickness(quantity))
    }

    /// Returns the thickness (m) if the body has one and SI numbers of `quantity` are per m of depth, otherwise 1.
    fn thickness(&self, quantity: Quantity) -> f64 {
        match (self.depth, quantity) {
            (
                Depth::Thickness(thickness),
                Quantity::Force | Quantity::Area | Quantity::Moment | Quantity::Energy | Quantity::Spring,
            ) => thickness,
            _ => 1.0,
        }
    }

    /// Formats an SI number with the name of its unit, such as `0.2 mm`.
    pub fn text(&self, quantity: Quantity, x: f64) -> String {
        format!("{} {}", self.number(quantity, x), self.name(quantity))
    }

    /// Converts an SI number for a text: fifteen digits hide the rounding of the conversion.
    pub fn number(&self, quantity: Quantity, x: f64) -> f64 {
        if self.is_si() {
            return x;
        }
        let value = self.of_si(quantity, x);
        format!("{value:.14e}").parse().unwrap_or(value)
    }

    /// Returns the coordinates of a point (m) in these units. Rounding beside the largest one is 0.
    pub(crate) fn coordinates(&self, x: &[f64]) -> Vec<f64> {
        let largest = x.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        x.iter().map(|c| if c.abs() <= 1e-13 * largest { 0.0 } else { self.number(Quantity::Length, *c) }).collect()
    }

    /// Formats a point (m): `(1, 0.5) mm`.
    pub fn point(&self, x: [f64; 3]) -> String {
        let numbers: Vec<String> = self.coordinates(&x[..self.dimension]).iter().map(f64::to_string).collect();
        format!("({}) {}", numbers.join(", "), self.name(Quantity::Length))
    }

    /// Returns the name of the unit, such as `N mm`; powers are plain digits, as in `N/mm2`.
    pub fn name(&self, quantity: Quantity) -> String {
        let (length, stress) = (self.units.length.name(), self.units.stress.name());
        let per_depth = self.depth == Depth::Unit;
        let [area, volume, mass] = [2, 3, 1].map(|b| self.product(1, b));
        let own = named(area, &FORCES);
        let force = own.map_or_else(|| format!("{stress} {length}2"), String::from);
        let depth = if per_depth { format!("/{length}") } else { String::new() };
        match quantity {
            Quantity::Number => String::new(),
            Quantity::Length => length.to_string(),
            Quantity::Stress => stress.to_string(),
            Quantity::Force => format!("{force}{depth}"),
            Quantity::Area if per_depth => length.to_string(),
            Quantity::Area => format!("{length}2"),
            Quantity::EnergyPerArea => match named(volume, &ENERGIES) {
                Some(energy) => format!("{energy}/{length}2"),
                None => format!("{stress} {length}"),
            },
            Quantity::Moment => format!("{force} {length}{depth}"),
            Quantity::Energy => match named(volume, &ENERGIES) {
                Some(energy) => format!("{energy}{depth}"),
                None => format!("{force} {length}{depth}"),
            },
            Quantity::StressEnergyPerArea => format!("{stress} {}", self.name(Quantity::EnergyPerArea)),
            Quantity::Density => match named(mass, &MASSES) {
                Some(mass) => format!("{mass}/{length}3"),
                None => format!("{stress} s2/{length}2"),
            },
            Quantity::Acceleration => format!("{length}/s2"),
            Quantity::Foundation => format!("{stress}/{length}"),
            Quantity::Spring if per_depth => stress.to_string(),
            Quantity::Spring => own.map_or_else(|| format!("{stress} {length}"), |force| format!("{force}/{length}")),
        }
    }

    fn size(&self, quantity: Quantity) -> Size {
        // Quantities per depth have one length less.
        let plane = i32::from(self.depth == Depth::Unit);
        let (stress, length) = match quantity {
            Quantity::Number => (0, 0),
            Quantity::Length | Quantity::Acceleration => (0, 1),
            Quantity::Stress => (1, 0),
            Quantity::Force => (1, 2 - plane),
            Quantity::Area => (0, 2 - plane),
            Quantity::EnergyPerArea => (1, 1),
            Quantity::StressEnergyPerArea => (2, 1),
            Quantity::Moment | Quantity::Energy => (1, 3 - plane),
            Quantity::Density => (1, -2),
            Quantity::Foundation => (1, -1),
            Quantity::Spring => (1, 1 - plane),
        };
        self.product(stress, length)
    }

    /// Returns `stress^a · length^b`.
    fn product(&self, a: i32, b: i32) -> Size {
        self.units.stress.size().product(a, self.units.length.size(), b)
    }

    /// Formats an SI number with this number of digits and the name of its unit: `61.9 MPa`. In SI the unit gets a prefix.
    pub fn rounded(&self, quantity: Quantity, x: f64, digits: usize) -> String {
        let (unit, name) = self.unit_for(quantity, x, digits);
        let x = self.of_si(quantity, x) / unit;
        format!("{} {name}", fixed(x, decimals(x, digits))).trim_end().to_string()
    }

    /// Formats the components of a vector, in SI, with the digits that the largest one has if it has this number of them:
    /// `(-15.50, 0, 0.29) kN`.
    pub fn rounded_vector(&self, quantity: Quantity, x: &[f64], digits: usize) -> String {
        let largest = x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let (unit, name) = self.unit_for(quantity, largest, digits);
        let decimals = decimals(self.of_si(quantity, largest) / unit, digits);
        let components = x.iter().map(|x| fixed(self.of_si(quantity, *x) / unit, decimals));
        format!("({}) {name}", components.collect::<Vec<_>>().join(", "))
    }

    /// Returns the unit in which `x` is at least 1, in units of this system, with its name.
    fn unit_for(&self, quantity: Quantity, x: f64, digits: usize) -> (f64, String) {
        let name = self.name(quantity);
        let largest = match quantity {
            Quantity::Length => 1.0,
            Quantity::Stress | Quantity::Force | Quantity::Moment | Quantity::Energy => f64::INFINITY,
            _ => 0.0,
        };
        if !self.has_si_units() || x == 0.0 || !x.is_finite() {
            return (1.0, name);
        }
        // 999.96 of a unit are 1.000 of the next.
        let x = round(self.of_si(quantity, x).abs(), digits);
        let prefixes = PREFIXES.iter().filter(|(size, _)| *size <= largest);
        let smallest = prefixes.clone().next_back();
        match prefixes.clone().find(|(size, _)| x >= *size).or(smallest) {
            Some((size, prefix)) => (*size, format!("{prefix}{name}")),
            None => (1.0, name),
        }
    }
}

/// The prefixes of SI units, descending.
const PREFIXES: [(f64, &str); 7] =
    [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];

/// Smaller numbers are written with an exponent.
const SMALL: f64 = 1e-4;

/// Numbers from here on are written with an exponent.
const LARGE: f64 = 1e6;

/// Rounds a time or a place to the six digits that people are told.
pub fn six_digits(x: f64) -> f64 {
    round(x, 6)
}

/// Rounds a number to so many digits.
fn round(x: f64, digits: usize) -> f64 {
    format!("{x:.*e}", digits.saturating_sub(1)).parse().unwrap_or(x)
}

/// Returns the number of decimals with which `x` has so many digits, none if it is written with an exponent.
fn decimals(x: f64, digits: usize) -> Decimals {
    let x = round(x.abs(), digits);
    if x != 0.0 && !(SMALL..LARGE).contains(&x) {
        return Decimals::Exponent(digits.saturating_sub(1));
    }
    let before = if x == 0.0 { 1 } else { x.log10().floor() as i64 + 1 };
    Decimals::Fixed(usize::try_from(digits as i64 - before).unwrap_or(0))
}

/// The form of a number.
#[derive(Debug, Clone, Copy)]
enum Decimals {
    Fixed(usize),
    Exponent(usize),
}

/// Formats a number; if it is zero in this form, as 0.
fn fixed(x: f64, decimals: Decimals) -> String {
    let text = match decimals {
        Decimals::Fixed(decimals) => format!("{x:.decimals$}"),
        Decimals::Exponent(decimals) => format!("{x:.decimals$e}"),
    };
    if text.parse() == Ok(0.0) { "0".to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::super::{LengthUnit, StressUnit, Units};
    use super::*;

    fn system(length: LengthUnit, stress: StressUnit, dimension: usize) -> UnitSystem {
        UnitSystem::new(Units::new(length, stress), dimension)
    }

    #[test]
    fn units_follow_from_length_and_stress() {
        use Quantity::{Acceleration, Density, Energy, Force, Foundation, Length, Moment, Spring};
        let cases = [
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Force, "N", 1.0),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Moment, "N mm", 1e-3),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Energy, "mJ", 1e-3),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Density, "t/mm3", 1e12),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Acceleration, "mm/s2", 1e-3),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Foundation, "MPa/mm", 1e9),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 3), Spring, "N/mm", 1e3),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 2), Force, "N/mm", 1e3),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 2), Moment, "N mm/mm", 1.0),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 2), Energy, "mJ/mm", 1.0),
            (system(LengthUnit::Millimetre, StressUnit::Megapascal, 2), Spring, "MPa", 1e6),
            (system(LengthUnit::Metre, StressUnit::Kilopascal, 3), Force, "kN", 1e3),
            (system(LengthUnit::Millimetre, StressUnit::Gigapascal, 3), Force, "kN", 1e3),
            (system(LengthUnit::Micrometre, StressUnit::Megapascal, 3), Force, "uN", 1e-6),
            (system(LengthUnit::Centimetre, StressUnit::Bar, 3), Force, "bar cm2", 10.0),
            (system(LengthUnit::Inch, StressUnit::Psi, 3), Force, "lbf", 4.448_221_615_260_5),
            (system(LengthUnit::Inch, StressUnit::Ksi, 3), Energy, "kip in", 4_448.221_615_260_5 * 0.0254),
            (system(LengthUnit::Foot, StressUnit::Psi, 3), Length, "ft", 0.3048),
            (system(LengthUnit::Foot, StressUnit::Psi, 3), Force, "psi ft2", 144.0 * 4.448_221_615_260_5),
            (system(LengthUnit::Kilometre, StressUnit::Pascal, 3), Force, "MN", 1e6),
            (UnitSystem::si(3), Force, "N", 1.0),
            (UnitSystem::si(2), Force, "N/m", 1.0),
            (UnitSystem::si(2), Moment, "N m/m", 1.0),
            (UnitSystem::si(2), Energy, "J/m", 1.0),
        ];
        for (system, quantity, name, si) in cases {
            assert_eq!(system.name(quantity), name, "{system:?}");
            let found = system.to_si(quantity, 1.0);
            assert!((found - si).abs() <= 4e-16 * si, "{system:?} {quantity:?}: {found}");
            assert!((system.of_si(quantity, found) - 1.0).abs() <= 4e-16);
        }
    }

    #[test]
    fn powers_of_ten_are_rounded_once() {
        let system = system(LengthUnit::Millimetre, StressUnit::Megapascal, 3);
        for (mm, m) in [(0.3, 3e-4), (25.0, 0.025), (0.01, 1e-5), (1e-5, 1e-8)] {
            assert_eq!((system.to_si(Quantity::Length, mm), system.of_si(Quantity::Length, m)), (m, mm));
        }
        assert_eq!(system.to_si(Quantity::Stress, 210e3), 210e9);
        assert_eq!(system.text(Quantity::Length, 0.1 + 0.2), "300 mm");
        assert_eq!(UnitSystem::si(2).text(Quantity::Length, 0.1 + 0.2), "0.30000000000000004 m");
        assert_eq!(UnitSystem::si(2).point([1.0, 0.5, 0.0]), "(1, 0.5) m");
        assert_eq!(system.point([-1.225e-18, 20e-3, 0.0]), "(0, 20, 0) mm");
    }

    #[test]
    fn si_numbers_have_prefixes() {
        let si = UnitSystem::si(3);
        let cases = [
            (Quantity::Stress, 7.122e7, "71.2 MPa"),
            (Quantity::Stress, -2.1e11, "-210 GPa"),
            (Quantity::Stress, 999.96, "1.00 kPa"),
            (Quantity::Stress, 3e12, "3000 GPa"),
            (Quantity::Length, 9.4562e-5, "94.6 µm"),
            (Quantity::Length, 1234.5, "1234 m"),
            (Quantity::Length, 3e-14, "3.00e-5 nm"),
            (Quantity::Force, 15_500.0, "15.5 kN"),
            (Quantity::Moment, 0.25, "250 mN m"),
            (Quantity::Energy, 1.069e-3, "1.07 mJ"),
            (Quantity::Spring, 1e9, "1.00e9 N/m"),
            (Quantity::Number, 0.5, "0.500"),
            (Quantity::Stress, 0.0, "0 Pa"),
        ];
        for (quantity, x, text) in cases {
            assert_eq!(si.rounded(quantity, x, 3), text);
        }
        assert!(si.rounded(Quantity::Stress, f64::NAN, 3).starts_with("NaN"));
    }

    #[test]
    fn chosen_units_stay() {
        let system = UnitSystem::new(Units::new(LengthUnit::Millimetre, StressUnit::Megapascal), 3);
        assert_eq!(system.rounded(Quantity::Stress, 7.122e7, 3), "71.2 MPa");
        assert_eq!(system.rounded(Quantity::Force, 15_500.0, 3), "15500 N");
        assert_eq!(system.rounded(Quantity::Length, 9.4562e-8, 3), "9.46e-5 mm");
        assert_eq!(system.rounded(Quantity::Length, 9.4562e-5, 3), "0.0946 mm");
    }

    #[test]
    fn components_have_the_digits_of_the_largest() {
        let si = UnitSystem::si(3);
        assert_eq!(si.rounded_vector(Quantity::Force, &[-15_500.0, 1.9e-11, 294.25], 4), "(-15.50, 0, 0.29) kN");
        assert_eq!(si.rounded_vector(Quantity::Force, &[0.0, -0.0], 4), "(0, 0) N");
    }
}
