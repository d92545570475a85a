//! The part of HDF5 that exchange files need: groups, and datasets of numbers and short texts, in one file.
//!
//! libhdf5 itself crashes on damaged files, and general readers trust the sizes stated in a file. This is therefore a
//! small separate reader, for the File Format Specification versions 0 to 3. It reads only the given bytes, checks
//! every address against their end, and never reserves memory by a number stored in them.
//!
//! | file | content |
//! | --- | --- |
//! | `bytes.rs` | numbers at addresses |
//! | `header.rs` | object headers of versions 1 and 2, and their messages |
//! | `links.rs` | the names in a group: symbol tables and link messages |
//! | `dataset.rs`, `chunks.rs` | the type of a dataset, and its values: contiguous, compact or in chunks, with deflate and shuffle |
//! | `write.rs` | the oldest layout, which every version of HDF5 reads |

mod bytes;
mod chunks;
mod dataset;
mod error;
mod header;
mod links;
mod write;

pub(super) use dataset::Dataset;
pub use error::Hdf5Error;
pub(super) use write::{Node, write};

use bytes::{Bytes, Sizes};
use header::{Message, messages};
use std::cell::Cell;
use stickslip::base::Budget;

/// The first bytes of every superblock.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The memory for a file without compression, in multiples of its length. Up to this, the system is not asked for its
/// free memory.
const UNPACKED: u64 = 8;

/// Returns the position of the superblock of a file: at its start, or after a user block, whose length is 512 bytes
/// times a power of two.
fn superblock(bytes: &[u8]) -> Option<usize> {
    let places = std::iter::once(0).chain((9..usize::BITS).map(|power| 1 << power));
    places.take_while(|place| *place < bytes.len()).find(|place| bytes[*place..].starts_with(SIGNATURE))
}

/// Returns `true` if these are the `bytes` of an HDF5 file.
pub(super) fn is_hdf5(bytes: &[u8]) -> bool {
    superblock(bytes).is_some()
}

/// The bytes of a file, and the position of its root group.
pub(super) struct File<'a> {
    bytes: Bytes<'a>,
    root: u64,
    /// The bytes of memory requested so far.
    taken: Cell<u64>,
}

impl<'a> File<'a> {
    /// Opens the file with these `bytes`.
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, Hdf5Error> {
        let damaged = |at: usize, what: &'static str| Err(Hdf5Error::Damaged { at, what });
        let Some(start) = superblock(bytes) else { return damaged(0, "the signature of HDF5 is missing") };
        let mut head = Bytes::new(bytes, start, Sizes::default()).at(8)?;
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
            return damaged(start + 9, "addresses are of no size that there is");
        }
        // Skips to the base address: the orders of trees and flags in old versions, flags in new ones.
        let skipped = match version {
            0 => 9,
            1 => 13,
            _ => 1,
        };
        let mut head = Bytes::new(bytes, start, sizes).at(head.address())?;
        head.skip(skipped)?;
        // Addresses count from the superblock, even if a block was later put in front of it. The end counts from the
        // base address that was valid when the file was written.
        let base = head.offset()?;
        head.offset()?;
        if head.offset()?.saturating_sub(base) > (bytes.len() - start) as u64 {
            return damaged(bytes.len(), "the file is shorter than it says, as where a transfer was cut off");
        }
        if version < 2 {
            // The driver's block, then the entry of the root group: its name and its header.
            head.offset()?;
            head.offset()?;
        }
        let root = head.offset()?;
        Ok(File { bytes: Bytes::new(bytes, start, sizes), root, taken: Cell::new(0) })
    }

    /// Returns the length of the file, bytes.
    pub(super) fn length(&self) -> usize {
        self.bytes.file_length()
    }

    /// Adds `bytes` to the memory in use. Returns an error if there is not enough memory for the total.
    pub(super) fn take_room(&self, bytes: u64) -> Result<(), Hdf5Error> {
        let needed = self.taken.get().saturating_add(bytes);
        self.taken.set(needed);
        if needed <= UNPACKED.saturating_mul(self.length() as u64) {
            return Ok(());
        }
        match Budget::of_process() {
            Some(Budget { bytes: room, .. }) if needed > room => Err(Hdf5Error::NoRoom { needed, room }),
            _ => Ok(()),
        }
    }

    /// Returns the messages of the object at `path`, whose names are separated by `/`. `None` if there is no such
    /// object.
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

    /// Returns `true` if there is an object at `path`.
    pub(super) fn has(&self, path: &str) -> Result<bool, Hdf5Error> {
        Ok(self.find(path)?.is_some())
    }

    /// Returns the dataset at `path`, if any. Its values are read on request.
    pub(super) fn dataset(&self, path: &str) -> Result<Option<Dataset<'a>>, Hdf5Error> {
        self.find(path)?.map(|object| Dataset::new(self.bytes, &object)).transpose()
    }
}
