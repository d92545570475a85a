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

pub(super) use dataset::Dataset;
pub use error::Hdf5Error;
pub(super) use write::{Node, write};

use std::cell::Cell;

use bytes::{Bytes, Sizes};
use header::{Message, messages};

use stickslip::base::memory::Budget;

/// What every superblock begins with.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// Memory for what is read of a file that is not compressed, in multiples of its length: the system need not be asked for so much.
const UNPACKED: u64 = 8;

/// Where the superblock of a file begins: at its start, or behind a block of the user, whose length is 512 bytes or a power of two
/// times as many.
fn superblock(bytes: &[u8]) -> Option<usize> {
    let places = std::iter::once(0).chain((9..usize::BITS).map(|power| 1 << power));
    places.take_while(|place| *place < bytes.len()).find(|place| bytes[*place..].starts_with(SIGNATURE))
}

/// Whether these are the `bytes` of an HDF5 file.
pub(super) fn is_hdf5(bytes: &[u8]) -> bool {
    superblock(bytes).is_some()
}

/// The bytes of a file, and where its root group is.
pub(super) struct File<'a> {
    bytes: Bytes<'a>,
    root: u64,
    /// Bytes of memory that were asked for.
    taken: Cell<u64>,
}

impl<'a> File<'a> {
    /// The file with these `bytes`.
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
        // To the base address: the orders of trees and flags of the old versions, flags of the new ones.
        let skipped = match version {
            0 => 9,
            1 => 13,
            _ => 1,
        };
        let mut head = Bytes::new(bytes, start, sizes).at(head.address())?;
        head.skip(skipped)?;
        // Addresses count from the superblock, even where a block was put before the file afterwards; the end, from the base address
        // that was true when the file was written.
        let base = head.offset()?;
        head.offset()?;
        if head.offset()?.saturating_sub(base) > (bytes.len() - start) as u64 {
            return damaged(bytes.len(), "the file is shorter than it says, as where a transfer was cut off");
        }
        if version < 2 {
            // The driver's block, then the entry of the root group: its name, its header.
            head.offset()?;
            head.offset()?;
        }
        let root = head.offset()?;
        Ok(File { bytes: Bytes::new(bytes, start, sizes), root, taken: Cell::new(0) })
    }

    /// How many bytes the file has.
    pub(super) fn length(&self) -> usize {
        self.bytes.file_length()
    }

    /// Counts so many `bytes` as taken: an error if there is no memory for all that was taken.
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

    /// The dataset at `path`, if there is one. Its values are read when they are asked for.
    pub(super) fn dataset(&self, path: &str) -> Result<Option<Dataset<'a>>, Hdf5Error> {
        self.find(path)?.map(|object| Dataset::new(self.bytes, &object)).transpose()
    }
}
