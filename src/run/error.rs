//! The reason why a run ends without a report.

use crate::algebra::linear::LinearError;
use crate::base::memory::{Budget, in_words};
use crate::body::model::ModelError;
use crate::scene::SceneError;
use crate::solver::history;

/// The reason why a run ends without a report. A history that does not converge is no such error and has a report.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RunError {
    /// A value of the scene is impossible, or contradicts the mesh. The message names file and line.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] SceneError),
    /// The scene cannot be discretised.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(ModelError),
    /// The run needs more memory than is available.
    #[error("{what} need about {} of memory, but {} leaves {}", in_words(*needed), budget.source, in_words(budget.bytes))]
    #[diagnostic(help("{}", budget.source.remedy()))]
    NoRoom {
        /// The part that needs it.
        what: &'static str,
        /// The memory that it needs, by an estimate, bytes.
        needed: u64,
        /// The available memory and the source of this limit.
        budget: Budget,
    },
    /// The uniqueness was requested, but the analysis of uniqueness cannot compute it here.
    #[error(
        "the uniqueness can be computed only for nodes that slide along a line: in a plane, friction turns with the \
         slip"
    )]
    #[diagnostic(help("do not request the uniqueness, or let supports leave only one sliding direction"))]
    SlidesInAPlane,
    /// The model has a pretension whose lock needs the shortening, which only the run of a scene finds.
    #[error("the pretension `{0}` locks, but the model still has its force")]
    #[diagnostic(help("make the model with `run::discretise` from a scene, or prescribe the shortening"))]
    Unlocked(String),
    /// The linear algebra cannot go on, or an array does not fit.
    #[error(transparent)]
    #[diagnostic(help("{}", remedy(.0)))]
    History(#[from] history::Error),
}

impl RunError {
    /// Returns `true` for an error of the input, and `false` for a failure of the machine or the library.
    pub fn is_of_the_input(&self) -> bool {
        use history::Error::{Checkpoint, Linear, NoWeight, Problem};
        let of_history = |error: &history::Error| match error {
            Linear(LinearError::Engine { of_options, .. }) => *of_options,
            other => matches!(other, Problem(_) | NoWeight { .. } | Checkpoint(_)),
        };
        match self {
            RunError::Scene(_) | RunError::Model(_) | RunError::SlidesInAPlane | RunError::Unlocked(_) => true,
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
        Linear(LinearError::Engine { help, .. }) => help,
        Linear(LinearError::Version { .. }) => "until then take the solver faer, which needs no SuiteSparse",
        Problem(_) | NoWeight { .. } => "correct the array",
        Checkpoint(_) => "resume with the scene and options of the original run, or start a new run",
        _ => "this is not the scene's fault; please report it",
    }
}
