//! HDF5 as exchange files use it: groups, and datasets of numbers and short texts, in one file.
//!
//! `hdf5-reader` reads the format. Three claims of a file that it believes are checked here: the length of the file, the
//! length of a text, and the format of numbers. `write.rs` writes the oldest layout, which every version of HDF5 reads.

mod error;
mod write;

pub use error::Hdf5Error;
pub(super) use write::{Node, write};

use hdf5_reader::error::ByteOrder;
use hdf5_reader::messages::HdfMessage;
use hdf5_reader::messages::layout::DataLayout;
use hdf5_reader::{Datatype, Hdf5File, StringSize};
use std::cell::Cell;
use stickslip::base::Budget;

/// The first bytes of every superblock.
const SIGNATURE: &[u8] = b"\x89HDF\r\n\x1a\n";

/// The memory for a file without compression, in multiples of its length. Up to this, the system is not asked for its
/// free memory.
const UNPACKED: u64 = 8;

/// The position of the properties of a number in its datatype, behind class, flags and size.
const PROPERTIES: usize = 8;

/// The properties of floating-point numbers of IEEE 754: offset and precision; positions and sizes of exponent and mantissa; bias.
const DOUBLE: [u8; 12] = [0, 0, 64, 0, 52, 11, 0, 52, 0xff, 3, 0, 0];
const SINGLE: [u8; 12] = [0, 0, 32, 0, 23, 8, 0, 23, 127, 0, 0, 0];
const IEEE: &str = "floating-point numbers of IEEE 754 in 4 or 8 bytes";

/// Returns the position of the superblock of a file: at its start, or after a user block, whose length is 512 bytes
/// times a power of two.
fn superblock(bytes: &[u8]) -> Option<usize> {
    let offsets = std::iter::once(0).chain((9..usize::BITS).map(|power| 1 << power));
    offsets.take_while(|place| *place < bytes.len()).find(|place| bytes[*place..].starts_with(SIGNATURE))
}

/// Returns `true` if these are the `bytes` of an HDF5 file.
pub(super) fn is_hdf5(bytes: &[u8]) -> bool {
    superblock(bytes).is_some()
}

/// Returns `true` if the file ends before the end that its superblock states. Addresses count from the superblock, even if a
/// block was later put in front of it; the end counts from the base address that was valid when the file was written.
fn is_cut_off(bytes: &[u8]) -> bool {
    let stated = || {
        let start = superblock(bytes)?;
        let (size_at, base_at) = match bytes.get(start + 8)? {
            0 => (13, 24),
            1 => (13, 28),
            _ => (9, 12),
        };
        let size = usize::from(*bytes.get(start + size_at)?);
        let word = |at: usize| {
            let word = bytes.get(start + at..start + at + size)?;
            Some(word.iter().rev().fold(0_u64, |word, byte| (word << 8) | u64::from(*byte)))
        };
        Some((word(base_at + 2 * size)?.saturating_sub(word(base_at)?), (bytes.len() - start) as u64))
    };
    stated().is_some_and(|(stated, there)| stated > there)
}

/// Returns an error if a file of this `length` takes more memory than is left. Files hardly larger in memory than on the
/// disk are not asked about.
fn expect_room(needed: u64, length: usize) -> Result<(), Hdf5Error> {
    let room = || Budget::of_process().map_or(u64::MAX, |budget| budget.bytes);
    if needed > UNPACKED.saturating_mul(length as u64) && needed > room() {
        return Err(Hdf5Error::NoRoom { needed, room: room() });
    }
    Ok(())
}

/// A file, and its length in bytes.
pub(super) struct File {
    content: Hdf5File,
    length: usize,
    /// The bytes of memory requested so far.
    requested: Cell<u64>,
}

impl File {
    /// Opens the file with these `bytes`.
    pub(super) fn open(bytes: &[u8]) -> Result<Self, Hdf5Error> {
        if is_cut_off(bytes) {
            let what = "the file is shorter than it says, as where a transfer was cut off";
            return Err(Hdf5Error::Damaged { what: what.to_string() });
        }
        Ok(File { content: Hdf5File::from_bytes(bytes)?, length: bytes.len(), requested: Cell::new(0) })
    }

    /// Returns the length of the file, bytes.
    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// Adds `bytes` to the memory in use. Returns an error if there is not enough memory for the total.
    pub(super) fn take_room(&self, bytes: u64) -> Result<(), Hdf5Error> {
        let needed = self.requested.get().saturating_add(bytes);
        self.requested.set(needed);
        expect_room(needed, self.length)
    }

    /// Returns `true` if there is a group or a dataset at `path`, whose names are separated by `/`.
    pub(super) fn has(&self, path: &str) -> Result<bool, Hdf5Error> {
        Ok(self.dataset(path)?.is_some() || error::found(self.content.group(path))?.is_some())
    }

    /// Returns the dataset at `path`, if any. Its values are read on request.
    pub(super) fn dataset(&self, path: &str) -> Result<Option<Dataset>, Hdf5Error> {
        let Some(values) = error::found(self.content.dataset(path))? else { return Ok(None) };
        let count = usize::try_from(values.num_elements()?).unwrap_or(usize::MAX);
        let header = self.content.get_or_parse_header(values.address())?;
        let is_nowhere = |message: &HdfMessage| match message {
            HdfMessage::DataLayout(layout) => match layout.layout {
                DataLayout::Contiguous { address, .. } | DataLayout::Chunked { address, .. } => {
                    hdf5_reader::io::Cursor::is_undefined_offset(address, self.content.superblock().offset_size)
                }
                DataLayout::Compact { .. } => false,
            },
            _ => false,
        };
        let is_written = count == 0 || !header.messages.iter().any(is_nowhere);
        Ok(Some(Dataset {
            has_fill: values.fill_value().is_some_and(|fill| fill.value.is_some()),
            values,
            count,
            is_written,
            length: self.length,
        }))
    }
}

/// A dataset, whose values are read on request.
pub(crate) struct Dataset {
    values: hdf5_reader::Dataset,
    /// The number of elements.
    count: usize,
    is_written: bool,
    /// `true` if the file defines the value of unwritten elements.
    has_fill: bool,
    /// The length of the file, bytes.
    length: usize,
}

impl Dataset {
    /// Returns the number of elements.
    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Returns `true` if the dataset was ever written. A dataset without elements counts as written.
    pub(crate) fn is_written(&self) -> bool {
        self.is_written
    }

    /// Returns the bytes of all elements, if there is memory for them.
    fn bytes(&self) -> Result<Vec<u8>, Hdf5Error> {
        expect_room(self.values.raw_byte_len()? as u64, self.length)?;
        Ok(self.values.read_raw_bytes()?)
    }

    /// Returns the `first` elements of `size` bytes in this order, the lowest byte first.
    fn elements(&self, first: usize, size: u8, order: ByteOrder) -> Result<Vec<[u8; 8]>, Hdf5Error> {
        if !self.is_written && !self.has_fill {
            return Err(Hdf5Error::NotWritten);
        }
        let element = |bytes: &[u8]| {
            let mut element = [0; 8];
            element.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
            if order == ByteOrder::BigEndian {
                element[..bytes.len().min(8)].reverse();
            }
            element
        };
        Ok(self.bytes()?.chunks_exact(usize::from(size)).take(first).map(element).collect())
    }

    /// Returns the `first` values of a dataset of integers.
    pub(crate) fn integers(&self, first: usize) -> Result<Vec<i64>, Hdf5Error> {
        let Datatype::FixedPoint { size: size @ (1 | 2 | 4 | 8), signed, byte_order } = *self.values.dtype() else {
            return Err(self.of_type("integers"));
        };
        self.expect_format(&[0, 0, 8 * size, 0], "integers of all their bits")?;
        let unused = 64 - 8 * u32::from(size);
        let integer = |bytes: [u8; 8]| {
            let number = i64::from_le_bytes(bytes);
            if signed { number << unused >> unused } else { number }
        };
        Ok(self.elements(first, size, byte_order)?.into_iter().map(integer).collect())
    }

    /// Returns the `first` values of a dataset of numbers, including integers.
    pub(crate) fn numbers(&self, first: usize) -> Result<Vec<f64>, Hdf5Error> {
        let single = |[a, b, c, d, ..]: [u8; 8]| f64::from(f32::from_le_bytes([a, b, c, d]));
        let elements = |size, byte_order| self.elements(first, size, byte_order).map(Vec::into_iter);
        match *self.values.dtype() {
            Datatype::FloatingPoint { size: 8, byte_order } => {
                self.expect_format(&DOUBLE, IEEE)?;
                Ok(elements(8, byte_order)?.map(f64::from_le_bytes).collect())
            }
            Datatype::FloatingPoint { size: 4, byte_order } => {
                self.expect_format(&SINGLE, IEEE)?;
                Ok(elements(4, byte_order)?.map(single).collect())
            }
            Datatype::FixedPoint { .. } => Ok(self.integers(first)?.into_iter().map(|number| number as f64).collect()),
            _ => Err(self.of_type(IEEE)),
        }
    }

    /// Returns an error unless the bits of a number are as the properties `format` of its datatype say.
    fn expect_format(&self, format: &[u8], expected: &'static str) -> Result<(), Hdf5Error> {
        let datatype = self.values.raw_datatype()?;
        let is_standard = datatype.get(PROPERTIES..).is_some_and(|properties| properties.starts_with(format));
        if is_standard { Ok(()) } else { Err(self.of_type(expected)) }
    }

    /// Returns the text of a dataset of one text of fixed length, without what follows a 0, if it is no longer than the file.
    /// Invalid UTF-8 is replaced.
    pub(crate) fn text(&self) -> Result<Option<String>, Hdf5Error> {
        let is_text = matches!(self.values.dtype(), Datatype::String { size: StringSize::Fixed(_), .. });
        if !self.is_written || !is_text || self.values.raw_byte_len()? > self.length {
            return Ok(None);
        }
        let bytes = self.bytes()?;
        let text = bytes.split(|byte| *byte == 0).next().unwrap_or_default();
        Ok(Some(String::from_utf8_lossy(text).trim_end().to_string()))
    }

    fn of_type(&self, expected: &'static str) -> Hdf5Error {
        let found = match self.values.dtype() {
            Datatype::FixedPoint { size, .. } => format!("integers in {size} bytes"),
            Datatype::FloatingPoint { size, .. } => format!("floating-point numbers in {size} bytes"),
            Datatype::String { .. } => "text".to_string(),
            _ => "elements of another kind".to_string(),
        };
        Hdf5Error::Type { found, expected }
    }
}
