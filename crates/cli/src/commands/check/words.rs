//! Formats numbers and names for `check`.

use stickslip::base::{Quantity, UnitSystem};

/// Joins names to `a`, `a and b` or `a, b and c`.
pub(super) fn listed(mut names: Vec<String>) -> String {
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) }
}

/// The digits of numbers of the scene.
const DIGITS: usize = 6;

/// Formats a number in few digits, without zeros at the end.
pub(super) fn number(x: f64) -> String {
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
pub(super) fn rounded(units: &UnitSystem, quantity: Quantity, x: f64) -> String {
    shortened(&units.rounded(quantity, x, DIGITS))
}

/// Formats components in few digits, in the chosen units.
pub(super) fn vector(units: &UnitSystem, quantity: Quantity, x: &[f64]) -> String {
    let values: Vec<f64> = x.iter().map(|x| units.of_si(quantity, *x)).collect();
    format!("({}) {}", numbers(&values), units.name(quantity))
}

/// Formats numbers in few digits, separated by commas. Rounding beside the largest is 0.
fn numbers(x: &[f64]) -> String {
    let largest = x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let format = |x: &f64| number(if x.abs() <= 1e-13 * largest { 0.0 } else { *x });
    x.iter().map(format).collect::<Vec<_>>().join(", ")
}
