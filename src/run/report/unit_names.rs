//! The units in which a report is told, as it says them.

use serde::Serialize;

use crate::base::units::{Quantity, UnitSystem};

/// The units of a report.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct UnitNames {
    /// Of lengths.
    pub length: NamedUnit,
    /// Of stresses.
    pub stress: NamedUnit,
    /// Of forces, in two dimensions per depth.
    pub force: NamedUnit,
    /// Of moments, in two dimensions per depth.
    pub moment: NamedUnit,
    /// Of energies, in two dimensions per depth.
    pub energy: NamedUnit,
}

/// A unit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct NamedUnit {
    /// The name, such as `mm`.
    pub name: String,
    /// How many SI units it is.
    pub si: f64,
}

impl UnitNames {
    /// Those of `units`.
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
