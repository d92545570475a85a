//! The JSON Schema of a report.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::{Transform, transform_subschemas};
use serde_json::{Value, json};

use super::RunReport;

/// The JSON Schema (draft 2020-12) of [`RunReport`], of `run.json` and of what `--json` prints of a run.
pub fn run_schema() -> Value {
    let mut generator = SchemaSettings::draft2020_12().for_serialize().into_generator();
    let mut schema = generator.root_schema_for::<RunReport>();
    schema.insert("title".into(), json!("A run of stickslip"));
    // Numbers that are not finite are null: JSON has no others.
    NullForNotFinite.transform(&mut schema);
    schema.to_value()
}

/// Lets every floating-point number be null.
struct NullForNotFinite;

impl Transform for NullForNotFinite {
    fn transform(&mut self, schema: &mut Schema) {
        if schema.get("type") == Some(&json!("number")) {
            schema.insert("type".into(), json!(["number", "null"]));
        }
        transform_subschemas(self, schema);
    }
}
