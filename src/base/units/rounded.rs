//! Numbers for people: few digits and, in SI, a prefix.

use super::system::{Quantity, UnitSystem};

/// The prefixes of SI units, descending.
const PREFIXES: [(f64, &str); 7] =
    [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")];

/// Smaller numbers are written with an exponent.
const SMALL: f64 = 1e-4;

/// Numbers from here on are written with an exponent.
const LARGE: f64 = 1e6;

impl UnitSystem {
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
