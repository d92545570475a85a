//! The errors of a history.

use super::Method;
use crate::algebra::linear::LinearError;
use crate::solver::checkpoint::CheckpointError;
use crate::solver::events::PathError;
use crate::solver::problem::ProblemError;

/// The reason why a history cannot be run or continued. An increment that does not converge is no error; it has a
/// [`super::Status`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An array does not fit the problem or has an invalid value.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The constants of the paper are stresses, which need weights.
    #[error("the method {method} has constants per area: give the problem the weight of each contact node")]
    NoWeight {
        /// The method.
        method: Method,
    },
    /// The linear solver failed.
    #[error(transparent)]
    Linear(#[from] LinearError),
    /// A checkpoint is damaged, or belongs to another run.
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
