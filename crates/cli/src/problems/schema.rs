//! The JSON Schemas of what is told of problems.

use serde_json::Value;

use super::{Collection, ProblemReport};
use stickslip_output::schema_of;

/// The JSON Schema (draft 2020-12) of [`ProblemReport`]: what `solve --json` and `judge --json` print.
pub fn problem_schema() -> Value {
    schema_of::<ProblemReport>("A problem of an exchange file, solved or judged by stickslip")
}

/// The JSON Schema (draft 2020-12) of [`Collection`]: what `collection --json` prints, and collection.json.
pub fn collection_schema() -> Value {
    schema_of::<Collection>("The problems of a folder, solved by stickslip")
}
