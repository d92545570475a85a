//! The reason why bytes are no readable HDF5 file.

use stickslip::base::in_words;

/// The reason why bytes are no readable HDF5 file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Hdf5Error {
    /// The bytes contradict the format, or end too early.
    #[error("the file is damaged at byte {at}: {what}")]
    Damaged {
        /// The position, from 0.
        at: usize,
        /// The error at this position.
        what: &'static str,
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
    /// A part of the format that exchange files do not need.
    #[error("{what} cannot be read here")]
    Unsupported {
        /// The name of this part.
        what: String,
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
            Hdf5Error::Damaged { .. } => "fetch or write the file again; h5dump shows how far it can be read",
            Hdf5Error::NotWritten => "write them, or remove the dataset",
            Hdf5Error::NoRoom { .. } => "check the sizes in the file, or use a machine with more memory",
            Hdf5Error::Unsupported { .. } => {
                "write it again in the layout that FCLIB has: h5repack --filter=NONE --layout=CONTI OLD NEW"
            }
            Hdf5Error::Type { .. } => "write it with the types that FCLIB has: H5T_NATIVE_INT and H5T_NATIVE_DOUBLE",
        }
    }
}
