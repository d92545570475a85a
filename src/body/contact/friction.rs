//! Coulomb's coefficient, as an input describes it.

use crate::base::formula::Formula;
use crate::base::input_error::{InputError, ensure, finite};

/// Coulomb's coefficient `μ ≥ 0` on a boundary.
#[derive(Debug, Clone, PartialEq)]
pub enum Friction {
    /// The same everywhere.
    Uniform(f64),
    /// By a formula of the position of the node before the deformation.
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
    /// Whether its value is possible, as far as that is known without the positions of nodes.
    ///
    /// # Errors
    /// [`InputError`] of `friction`.
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

    /// The coefficient at `x` (m).
    pub fn at(&self, x: [f64; 3]) -> f64 {
        match self {
            Friction::Uniform(coefficient) => *coefficient,
            Friction::Formula(formula) => formula.at(x),
        }
    }
}
