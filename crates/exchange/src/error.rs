//! Why a file holds no problem that can be read.

use std::io;

use super::Hdf5Error;
use stickslip::base::input_error::InputError;

/// Why a file holds no problem that can be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The file cannot be read.
    #[error("{file}: the problem cannot be read: {error}")]
    Io {
        /// The file.
        file: String,
        /// What the system said.
        error: io::Error,
    },
    /// The file is of another kind.
    #[error("{file}: it is neither HDF5 nor a text")]
    Unknown {
        /// The file.
        file: String,
    },
    /// Something in it does not fit.
    #[error("{file}, {fault}")]
    Content {
        /// The file.
        file: String,
        /// The dataset or the line, what is wrong there, and the cure.
        fault: InputError,
    },
}

impl ExchangeError {
    /// What to do about it.
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

/// The fault of the dataset at `path`.
pub(super) fn of_dataset(path: &str, error: &Hdf5Error) -> InputError {
    InputError::new(format!("dataset {path}"), error.to_string(), error.help())
}
