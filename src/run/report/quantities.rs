//! The quantities of all results by their names, and the conversion to the units of a body. Only this module gives
//! units to columns of tables, fields and keys of reports.

use serde::Serialize;
use serde_json::Value;

use super::csv;
use crate::base::units::{Depth, Quantity, UnitSystem};

use Quantity::{Area, Energy, EnergyPerArea, Force, Length, Moment, Number, Stress, StressEnergyPerArea};

/// The columns of all tables.
const COLUMNS: &Table = &[
    (Number, "index time status iterations backtracks theta backward_error parts attempts rescued"),
    (
        Number,
        "equilibrium penetration tension complementarity cone dissipation open stick slip slip_state friction_used",
    ),
    (Number, "seconds_assembly seconds_factorization seconds_solve seconds_rest"),
    (Energy, "friction_work strain_energy energy"),
    (Number, "boundary kind balance obstacle point node from to n_x n_y n_z t_x t_y t_z o_x o_y o_z"),
    (Force, "f_x f_y f_z sum_p_n sum_p_t sum_p_o p_n p_t p_o"),
    (Moment, "m_x m_y m_z"),
    (Number, "rotation_x rotation_y rotation_z"),
    (Length, "x y z w_n w_t w_o gap slip_t slip_o u_x u_y u_z slip_range slip_path slip_net wear_depth"),
    (Stress, "sigma_n sigma_t sigma_o sigma_patch sigma_along sigma_across sigma_shear"),
    (Stress, "s_xx s_yy s_zz s_xy s_yz s_zx von_mises"),
    (Stress, "sigma_n_mean sigma_n_range sigma_t_mean sigma_t_range sigma_o_mean sigma_o_range"),
    (Stress, "sigma_along_mean sigma_along_range"),
    (Area, "area"),
    (EnergyPerArea, "energy_density ruiz_1"),
    (StressEnergyPerArea, "ruiz_2"),
];

/// The fields of bodies.
const FIELDS: &Table = &[
    (Length, "displacement slip opening"),
    (Stress, "contact_pressure patch_pressure tangential_traction nodal_stress nodal_von_mises"),
    (Stress, "stress principal_stress von_mises"),
    (Number, "contact material body discretisation_error rank"),
];

/// The keys of a report whose values have a unit; doc/reference/results.md lists them all.
const KEYS: &Table = &[
    (Length, "position length linearised exact element_size half_width least_gap largest_gap overlap"),
    (Length, "slip_range slip_net displacement shortening"),
    (Force, "force normal_force magnitude friction_limit locked_force force_range sum_p_n sum_p_t sum_p_o"),
    (Moment, "moment"),
    (Energy, "friction_work friction_work_corrected strain_energy"),
    (Stress, "pressure mean_pressure peak_pressure patch_pressure"),
];

/// A list of quantities, each with the names that have it, as words.
type Table = [(Quantity, &'static str)];

fn find(table: &Table, name: &str) -> Option<Quantity> {
    let has_name = |names: &str| names.split(' ').any(|known| known == name);
    table.iter().find(|(_, names)| has_name(names)).map(|(quantity, _)| *quantity)
}

/// Columns of numbers in a table of results, in the units of a body.
#[derive(Debug, Clone)]
pub struct Columns {
    units: UnitSystem,
    quantities: Vec<Quantity>,
}

impl Columns {
    /// Creates the columns of these names.
    pub fn new<'a>(units: &UnitSystem, names: impl IntoIterator<Item = &'a str>) -> Self {
        let quantities = names.into_iter().map(|name| column(name).unwrap_or(Number)).collect();
        Columns { units: *units, quantities }
    }

    /// Formats the `numbers` (SI) of a row. A missing number leaves its column empty.
    pub fn cells<N: Into<Option<f64>>>(&self, numbers: impl IntoIterator<Item = N>) -> impl Iterator<Item = String> {
        let cell = |(quantity, x): (&Quantity, N)| match x.into() {
            Some(x) => csv::number(self.units.of_si(*quantity, x)),
            None => String::new(),
        };
        self.quantities.iter().zip(numbers).map(cell)
    }
}

/// Returns the quantity of the column of this name, if a table of results has such a column.
pub fn column(name: &str) -> Option<Quantity> {
    find(COLUMNS, name)
}

/// Returns the quantity of the numbers below a key of this name in a report.
pub fn key(name: &str) -> Quantity {
    find(KEYS, name).unwrap_or(Number)
}

/// Returns the quantity of the field of this name.
pub fn field(name: &str) -> Quantity {
    find(FIELDS, name).unwrap_or(Number)
}

/// The units of a report.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct UnitNames {
    /// The unit of lengths.
    pub length: NamedUnit,
    /// The unit of stresses.
    pub stress: NamedUnit,
    /// The unit of forces, in two dimensions per depth unless the body has a thickness.
    pub force: NamedUnit,
    /// The unit of moments, likewise.
    pub moment: NamedUnit,
    /// The unit of energies, likewise.
    pub energy: NamedUnit,
}

/// A unit.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct NamedUnit {
    /// The name, such as `mm`.
    pub name: String,
    /// The factor to the SI unit that the name stands for.
    pub si: f64,
}

impl UnitNames {
    /// Returns the names of `units`.
    pub fn of(units: &UnitSystem) -> Self {
        // The unit of a whole body, however thick it is.
        let depth = if units.depth == Depth::Unit { Depth::Unit } else { Depth::Whole };
        let of_name = UnitSystem { depth, ..*units };
        let named = |quantity| NamedUnit { name: units.name(quantity), si: of_name.to_si(quantity, 1.0) };
        UnitNames {
            length: named(Quantity::Length),
            stress: named(Quantity::Stress),
            force: named(Quantity::Force),
            moment: named(Quantity::Moment),
            energy: named(Quantity::Energy),
        }
    }
}

/// Turns the numbers of a report from SI into `units`.
pub fn in_units(report: &mut Value, units: &UnitSystem) {
    match report {
        Value::Object(entries) => {
            for (key, value) in entries {
                match find(KEYS, key) {
                    Some(quantity) => convert(value, quantity, units),
                    None => in_units(value, units),
                }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| in_units(value, units)),
        _ => {}
    }
}

/// Converts a number, or every number of a list.
fn convert(value: &mut Value, quantity: Quantity, units: &UnitSystem) {
    match value {
        Value::Array(values) => values.iter_mut().for_each(|value| convert(value, quantity, units)),
        Value::Number(number) => *value = number.as_f64().map_or(Value::Null, |x| units.of_si(quantity, x).into()),
        _ => {}
    }
}

/// Returns `true` if the quantity of a column, or of a field of cells or points, is known.
pub fn is_known(name: &str) -> bool {
    find(COLUMNS, name).or_else(|| find(FIELDS, name)).is_some()
}

#[cfg(test)]
mod tests {
    use super::super::{contact_line, cycle, probe};
    use super::*;

    #[test]
    fn columns_are_known_by_their_whole_names() {
        for (quantity, names) in COLUMNS {
            assert!(names.split(' ').all(|name| column(name) == Some(*quantity)));
        }
        assert_eq!(column("s_xx"), Some(Stress));
        assert!(["pressures", "s_x", "s_xxx", "s_xx s_yy", ""].iter().all(|name| column(name).is_none()));
    }

    /// A column that is not in its table would be told in SI units, whatever its neighbours are told in.
    #[test]
    fn every_column_has_its_quantity() {
        let headers = [probe::header(2), probe::header(3)];
        let nodes = contact_line::names().chain(cycle::names());
        let headers = headers.iter().flat_map(|header| header.trim_end().split(','));
        for name in headers.map(String::from).chain(nodes.map(String::from)) {
            assert!(column(&name).is_some(), "{name}");
        }
    }
}
