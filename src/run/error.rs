//! Why a run ends without a report.

use crate::algebra::linear::LinearError;
use crate::base::memory::{Budget, in_words};
use crate::body::model::ModelError;
use crate::scene::SceneError;
use crate::solver::history;

/// Why a run ends without a report. A history that does not converge is no such error: its report tells.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// A value of the scene is not possible, or contradicts the mesh; the message names file and line.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// The scene cannot be discretised.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(ModelError),
    /// There is no room for what the run takes.
    #[error("{what} need {} or more, but {} leaves {}", in_words(*needed), budget.source, in_words(budget.bytes))]
    #[diagnostic(help("{}", budget.source.remedy()))]
    NoRoom {
        /// What needs it.
        what: &'static str,
        /// What that takes at least, bytes.
        needed: u64,
        /// What may be taken, and who says so.
        budget: Budget,
    },
    /// The uniqueness was asked for where [`crate::solver::uniqueness`] does not tell it.
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
            RunError::Scene(_) | RunError::Model(_) | RunError::SlidesInAPlane => true,
            RunError::NoRoom { .. } => false,
            RunError::History(error) => of_history(error),
        }
    }
}

impl From<ModelError> for RunError {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Linear(error) => error.into(),
            other => RunError::Model(other),
        }
    }
}

impl From<LinearError> for RunError {
    fn from(error: LinearError) -> Self {
        RunError::History(error.into())
    }
}

fn remedy(error: &history::Error) -> &'static str {
    use history::Error::{Checkpoint, Linear, NoWeight, Problem};
    match error {
        Linear(LinearError::OutOfMemory { .. }) => {
            "use a coarser mesh, raise the memory limit, or use a machine with more memory"
        }
        Linear(LinearError::Version { .. }) => "until then take the solver faer, which needs no SuiteSparse",
        Problem(_) | NoWeight { .. } => "mend the array",
        Checkpoint(_) => "go on with the run as it was begun, or begin anew",
        _ => "this is not the scene's fault; please report it",
    }
}
