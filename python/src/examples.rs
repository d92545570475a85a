//! Scenes to start from, and scenes as dictionaries.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde_json::Value as Json;
use toml_edit::{Item, TableLike, Value};

/// A scene with the files that it reads.
struct Example {
    name: &'static str,
    text: &'static str,
    files: &'static [(&'static str, &'static [u8])],
}

/// The scenes of `stickslip init`.
const EXAMPLES: [Example; 3] = [
    Example { name: "block", text: include_str!("../../data/init/block.toml"), files: &[] },
    Example { name: "cube", text: include_str!("../../data/init/cube.toml"), files: &[] },
    Example {
        name: "gmsh",
        text: include_str!("../../data/init/roller.toml"),
        files: &[("roller.msh", include_bytes!("../../data/init/roller.msh"))],
    },
];

/// Files by their names.
type Files<'py> = Vec<(&'static str, Bound<'py, PyBytes>)>;

/// The names of all of them.
#[pyfunction]
pub(crate) fn examples() -> Vec<&'static str> {
    EXAMPLES.iter().map(|example| example.name).collect()
}

/// The text of one, and the files that it reads.
#[pyfunction]
pub(crate) fn example<'py>(py: Python<'py>, name: &str) -> Option<(&'static str, Files<'py>)> {
    let Example { text, files, .. } = EXAMPLES.iter().find(|example| example.name == name)?;
    Some((text, files.iter().map(|(name, bytes)| (*name, PyBytes::new(py, bytes))).collect()))
}

/// A text in TOML as JSON.
#[pyfunction]
pub(crate) fn toml_to_json(text: &str) -> PyResult<String> {
    let document = toml_edit::Document::parse(text)
        .map_err(|error| PyValueError::new_err(error.to_string().trim().to_string()))?;
    serde_json::to_string(&of_table(document.as_table())).map_err(|error| PyValueError::new_err(error.to_string()))
}

fn of_table(table: &dyn TableLike) -> Json {
    Json::Object(table.iter().map(|(key, item)| (key.to_string(), of_item(item))).collect())
}

fn of_item(item: &Item) -> Json {
    match item {
        Item::None => Json::Null,
        Item::Value(value) => of_value(value),
        Item::Table(table) => of_table(table),
        Item::ArrayOfTables(tables) => Json::Array(tables.iter().map(|table| of_table(table)).collect()),
    }
}

fn of_value(value: &Value) -> Json {
    match value {
        Value::String(text) => text.value().clone().into(),
        Value::Integer(number) => (*number.value()).into(),
        Value::Float(number) => (*number.value()).into(),
        Value::Boolean(truth) => (*truth.value()).into(),
        // No key of a scene has a date.
        Value::Datetime(date) => date.value().to_string().into(),
        Value::Array(values) => Json::Array(values.iter().map(of_value).collect()),
        Value::InlineTable(table) => of_table(table),
    }
}
