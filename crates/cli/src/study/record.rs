//! The rows of a table: named values, as comma-separated values.

use serde_json::Value;
use stickslip::run::report::{csv_number, csv_table};

/// The named values of a row.
pub(crate) type Record = Vec<(String, Value)>;

/// Returns the keys and values of an object, in order.
pub(crate) fn record(object: Value) -> Record {
    match object {
        Value::Object(values) => values.into_iter().collect(),
        _ => Vec::new(),
    }
}

/// Formats records with the keys of the first one as comma-separated values, numbers by their keys.
pub(crate) fn csv(records: &[Record], number: impl Fn(&str, f64) -> String) -> String {
    let header: Vec<&str> = records.first().into_iter().flatten().map(|(key, _)| key.as_str()).collect();
    let field = |(key, value): &(String, Value)| match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        Value::Number(x) if x.is_f64() => x.as_f64().map_or_else(String::new, |x| number(key, x)),
        other => other.to_string(),
    };
    csv_table(&header, records.iter().map(|record| record.iter().map(field).collect()))
}

/// Formats a number so that it reads back the same, and seconds to a millionth.
pub(crate) fn number(key: &str, x: f64) -> String {
    if key == "seconds" { format!("{x:.6}") } else { csv_number(x) }
}
