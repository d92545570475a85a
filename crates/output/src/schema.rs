//! The JSON Schema of a report.

use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use stickslip::run::report::{RunReport, UnitNames};

/// Returns the JSON Schema (draft 2020-12) of [`RunReport`], the content of `run.json` and the output of `run --json`.
pub fn run_schema() -> Value {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    // A report in other units than SI names them. This schema comes first, so that its references are included.
    let units = generator.subschema_for::<UnitNames>();
    let mut schema = generator.root_schema_for::<RunReport>();
    schema.insert("title".into(), json!("A run of stickslip"));
    if let Some(properties) = schema.get_mut("properties").and_then(Value::as_object_mut) {
        properties.insert("units".into(), units.to_value());
    }
    // Numbers that are not finite are written as null, because JSON has no others.
    NullForNotFinite.transform(&mut schema);
    schema.to_value()
}

/// Returns the JSON Schema of a type whose numbers have no selectable units.
pub fn schema_of<T: JsonSchema>(title: &str) -> Value {
    let mut schema = SchemaSettings::draft2020_12().for_serialize().into_generator().into_root_schema_for::<T>();
    schema.insert("title".into(), json!(title));
    NullForNotFinite.transform(&mut schema);
    schema.to_value()
}

/// Allows null for every floating-point number.
struct NullForNotFinite;

impl Transform for NullForNotFinite {
    fn transform(&mut self, schema: &mut Schema) {
        if schema.get("type") == Some(&json!("number")) {
            schema.insert("type".into(), json!(["number", "null"]));
        }
        transform_subschemas(self, schema);
    }
}
