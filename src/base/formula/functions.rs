//! The functions and constants of formulas.

use std::f64::consts::{E, PI, TAU};

/// A function, by its number of arguments.
#[derive(Debug, Clone, Copy)]
pub(super) enum Function {
    One(fn(f64) -> f64),
    Two(fn(f64, f64) -> f64),
    /// A function of two or more arguments, applied from the left.
    Several(fn(f64, f64) -> f64),
}

impl Function {
    /// Returns a description of the number of arguments.
    pub(super) fn arguments(self) -> &'static str {
        match self {
            Function::One(_) => "1 argument",
            Function::Two(_) => "2 arguments",
            Function::Several(_) => "2 arguments or more",
        }
    }
}

const CONSTANTS: &[(&str, f64)] = &[("PI", PI), ("π", PI), ("TAU", TAU), ("τ", TAU), ("E", E), ("e", E)];

const FUNCTIONS: &[(&str, Function)] = &[
    ("sqrt", Function::One(f64::sqrt)),
    ("cbrt", Function::One(f64::cbrt)),
    ("exp", Function::One(f64::exp)),
    ("ln", Function::One(f64::ln)),
    ("log", Function::One(f64::ln)),
    ("log2", Function::One(f64::log2)),
    ("log10", Function::One(f64::log10)),
    ("sin", Function::One(f64::sin)),
    ("cos", Function::One(f64::cos)),
    ("tan", Function::One(f64::tan)),
    ("asin", Function::One(f64::asin)),
    ("acos", Function::One(f64::acos)),
    ("atan", Function::One(f64::atan)),
    ("sinh", Function::One(f64::sinh)),
    ("cosh", Function::One(f64::cosh)),
    ("tanh", Function::One(f64::tanh)),
    ("abs", Function::One(f64::abs)),
    ("sign", Function::One(sign)),
    ("signum", Function::One(sign)),
    ("floor", Function::One(f64::floor)),
    ("ceil", Function::One(f64::ceil)),
    ("round", Function::One(f64::round)),
    ("trunc", Function::One(f64::trunc)),
    ("fract", Function::One(f64::fract)),
    ("atan2", Function::Two(f64::atan2)),
    ("hypot", Function::Two(f64::hypot)),
    ("min", Function::Several(min)),
    ("max", Function::Several(max)),
];

/// Returns the constant called `name`.
pub(super) fn constant(name: &str) -> Option<f64> {
    CONSTANTS.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

/// Returns the function called `name`.
pub(super) fn function(name: &str) -> Option<Function> {
    FUNCTIONS.iter().find(|(known, _)| *known == name).map(|(_, function)| *function)
}

/// Returns -1, 0 or 1; unlike [`f64::signum`] 0 at 0.
fn sign(a: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a.signum() }
}

/// Returns the smaller number; unlike [`f64::min`], NaN if either is NaN.
fn min(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

/// Returns the larger number; unlike [`f64::max`], NaN if either is NaN.
fn max(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_documented() {
        let page = include_str!("../../../doc/reference/scene/formulas.md");
        let names = FUNCTIONS.iter().map(|(name, _)| name).chain(CONSTANTS.iter().map(|(name, _)| name));
        for name in names {
            assert!(page.contains(&format!("`{name}`")), "`{name}` is not in doc/reference/scene/formulas.md");
        }
    }

    #[test]
    fn names_mean_what_they_say() {
        let of = |text: &str| crate::base::formula::Formula::parse(text).unwrap().at([0.25, -3.0, 4.0]);
        for (text, value) in [
            ("exp(x)", 0.25_f64.exp()),
            ("tan(x) - sin(x)/cos(x)", 0.0),
            ("asin(x) + acos(x)", PI / 2.0),
            ("atan(y) - atan2(y, 1)", 0.0),
            ("cosh(x)^2 - sinh(x)^2", 1.0),
            ("tanh(x)", 0.25_f64.tanh()),
            ("sign(y) + 10*sign(z) + 100*signum(0)", 9.0),
            ("floor(-x) + 10*ceil(x) + 100*round(2.5)", 309.0),
            ("trunc(y - x) + fract(z + x)", -2.75),
            ("hypot(y, z)", 5.0),
            ("cbrt(27) + log2(8) + log10(1000)", 9.0),
            ("ln(z) - log(z)", 0.0),
            ("min(z, x, y) + 10*max(x, z, y)", 37.0),
            ("TAU - 2*PI", 0.0),
        ] {
            assert!((of(text) - value).abs() < 1e-15 * value.abs().max(1.0), "{text}: {}", of(text));
        }
    }
}
