//! Numbers that may vary with the position.

use std::fmt;

use super::Formula;
use crate::base::input_error::{InputError, finite};

/// A number, or a formula of the position.
#[derive(Debug, Clone, PartialEq)]
pub enum Field {
    /// A uniform value.
    Uniform(f64),
    /// A formula of x, y and z (m).
    Formula(Formula),
}

impl Field {
    /// Returns the value at `x` (m); NaN where a formula is undefined.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Field::Uniform(value) => *value,
            Field::Formula(formula) => formula.at(x),
        }
    }

    /// Returns the value if it is uniform.
    pub fn uniform(&self) -> Option<f64> {
        match self {
            Field::Uniform(value) => Some(*value),
            Field::Formula(_) => None,
        }
    }

    /// Checks the value of `key`.
    pub(crate) fn check(&self, key: &str) -> Result<(), InputError> {
        self.uniform().map_or(Ok(()), |value| finite(key, value))
    }
}

impl From<f64> for Field {
    fn from(value: f64) -> Self {
        Field::Uniform(value)
    }
}

impl From<Formula> for Field {
    fn from(formula: Formula) -> Self {
        Field::Formula(formula)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Field::Uniform(value) => write!(f, "{value:?}"),
            Field::Formula(formula) => f.write_str(formula.text()),
        }
    }
}
