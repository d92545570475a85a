//! Why a history cannot be run, or not go on.

use super::Method;
use crate::algebra::linear::LinearError;
use crate::solver::checkpoint::CheckpointError;
use crate::solver::events::PathError;
use crate::solver::problem::ProblemError;

/// Why a history cannot be run, or not go on. That an increment does not converge is no error: it is a
/// [`super::Status`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An array does not fit the problem, or holds what it must not.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The constants of the paper are stresses.
    #[error("the method {method} has constants per area: give the problem the weight of each contact node")]
    NoWeight {
        /// The method.
        method: Method,
    },
    /// The method follows a path whose end it knows.
    #[error("the method {method} takes no single increments: it follows the whole path of the loads")]
    NotInSteps {
        /// The method.
        method: Method,
    },
    /// The linear algebra cannot go on.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// A checkpoint is damaged, or that of another run.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// An exact path cannot be followed.
    #[error(transparent)]
    Path(PathError),
}

impl From<PathError> for Error {
    fn from(error: PathError) -> Self {
        match error {
            PathError::Problem(error) => Error::Problem(error),
            PathError::Linear(error) => Error::Linear(error),
            other => Error::Path(other),
        }
    }
}
