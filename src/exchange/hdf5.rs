//! The part of HDF5 that exchange files need: groups, and datasets of numbers and short texts, in one file.
//!
//! What libhdf5 itself does with a damaged file is a crash, and what general readers do is to believe the sizes that it states. So
//! this is a small reader of its own, for the File Format Specification versions 0 to 3: it looks at nothing but the bytes it is given, checks
//! every address against their end, and reserves no memory by a number that stands in them.
//!
//! | what | file |
//! | --- | --- |
//! | numbers at addresses | `bytes.rs` |
//! | object headers of versions 1 and 2, and their messages | `header.rs` |
//! | the names in a group: symbol tables and link messages | `links.rs` |
//! | what a dataset is of, and its values: contiguous, compact or in chunks, with deflate and shuffle | `dataset.rs`, `chunks.rs` |
//! | the oldest layout of all of it, which every version of HDF5 reads | `write.rs` |

mod bytes;
mod chunks;
mod dataset;
mod error;
mod header;
mod links;
mod write;

pub use error::Hdf5Error;
pub(super) use write::{Node, write};

use bytes::{Bytes, Sizes};
use header::{Message, messages};

/// What every HDF5 file begins with.
pub(super) const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The bytes of a file, and where its root group is.
pub(super) struct File<'a> {
    bytes: Bytes<'a>,
    root: u64,
}

impl<'a> File<'a> {
    /// The file with these `bytes`.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Hdf5Error> {
        let damaged = |at: usize, what: &'static str| Err(Hdf5Error::Damaged { at, what });
        if !bytes.starts_with(SIGNATURE) {
            return damaged(0, "the signature of HDF5 is missing");
        }
        let mut head = Bytes::new(bytes, Sizes::default()).at(8)?;
        let version = head.u8()?;
        let (offsets, lengths) = match version {
            0 | 1 => {
                head.skip(4)?;
                (head.u8()?, head.u8()?)
            }
            2 | 3 => (head.u8()?, head.u8()?),
            _ => return Err(Hdf5Error::Unsupported { what: format!("a superblock of version {version}") }),
        };
        let sizes = Sizes { offsets: usize::from(offsets), lengths: usize::from(lengths) };
        if ![sizes.offsets, sizes.lengths].iter().all(|size| matches!(size, 2 | 4 | 8)) {
            return damaged(9, "addresses are of no size that there is");
        }
        // To the base address: the orders of trees and flags of the old versions, flags of the new ones.
        let skipped = match version {
            0 => 9,
            1 => 13,
            _ => 1,
        };
        let mut head = Bytes::new(bytes, sizes).at(head.place() as u64)?;
        head.skip(skipped)?;
        if head.offset()? != 0 {
            return Err(Hdf5Error::Unsupported {
                what: "a file that begins with something else than HDF5".to_string(),
            });
        }
        head.offset()?;
        if head.offset()? > bytes.len() as u64 {
            return damaged(bytes.len(), "the file is shorter than it says, as where a transfer was cut off");
        }
        if version < 2 {
            // The driver's block, then the entry of the root group: its name, its header.
            head.offset()?;
            head.offset()?;
        }
        let root = head.offset()?;
        Ok(File { bytes: Bytes::new(bytes, sizes), root })
    }

    /// The messages of the object at `path`, names with `/` between them; `None` where there is no such object.
    fn find(&self, path: &str) -> Result<Option<Vec<Message<'a>>>, Hdf5Error> {
        let mut object = messages(self.bytes, self.root)?;
        for name in path.split('/').filter(|name| !name.is_empty()) {
            match links::find(self.bytes, &object, name)? {
                Some(address) => object = messages(self.bytes, address)?,
                None => return Ok(None),
            }
        }
        Ok(Some(object))
    }

    /// Whether there is an object at `path`.
    pub(super) fn has(&self, path: &str) -> Result<bool, Hdf5Error> {
        Ok(self.find(path)?.is_some())
    }

    /// The integers of the dataset at `path`, if there is one.
    pub(super) fn integers(&self, path: &str) -> Result<Option<Vec<i64>>, Hdf5Error> {
        self.find(path)?.map(|object| dataset::integers(self.bytes, &object)).transpose()
    }

    /// The numbers of the dataset at `path`, if there is one; integers are numbers, too.
    pub(super) fn numbers(&self, path: &str) -> Result<Option<Vec<f64>>, Hdf5Error> {
        self.find(path)?.map(|object| dataset::numbers(self.bytes, &object)).transpose()
    }

    /// Whether there is a dataset at `path` that values were written into.
    pub(super) fn is_written(&self, path: &str) -> Result<bool, Hdf5Error> {
        match self.find(path)?.map(|object| dataset::is_written(self.bytes, &object)) {
            None => Ok(false),
            Some(written) => written,
        }
    }

    /// The text of the dataset at `path`, if there is one of a fixed length; what is not UTF-8 in it is replaced.
    pub(super) fn text(&self, path: &str) -> Result<Option<String>, Hdf5Error> {
        self.find(path)?.map_or(Ok(None), |object| dataset::text(self.bytes, &object))
    }
}
