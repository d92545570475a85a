//! Why a run ends without a report.

use crate::history;
use crate::linear::LinearError;
use crate::model::ModelError;
use crate::scene::SceneError;

/// Why a run ends without a report. A history that does not converge is no such error: its report tells.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// The scene cannot be discretised.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(#[from] ModelError),
    /// The machine has no room for the matrices.
    #[error(
        "the matrices of this mesh need {:.1} GB and the factors more, but {:.1} GB are free",
        gigabytes(*needed),
        gigabytes(*available)
    )]
    #[diagnostic(help("use a coarser mesh or a machine with more memory"))]
    NoRoom {
        /// What the matrices alone take, bytes.
        needed: u64,
        /// What the system can give, bytes.
        available: u64,
    },
    /// The uniqueness was asked for where [`crate::uniqueness`] does not tell it.
    #[error(
        "the uniqueness needs nodes that slide along a line: where they slide in a plane, friction turns with the slip"
    )]
    #[diagnostic(help("do not ask for the uniqueness, or let supports leave one direction to slide in"))]
    SlidesInAPlane,
    /// The linear algebra cannot go on, or an array does not fit.
    #[error(transparent)]
    #[diagnostic(help("{}", remedy(.0)))]
    History(#[from] history::Error),
}

impl RunError {
    /// Whether the input is to blame; otherwise it is the machine, or the library.
    pub fn is_of_the_input(&self) -> bool {
        use history::Error::{Checkpoint, NoWeight, Problem};
        let of_history = |error: &history::Error| matches!(error, Problem(_) | NoWeight { .. } | Checkpoint(_));
        match self {
            RunError::Model(_) | RunError::SlidesInAPlane => true,
            RunError::NoRoom { .. } => false,
            RunError::History(error) => of_history(error),
        }
    }
}

impl From<SceneError> for RunError {
    fn from(error: SceneError) -> Self {
        RunError::Model(error.into())
    }
}

fn gigabytes(bytes: u64) -> f64 {
    bytes as f64 * 1e-9
}

impl From<LinearError> for RunError {
    fn from(error: LinearError) -> Self {
        RunError::History(error.into())
    }
}

fn remedy(error: &history::Error) -> &'static str {
    use history::Error::{Checkpoint, Linear, NoWeight, Problem};
    match error {
        Linear(LinearError::OutOfMemory { .. }) => "use a coarser mesh or a machine with more memory",
        Problem(_) | NoWeight { .. } => "mend the array",
        Checkpoint(_) => "go on with the run as it was begun, or begin anew",
        _ => "this is not the scene's fault; please report it",
    }
}
