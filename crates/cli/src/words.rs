//! Formats numbers, names and loads for `check` and `capacity`.

use stickslip::base::{Field, Quantity, UnitSystem};
use stickslip::body::Action;

/// Joins names to `a`, `a and b` or `a, b and c`.
pub(crate) fn listed(mut names: Vec<String>) -> String {
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) }
}

/// The digits of numbers of the scene.
const DIGITS: usize = 6;

/// Formats a number in few digits, without zeros at the end.
pub(crate) fn number(x: f64) -> String {
    shortened(&UnitSystem::si(3).rounded(Quantity::Number, x, DIGITS))
}

/// Removes the zeros at the end of the decimals of a number, which an exponent or a unit may follow.
fn shortened(text: &str) -> String {
    let end = text.find(['e', ' ']).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    let number = if number.contains('.') { number.trim_end_matches('0').trim_end_matches('.') } else { number };
    format!("{number}{rest}")
}

/// Formats a number of SI units in few digits, in the chosen units.
pub(crate) fn rounded(units: &UnitSystem, quantity: Quantity, x: f64) -> String {
    shortened(&units.rounded(quantity, x, DIGITS))
}

/// Formats components in few digits, in the chosen units.
pub(crate) fn vector(units: &UnitSystem, quantity: Quantity, x: &[f64]) -> String {
    let values: Vec<f64> = x.iter().map(|x| units.of_si(quantity, *x)).collect();
    let (numbers, unit) = (numbers(&values), units.name(quantity));
    if let [_] = x { format!("{numbers} {unit}") } else { format!("({numbers}) {unit}") }
}

/// Describes a load at a `factor`.
pub(crate) fn acts(action: &Action, factor: f64, units: &UnitSystem) -> String {
    // Without named units, a traction is printed in N/m2.
    let per_area = if units.has_si_units() { "N/m2".to_string() } else { units.name(Quantity::Stress) };
    let of = |field: &Field, quantity| match field {
        Field::Uniform(value) => number(units.number(quantity, factor * value)),
        Field::Formula(_) if factor == 1.0 => field.to_string(),
        Field::Formula(_) => format!("{} * ({field})", number(factor)),
    };
    let list = |quantity, x: &[f64]| vector(units, quantity, &x.iter().map(|x| factor * x).collect::<Vec<_>>());
    match action {
        Action::Traction { traction, .. } => {
            let components = traction.iter().map(|component| of(component, Quantity::Stress));
            format!("({}) {per_area}", components.collect::<Vec<_>>().join(", "))
        }
        Action::Pressure { pressure, .. } => format!("pressure {} {per_area}", of(pressure, Quantity::Stress)),
        Action::Force { force, .. } => list(Quantity::Force, force),
        Action::Moment { moment, .. } => list(Quantity::Moment, moment),
        Action::Acceleration(acceleration) => list(Quantity::Acceleration, acceleration),
        // The factor multiplies the square of the speed.
        Action::Spin { speed, .. } => format!("turning with {} rad/s", number(speed * factor.sqrt())),
        Action::Temperature(temperature) => format!("warmed by {} K", of(temperature, Quantity::Number)),
    }
}

/// Formats numbers in few digits, separated by commas. Rounding beside the largest is 0.
fn numbers(x: &[f64]) -> String {
    let largest = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let format = |x: &f64| number(if x.abs() <= 1e-13 * largest { 0.0 } else { *x });
    x.iter().map(format).collect::<Vec<_>>().join(", ")
}
