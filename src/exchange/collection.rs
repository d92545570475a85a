//! Whole folders of problems: a table, and how many are solved how fast.

use serde::{Deserialize, Serialize};

use crate::report::{Axis, Chart, Curve, Dash, Line, Panel, Scale, Table, csv_number, csv_table, told_apart};

/// The results of a folder.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Collection {
    /// One row for each file.
    pub rows: Vec<Row>,
}

/// What became of a file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Row {
    /// Its name.
    pub file: String,
}
impl Collection {
}
