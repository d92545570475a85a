//! The table of the nodes in a cycle, `cycle.csv`.

use super::super::csv;
use super::super::quantities::Columns;
use super::CycleReport;
use super::node::CycleNode;
use crate::base::units::UnitSystem;

/// A column of numbers: its name, the number of components of forces from which on it is written, and its value.
type NodeColumn = (&'static str, usize, fn(&CycleNode) -> f64);

const COLUMNS: [NodeColumn; 19] = [
    ("node", 2, |n| n.node as f64),
    ("x", 2, |n| n.position[0]),
    ("y", 2, |n| n.position[1]),
    ("z", 3, |n| n.position[2]),
    ("area", 2, |n| n.area),
    ("slip_range", 2, |n| n.slip_range),
    ("slip_path", 2, |n| n.slip_path),
    ("slip_net", 2, |n| n.slip_net),
    ("energy_density", 2, |n| n.energy_density),
    ("sigma_n_mean", 2, |n| n.pressure[0]),
    ("sigma_n_range", 2, |n| n.pressure[1]),
    ("sigma_t_mean", 2, |n| n.traction[0][0]),
    ("sigma_t_range", 2, |n| n.traction[0][1]),
    ("sigma_o_mean", 3, |n| n.traction[1][0]),
    ("sigma_o_range", 3, |n| n.traction[1][1]),
    ("ruiz_1", 2, |n| n.ruiz_1),
    ("sigma_along_mean", 2, |n| n.along[0]),
    ("sigma_along_range", 2, |n| n.along[1]),
    ("ruiz_2", 2, |n| n.ruiz_2),
];

const WEAR: NodeColumn = ("wear_depth", 2, |n| n.wear_depth.unwrap_or(f64::NAN));

impl CycleReport {
    /// Formats the nodes as CSV in these `units`, with a line for each node of each boundary.
    pub fn to_csv(&self, units: &UnitSystem) -> String {
        let wears = self.nodes.iter().any(|node| node.wear_depth.is_some());
        let columns = COLUMNS.iter().chain(wears.then_some(&WEAR));
        let columns: Vec<_> = columns.filter(|(_, components, _)| *components <= units.components).collect();
        let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
        let written = Columns::new(units, names.iter().copied());
        let row = |node: &CycleNode| {
            let numbers = columns.iter().map(|(.., value)| value(node));
            [node.boundary.clone()].into_iter().chain(written.cells(numbers)).collect()
        };
        let header = [vec!["boundary"], names].concat();
        csv::table(&header, self.nodes.iter().map(row))
    }
}

/// Returns the names of all columns.
#[cfg(test)]
pub(in crate::run::report) fn names() -> impl Iterator<Item = &'static str> {
    COLUMNS.iter().chain([&WEAR]).map(|column| column.0).chain(["boundary"])
}
