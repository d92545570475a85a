//! What a folder needs to go on from a checkpoint.

use serde::{Deserialize, Serialize};

use stickslip::scene::Origin;
use stickslip::solver::history::Status;

/// What a folder needs to go on from a checkpoint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Kept {
    pub origin: Origin,
    /// The linear algebra, by its word.
    pub linear: String,
    /// The tables that grow, and at the end of the run all its files, with what they held, bytes.
    pub files: Vec<(String, u64)>,
    /// The files of fields, each with its time, s.
    pub fields: Vec<(f64, String)>,
    /// The verdict, if the run has come to its end.
    pub ended: Option<Status>,
}
