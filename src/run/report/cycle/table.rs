//! The table of the nodes in a cycle, `cycle.csv`.

use super::super::csv;
use super::super::quantities::Column;
use super::CycleReport;
use super::node::CycleNode;
use crate::base::units::UnitSystem;

/// A column, written from this number of dimensions on.
type NodeColumn = (Column, usize, fn(&CycleNode) -> f64);

const fn known(name: &'static str) -> Column {
    Column::of(name).expect("a column with a known quantity")
}

const COLUMNS: [NodeColumn; 19] = [
    (known("node"), 2, |n| n.node as f64),
    (known("x"), 2, |n| n.position[0]),
    (known("y"), 2, |n| n.position[1]),
    (known("z"), 3, |n| n.position[2]),
    (known("area"), 2, |n| n.area),
    (known("slip_range"), 2, |n| n.slip_range),
    (known("slip_path"), 2, |n| n.slip_path),
    (known("slip_net"), 2, |n| n.slip_net),
    (known("energy_density"), 2, |n| n.energy_density),
    (known("sigma_n_mean"), 2, |n| n.pressure[0]),
    (known("sigma_n_range"), 2, |n| n.pressure[1]),
    (known("sigma_t_mean"), 2, |n| n.traction[0][0]),
    (known("sigma_t_range"), 2, |n| n.traction[0][1]),
    (known("sigma_o_mean"), 3, |n| n.traction[1][0]),
    (known("sigma_o_range"), 3, |n| n.traction[1][1]),
    (known("ruiz_1"), 2, |n| n.ruiz_1),
    (known("sigma_along_mean"), 2, |n| n.along[0]),
    (known("sigma_along_range"), 2, |n| n.along[1]),
    (known("ruiz_2"), 2, |n| n.ruiz_2),
];

const WEAR: NodeColumn = (known("wear_depth"), 2, |n| n.wear_depth.unwrap_or(f64::NAN));

impl CycleReport {
    /// Formats the nodes as CSV in these `units`, with a line for each node of each boundary.
    pub fn to_csv(&self, units: &UnitSystem) -> String {
        let wears = self.nodes.iter().any(|node| node.wear_depth.is_some());
        let columns = COLUMNS.iter().chain(wears.then_some(&WEAR));
        let columns: Vec<_> = columns.filter(|(_, dimension, _)| *dimension <= units.dimension).collect();
        let names = columns.iter().map(|(column, ..)| column.name());
        let header: Vec<&str> = ["boundary"].into_iter().chain(names).collect();
        let row = |node: &CycleNode| {
            let numbers = columns.iter().map(|(column, _, value)| column.cell(units, value(node)));
            [node.boundary.clone()].into_iter().chain(numbers).collect::<Vec<_>>()
        };
        csv::table(&header, self.nodes.iter().map(row))
    }
}
