//! The reason why bytes are no readable HDF5 file.

use stickslip::base::in_words;

/// The reason why bytes are no readable HDF5 file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Hdf5Error {
    /// The bytes contradict the format, end too early, or are of a part of it that cannot be read.
    #[error("the file is damaged, or of a layout that cannot be read: {what}")]
    Damaged {
        /// The fault.
        what: String,
    },
    /// A dataset exists, but was never written.
    #[error("its values were never written")]
    NotWritten,
    /// The values need more memory than is available.
    #[error("its values need {} of memory, but {} are left", in_words(*.needed), in_words(*.room))]
    NoRoom {
        /// Bytes that are needed.
        needed: u64,
        /// Bytes that are left.
        room: u64,
    },
    /// A dataset has another type.
    #[error("it holds {found}, but {expected} are needed")]
    Type {
        /// The type found.
        found: String,
        /// The type needed.
        expected: &'static str,
    },
}

impl Hdf5Error {
    /// Returns the cure.
    pub fn help(&self) -> &'static str {
        match self {
            Hdf5Error::Damaged { .. } => {
                "fetch or write the file again; h5dump shows how far it can be read, and h5repack --filter=NONE --layout=CONTI OLD \
                 NEW writes the layout that FCLIB has"
            }
            Hdf5Error::NotWritten => "write them, or remove the dataset",
            Hdf5Error::NoRoom { .. } => "check the sizes in the file, or use a machine with more memory",
            Hdf5Error::Type { .. } => "write it with the types that FCLIB has: H5T_NATIVE_INT and H5T_NATIVE_DOUBLE",
        }
    }
}

impl From<hdf5_reader::error::Error> for Hdf5Error {
    fn from(error: hdf5_reader::error::Error) -> Self {
        Hdf5Error::Damaged { what: error.to_string() }
    }
}

/// Returns what was looked for, or `None` if there is no object of its name.
pub(super) fn found<T>(looked_for: hdf5_reader::error::Result<T>) -> Result<Option<T>, Hdf5Error> {
    use hdf5_reader::error::Error;

    fn is_missing(error: &Error) -> bool {
        match error {
            Error::GroupNotFound(_) | Error::DatasetNotFound(_) => true,
            Error::Context { source, .. } => is_missing(source),
            _ => false,
        }
    }
    match looked_for {
        Ok(found) => Ok(Some(found)),
        Err(error) if is_missing(&error) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
