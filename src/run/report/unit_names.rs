//! The names of the units of a report.

use serde::Serialize;

use crate::base::units::{Quantity, UnitSystem};

/// The units of a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct UnitNames {
    /// The unit of lengths.
    pub length: NamedUnit,
    /// The unit of stresses.
    pub stress: NamedUnit,
    /// The unit of forces, in two dimensions per depth.
    pub force: NamedUnit,
    /// The unit of moments, in two dimensions per depth.
    pub moment: NamedUnit,
    /// The unit of energies, in two dimensions per depth.
    pub energy: NamedUnit,
}

/// A unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct NamedUnit {
    /// The name, such as `mm`.
    pub name: String,
    /// The factor to SI units.
    pub si: f64,
}

impl UnitNames {
    /// Returns the names of `units`.
    pub fn of(units: &UnitSystem) -> Self {
        let named = |quantity| NamedUnit { name: units.name(quantity), si: units.to_si(quantity, 1.0) };
        UnitNames {
            length: named(Quantity::Length),
            stress: named(Quantity::Stress),
            force: named(Quantity::Force),
            moment: named(Quantity::Moment),
            energy: named(Quantity::Energy),
        }
    }
}
