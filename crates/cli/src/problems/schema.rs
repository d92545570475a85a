//! The JSON Schemas of reports on problems.

use serde_json::Value;

use super::{Collection, ProblemReport};
use stickslip_output::schema_of;

/// Returns the JSON Schema (draft 2020-12) of [`ProblemReport`], the output of `solve --json` and `judge --json`.
pub fn problem_schema() -> Value {
    schema_of::<ProblemReport>("A problem of an exchange file, solved or judged by stickslip")
}

/// Returns the JSON Schema (draft 2020-12) of [`Collection`], the output of `collection --json` and content of
/// collection.json.
pub fn collection_schema() -> Value {
    schema_of::<Collection>("The problems of a folder, solved by stickslip")
}
