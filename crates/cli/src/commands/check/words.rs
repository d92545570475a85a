//! Formats numbers and names for `check`.

use stickslip::base::{Quantity, UnitSystem};

/// Joins names to `a`, `a and b` or `a, b and c`.
pub(super) fn listed(mut names: Vec<String>) -> String {
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) }
}

/// Formats a number in few digits, zero as 0.
pub(super) fn number(x: f64) -> String {
    if x == 0.0 { "0".to_string() } else { format!("{:e}", (format!("{x:.5e}")).parse().unwrap_or(x)) }
}

/// Formats a number of SI units in few digits, in the chosen units.
pub(super) fn told(units: &UnitSystem, quantity: Quantity, x: f64) -> String {
    format!("{} {}", number(units.of_si(quantity, x)), units.name(quantity))
}

/// Formats components in few digits, in the chosen units.
pub(super) fn vector(units: &UnitSystem, quantity: Quantity, x: &[f64]) -> String {
    let told: Vec<f64> = x.iter().map(|x| units.of_si(quantity, *x)).collect();
    format!("({}) {}", numbers(&told), units.name(quantity))
}

/// Formats numbers in few digits, separated by commas.
fn numbers(x: &[f64]) -> String {
    x.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ")
}
