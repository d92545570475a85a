//! The reason why a file contains no readable problem.

use super::Hdf5Error;
use std::io;
use stickslip::base::InputError;

/// The reason why a file contains no readable problem.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The file cannot be read.
    #[error("{file}: the problem cannot be read: {error}")]
    Io {
        /// The file.
        file: String,
        /// The error of the system.
        error: io::Error,
    },
    /// The file has an unknown format.
    #[error("{file}: it is neither HDF5 nor a text")]
    Unknown {
        /// The file.
        file: String,
    },
    /// A part of the content is invalid.
    #[error("{file}, {fault}")]
    Content {
        /// The file.
        file: String,
        /// The dataset or the line, the error there, and the cure.
        fault: InputError,
    },
}

impl ExchangeError {
    /// Returns the cure.
    pub fn help(&self) -> &str {
        match self {
            ExchangeError::Io { .. } => "name an existing file",
            ExchangeError::Unknown { .. } => {
                "name an FCLIB file (HDF5) or a friction problem that Siconos has written (text)"
            }
            ExchangeError::Content { fault, .. } => &fault.help,
        }
    }
}

/// Describes an error of the dataset at `path`.
pub(super) fn of_dataset(path: &str, error: &Hdf5Error) -> InputError {
    InputError::new(format!("dataset {path}"), error.to_string(), error.help())
}
