//! Numbers and names as `check` prints them.

use stickslip::base::units::{Quantity, UnitSystem};

/// `a`, `a and b` or `a, b and c`.
pub(super) fn listed(mut names: Vec<String>) -> String {
    let last = names.pop().unwrap_or_default();
    if names.is_empty() { last } else { format!("{} and {last}", names.join(", ")) }
}

/// A number in few digits, 0 as 0.
pub(super) fn number(x: f64) -> String {
    if x == 0.0 { "0".to_string() } else { format!("{:e}", (format!("{x:.5e}")).parse().unwrap_or(x)) }
}

/// A number of SI units in few digits, with the unit it is told in.
pub(super) fn told(units: &UnitSystem, quantity: Quantity, x: f64) -> String {
    format!("{} {}", number(units.of_si(quantity, x)), units.name(quantity))
}

/// The same of components.
pub(super) fn vector(units: &UnitSystem, quantity: Quantity, x: &[f64]) -> String {
    let told: Vec<f64> = x.iter().map(|x| units.of_si(quantity, *x)).collect();
    format!("({}) {}", numbers(&told), units.name(quantity))
}

/// Numbers in few digits, with commas.
fn numbers(x: &[f64]) -> String {
    x.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ")
}
