//! Tables of whole folders of problems, with a row per file.

use serde::{Deserialize, Serialize};

use super::profile::Profile;
use super::report::{ProblemReport, Verdict};
use crate::study::{csv, distinct, record};
use serde_json::json;
use stickslip::run::report::{SCHEMA_VERSION, csv_number};
use stickslip_output::Table;

/// The results of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Collection {
    /// The version of this format.
    pub schema_version: u32,
    /// The number of files.
    pub files: usize,
    /// The number of files solved by any solver.
    pub solved: usize,
    /// The total CPU time, s.
    pub cpu_seconds: f64,
    /// A row for each file and solver.
    pub rows: Vec<Row>,
}

/// The result of one file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
pub struct Row {
    /// The name of the file.
    pub file: String,
    /// The solver, see [`Strategy`](stickslip_exchange::Strategy).
    pub way: String,
    /// `global` or `local`; empty if nothing was read.
    pub form: String,
    /// The number of dimensions: 2 in the plane, 3 in space.
    pub dimension: usize,
    /// The number of contacts, n_c.
    pub contacts: usize,
    /// The number of unknowns of the bodies, n; 0 for a local problem.
    pub unknowns: usize,
    /// The verdict.
    pub status: Verdict,
    /// The largest relative error; null if nothing was solved.
    pub residual: Option<f64>,
    /// The last stage of the solution.
    pub stage: String,
    /// The number of iterations of all stages.
    pub iterations: usize,
    /// CPU time, s.
    pub cpu_seconds: f64,
    /// The reason for a missing residual.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub message: String,
}

impl Row {
    /// Returns the row of a problem solved by `way`.
    pub fn of(report: &ProblemReport, way: &str) -> Self {
        Row {
            file: report.file.clone(),
            way: way.to_string(),
            form: report.form.clone(),
            dimension: report.dimension,
            contacts: report.contacts,
            unknowns: report.unknowns,
            status: report.status,
            residual: Some(report.residual),
            stage: report.stages.last().map(|stage| stage.stage.clone()).unwrap_or_default(),
            iterations: report.stages.iter().map(|stage| stage.iterations).sum(),
            cpu_seconds: report.cpu_seconds,
            message: String::new(),
        }
    }

    /// Returns the row of a file that could not be read or solved.
    pub fn failed(file: &str, way: &str, status: Verdict, message: String) -> Self {
        Row { file: file.to_string(), way: way.to_string(), status, message, ..Row::default() }
    }
}

impl Collection {
    /// Collects these rows. Rows of one file have the same name.
    pub fn new(rows: Vec<Row>) -> Self {
        let files = distinct(rows.iter().map(|row| row.file.as_str()));
        let is_solved = |file: &&&str| rows.iter().any(|row| row.file == **file && row.status == Verdict::Solved);
        let solved = files.iter().filter(is_solved).count();
        let cpu_seconds = rows.iter().map(|row| row.cpu_seconds).sum();
        Collection { schema_version: SCHEMA_VERSION, files: files.len(), solved, cpu_seconds, rows }
    }

    /// Formats the table with aligned columns, one line per row. Messages follow below.
    pub fn to_text(&self) -> String {
        let several = self.rows.iter().any(|row| row.way != self.rows[0].way);
        let way: &[&str] = if several { &["way"] } else { &[] };
        let heads =
            [&["verdict", "residual", "iterations", "CPU s", "n_c", "d", "form", "stage"], way, &["file"]].concat();
        let mut table = Table::new(&heads);
        for row in &self.rows {
            let of_a_problem = |x: usize| if row.form.is_empty() { String::new() } else { x.to_string() };
            let mut fields = vec![
                row.status.to_string(),
                row.residual.map_or(String::new(), |residual| format!("{residual:.1e}")),
                row.iterations.to_string(),
                format!("{:.3}", row.cpu_seconds),
                of_a_problem(row.contacts),
                of_a_problem(row.dimension),
                row.form.clone(),
                row.stage.clone(),
            ];
            if several {
                fields.push(row.way.clone());
            }
            fields.push(row.file.clone());
            table.push(fields);
        }
        let mut text = table.to_string();
        for row in self.rows.iter().filter(|row| !row.message.is_empty()) {
            text += &row.message;
            text.push('\n');
        }
        text
    }

    /// Formats the table as CSV, one line per row.
    pub fn to_csv(&self) -> String {
        let of_row = |row: &Row| {
            let mut values = json!(row);
            values["message"] = row.message.as_str().into();
            record(values)
        };
        // Without a row, the columns are those of an empty one.
        let columns = csv(&[of_row(&Row::default())], |_, x| csv_number(x));
        let rows = csv(&self.rows.iter().map(of_row).collect::<Vec<_>>(), |_, x| csv_number(x));
        if self.rows.is_empty() { columns.lines().take(1).collect() } else { rows }
    }

    /// Returns the performance profile of the solvers, by CPU time, over the files that were read.
    pub fn profile(&self) -> Profile {
        let mut profile = Profile::default();
        for row in self.rows.iter().filter(|row| row.status != Verdict::BadInput) {
            profile.add(&row.way, &row.file, (row.status == Verdict::Solved).then_some(row.cpu_seconds));
        }
        profile
    }
}
