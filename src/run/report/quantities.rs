//! The quantities of all results by their names, and the conversion to the units of a body. Only this module gives
//! units to columns of tables, fields and keys of reports.

use serde_json::Value;

use super::csv;
use crate::base::units::{Quantity, UnitSystem};

use Quantity::{Area, Energy, EnergyPerArea, Force, Length, Moment, Number, Stress, StressEnergyPerArea};

/// The columns of all tables.
const COLUMNS: &Table = &[
    (
        &[
            "index",
            "time",
            "status",
            "iterations",
            "backtracks",
            "theta",
            "backward_error",
            "parts",
            "attempts",
            "rescued",
        ],
        Number,
    ),
    (&["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"], Number),
    (&["open", "stick", "slip"], Number),
    (&["seconds_assembly", "seconds_factorization", "seconds_solve", "seconds_rest"], Number),
    (&["friction_work", "strain_energy", "energy"], Energy),
    (&["boundary", "kind", "balance", "obstacle", "point", "node", "from", "to"], Number),
    (&["n_x", "n_y", "n_z", "t_x", "t_y", "t_z", "o_x", "o_y", "o_z"], Number),
    (&["f_x", "f_y", "f_z", "sum_p_n", "sum_p_t", "sum_p_o", "p_n", "p_t", "p_o"], Force),
    (&["m_x", "m_y", "m_z"], Moment),
    (&["rotation_x", "rotation_y", "rotation_z"], Number),
    (&["x", "y", "z", "w_n", "w_t", "w_o", "gap", "slip_t", "slip_o", "u_x", "u_y", "u_z"], Length),
    (&["sigma_n", "sigma_t", "sigma_o", "sigma_patch", "sigma_along", "sigma_across", "sigma_shear"], Stress),
    (&["s_xx", "s_yy", "s_zz", "s_xy", "s_yz", "s_zx", "von_mises"], Stress),
    (&["area"], Area),
    (&["slip_range", "slip_path", "slip_net", "wear_depth"], Length),
    (&["energy_density", "ruiz_1"], EnergyPerArea),
    (&["ruiz_2"], StressEnergyPerArea),
    (
        &[
            "sigma_n_mean",
            "sigma_n_range",
            "sigma_t_mean",
            "sigma_t_range",
            "sigma_o_mean",
            "sigma_o_range",
            "sigma_along_mean",
            "sigma_along_range",
        ],
        Stress,
    ),
];

/// The fields of bodies.
const FIELDS: &Table = &[
    (&["displacement", "slip", "opening"], Length),
    (
        &[
            "contact_pressure",
            "patch_pressure",
            "tangential_traction",
            "nodal_stress",
            "nodal_von_mises",
            "stress",
            "principal_stress",
            "von_mises",
        ],
        Stress,
    ),
    (&["contact", "material", "body", "discretisation_error", "rank"], Number),
];

/// The keys of a report whose values have a unit; doc/reference/results.md lists them all.
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
            "slip_range",
            "slip_net",
            "displacement",
            "shortening",
        ],
        Length,
    ),
    (&["force", "normal_force", "magnitude", "sum_p_n", "sum_p_t", "sum_p_o"], Force),
    (&["moment"], Moment),
    (&["friction_work", "friction_work_corrected", "strain_energy"], Energy),
    (&["pressure", "mean_pressure", "peak_pressure", "patch_pressure"], Stress),
];

/// A list of names with their quantity.
type Table = [(&'static [&'static str], Quantity)];

fn find<'a>(table: &'a Table, name: &'a str) -> Option<Quantity> {
    table.iter().find(|(names, _)| names.contains(&name)).map(|(_, quantity)| *quantity)
}

/// A column of result tables: its name and its quantity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    name: &'static str,
    quantity: Quantity,
}

impl Column {
    /// Returns the column of this name. A constant that expects it does not compile with an unknown name.
    pub const fn of(name: &'static str) -> Option<Self> {
        let mut row = 0;
        while row < COLUMNS.len() {
            let (names, quantity) = COLUMNS[row];
            let mut k = 0;
            while k < names.len() {
                if same(names[k], name) {
                    return Some(Column { name, quantity });
                }
                k += 1;
            }
            row += 1;
        }
        None
    }

    /// Returns the columns of these names, if each has one.
    pub const fn all<const N: usize>(names: [&'static str; N]) -> Option<[Self; N]> {
        let mut columns = [Column { name: "", quantity: Number }; N];
        let mut k = 0;
        while k < N {
            match Column::of(names[k]) {
                Some(column) => columns[k] = column,
                None => return None,
            }
            k += 1;
        }
        Some(columns)
    }

    /// The name in the header.
    pub const fn name(self) -> &'static str {
        self.name
    }

    /// The number `x` (SI) as it stands in the column.
    pub fn cell(self, units: &UnitSystem, x: f64) -> String {
        csv::number(units.of_si(self.quantity, x))
    }
}

/// Returns `true` if two texts are equal; usable in constants.
const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut k = 0;
    while k < a.len() && k < b.len() && a[k] == b[k] {
        k += 1;
    }
    k == a.len() && k == b.len()
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
    use super::super::{contact_line, probe};
    use super::*;

    #[test]
    fn columns_are_known_by_their_whole_names() {
        assert_eq!(Column::of("pressures"), None);
        for (names, quantity) in COLUMNS {
            assert!(names.iter().all(|name| Column::of(name) == Some(Column { name, quantity: *quantity })));
        }
        assert!(same("s_xx", "s_xx") && !same("s_xx", "s_x") && !same("s_x", "s_xx") && !same("", "x"));
    }

    /// A column that is not in its table would be told in SI units, whatever its neighbours are told in.
    #[test]
    fn every_column_has_its_quantity() {
        let headers = [probe::header(2), probe::header(3)];
        let nodes: Vec<&str> = contact_line::names().collect();
        for name in headers.iter().flat_map(|header| header.trim_end().split(',')).chain(nodes) {
            assert!(column(name).is_some(), "{name}");
        }
    }
}
