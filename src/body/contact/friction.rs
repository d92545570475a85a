//! Coulomb's friction coefficient as input.

use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite};

/// Coulomb's friction coefficient `μ ≥ 0` on a boundary.
#[derive(Debug, Clone, PartialEq)]
pub enum Friction {
    /// A uniform coefficient.
    Uniform(f64),
    /// A formula of the position of the node in the undeformed body.
    Formula(Formula),
}

impl From<f64> for Friction {
    fn from(coefficient: f64) -> Self {
        Friction::Uniform(coefficient)
    }
}

impl From<Formula> for Friction {
    fn from(formula: Formula) -> Self {
        Friction::Formula(formula)
    }
}

impl Friction {
    /// Checks the value as far as possible without the positions of nodes.
    ///
    /// # Errors
    /// [`InputError`] with the key `friction`.
    pub fn check(&self) -> Result<(), InputError> {
        match *self {
            Friction::Uniform(coefficient) => {
                finite("friction", coefficient)?;
                let help = "give Coulomb's coefficient, 0 for a frictionless contact";
                ensure(coefficient >= 0.0, "friction", &coefficient, "0 or more", help)
            }
            Friction::Formula(_) => Ok(()),
        }
    }

    /// Returns the coefficient at `x` (m).
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Friction::Uniform(coefficient) => *coefficient,
            Friction::Formula(formula) => formula.at(x),
        }
    }
}
