//! The quantities of all results by their names, and the conversion to the units of a body. Only this module gives
//! units to columns of tables, fields and keys of reports.

use serde_json::Value;

use super::csv;
use crate::base::units::{Quantity, UnitSystem};

use Quantity::{Energy, Force, Length, Moment, Number, Stress};

/// The columns of all tables.
const COLUMNS: &Table = &[
    (&["index", "time", "status", "iterations", "backtracks", "theta", "backward_error", "parts", "rescued"], Number),
    (&["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"], Number),
    (&["open", "stick", "slip"], Number),
    (&["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"], Number),
    (&["friction_work", "strain_energy", "energy"], Energy),
    (&["boundary", "kind", "balance", "obstacle", "point", "node"], Number),
    (&["n_x", "n_y", "n_z", "t_x", "t_y", "t_z", "o_x", "o_y", "o_z"], Number),
    (&["f_x", "f_y", "f_z", "sum_p_n", "sum_p_t", "sum_p_o", "p_n", "p_t", "p_o"], Force),
    (&["m_x", "m_y", "m_z"], Moment),
    (&["x", "y", "z", "w_n", "w_t", "w_o", "gap", "slip_t", "slip_o", "u_x", "u_y", "u_z"], Length),
    (&["sigma_n", "sigma_t", "sigma_o", "sigma_patch"], Stress),
    (&["s_xx", "s_yy", "s_zz", "s_xy", "s_yz", "s_zx", "von_mises"], Stress),
];

/// The fields of bodies.
const FIELDS: &Table = &[
    (&["displacement", "slip", "gap"], Length),
    (
        &[
            "contact_pressure",
            "patch_pressure",
            "tangential_traction",
            "nodal_stress",
            "stress",
            "principal_stress",
            "von_mises",
        ],
        Stress,
    ),
    (&["status", "material", "body", "discretisation_error", "rank"], Number),
];

/// The keys of a report whose values have a unit; doc/results.md lists them all.
const KEYS: &Table = &[
    (
        &[
            "position",
            "length",
            "linearised",
            "exact",
            "element_size",
            "half_width",
            "least_gap",
            "largest_gap",
            "overlap",
        ],
        Length,
    ),
    (&["force", "sum_p_n", "sum_p_t", "sum_p_o"], Force),
    (&["moment"], Moment),
    (&["friction_work", "friction_work_corrected", "strain_energy"], Energy),
    (&["pressure", "peak_pressure", "patch_pressure"], Stress),
];

/// A list of names with their quantity.
type Table = [(&'static [&'static str], Quantity)];

fn find<'a>(table: &'a Table, name: &'a str) -> Option<Quantity> {
    table.iter().find(|(names, _)| names.contains(&name)).map(|(_, quantity)| *quantity)
}

/// Returns the quantity of the column of this name in any table of results.
pub fn column(name: &str) -> Quantity {
    find(COLUMNS, name).unwrap_or(Number)
}

/// Returns the quantity of the numbers below a key of this name in a report.
pub fn key(name: &str) -> Quantity {
    find(KEYS, name).unwrap_or(Number)
}

/// Returns the quantity of the field of this name.
pub fn field(name: &str) -> Quantity {
    find(FIELDS, name).unwrap_or(Number)
}

/// Formats the number `x` (SI) for the column of this name.
pub fn cell(units: &UnitSystem, name: &str, x: f64) -> String {
    csv::number(units.of_si(column(name), x))
}

/// Converts the numbers of a report from SI to `units`.
pub fn tell(report: &mut Value, units: &UnitSystem) {
    match report {
        Value::Object(entries) => {
            for (key, value) in entries {
                match find(KEYS, key) {
                    Some(quantity) => convert(value, quantity, units),
                    None => tell(value, units),
                }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| tell(value, units)),
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
    use super::super::{contact_line, probe};
    use super::*;

    /// A column missing in its table would be written in SI units, whatever the units of its neighbours.
    #[test]
    fn every_column_has_its_quantity() {
        let headers = [probe::header(2), probe::header(3)];
        let nodes: Vec<&str> = contact_line::names().collect();
        for name in headers.iter().flat_map(|header| header.trim_end().split(',')).chain(nodes) {
            assert!(find(COLUMNS, name).is_some(), "{name}");
        }
    }
}
