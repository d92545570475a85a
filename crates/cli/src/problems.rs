//! Reports on exchange files: the report of one file, the table of a folder, and performance profiles.

mod collection;
mod profile;
mod report;
mod schema;

pub use collection::{Collection, Row};
pub use profile::Profile;
pub use report::{ProblemReport, Verdict};
pub use schema::{collection_schema, problem_schema};
