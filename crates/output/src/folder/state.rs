//! The data with which a result folder resumes from a checkpoint.

use serde::{Deserialize, Serialize};

use stickslip::scene::Provenance;
use stickslip::solver::history::Status;

/// The linear solver of a run, which a resumed run keeps.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeptSolver {
    /// Its name.
    pub name: String,
    /// The reason for its choice, if there was a choice.
    pub reason: Option<String>,
}

/// The data with which a result folder resumes from a checkpoint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct FolderState {
    pub origin: Provenance,
    /// The linear solver.
    pub linear: KeptSolver,
    /// The growing tables, and at the end of the run all its files, each with its length, bytes.
    pub files: Vec<(String, u64)>,
    /// The files of fields, each with its time, s.
    pub fields: Vec<(f64, String)>,
    /// The verdict, if the run has finished.
    pub ended: Option<Status>,
}
