//! Reads numbers at addresses, never beyond the end of the bytes.

use super::Hdf5Error;

/// The lengths of addresses and lengths in a file, bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sizes {
    pub(super) offsets: usize,
    pub(super) lengths: usize,
}

impl Default for Sizes {
    fn default() -> Self {
        Sizes { offsets: 8, lengths: 8 }
    }
}

/// All bytes of a file, with the range to be read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    /// The position of address 0.
    base: usize,
    place: usize,
    end: usize,
    pub(super) sizes: Sizes,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(all: &'a [u8], base: usize, sizes: Sizes) -> Self {
        Bytes { all, base, place: base, end: all.len(), sizes }
    }

    /// Returns the bytes from an address to the end of the file.
    pub(super) fn at(self, address: u64) -> Result<Self, Hdf5Error> {
        let place = usize::try_from(address).ok().and_then(|address| address.checked_add(self.base));
        match place {
            Some(place) if place <= self.all.len() => Ok(Bytes { place, end: self.all.len(), ..self }),
            _ => Err(self.damaged("an address is beyond the end of the file")),
        }
    }

    /// Returns the next `length` bytes alone.
    pub(super) fn part(&mut self, length: usize) -> Result<Self, Hdf5Error> {
        let place = self.place;
        self.skip(length)?;
        Ok(Bytes { place, end: self.place, ..*self })
    }

    /// Returns the address of the next byte.
    pub(super) fn address(&self) -> u64 {
        (self.place - self.base) as u64
    }

    /// Returns the number of bytes left.
    pub(super) fn left(&self) -> usize {
        self.end - self.place
    }

    /// Returns the length of the file, bytes.
    pub(super) fn file_length(&self) -> usize {
        self.all.len()
    }

    pub(super) fn damaged(&self, what: &'static str) -> Hdf5Error {
        Hdf5Error::Damaged { at: self.place, what }
    }

    pub(super) fn take(&mut self, length: usize) -> Result<&'a [u8], Hdf5Error> {
        if length > self.left() {
            return Err(self.damaged("the file ends too early"));
        }
        let taken = &self.all[self.place..self.place + length];
        self.place += length;
        Ok(taken)
    }

    pub(super) fn skip(&mut self, length: usize) -> Result<(), Hdf5Error> {
        self.take(length).map(drop)
    }

    /// Reads an unsigned number of `size` bytes, at most eight.
    pub(super) fn number(&mut self, size: usize) -> Result<u64, Hdf5Error> {
        Ok(self.take(size)?.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte)))
    }

    pub(super) fn u8(&mut self) -> Result<u8, Hdf5Error> {
        Ok(self.take(1)?[0])
    }

    pub(super) fn u16(&mut self) -> Result<usize, Hdf5Error> {
        Ok(self.number(2)? as usize)
    }

    pub(super) fn u32(&mut self) -> Result<usize, Hdf5Error> {
        Ok(self.number(4)? as usize)
    }

    /// Reads an address.
    pub(super) fn offset(&mut self) -> Result<u64, Hdf5Error> {
        self.number(self.sizes.offsets)
    }

    /// Reads a length. A length of stored bytes must not exceed that of the file.
    pub(super) fn length(&mut self) -> Result<u64, Hdf5Error> {
        self.number(self.sizes.lengths)
    }

    /// Returns `true` if `address` is undefined: all bits set.
    pub(super) fn is_undefined(&self, address: u64) -> bool {
        address == u64::MAX >> (64 - 8 * self.sizes.offsets)
    }

    /// Returns an error unless this `signature` comes next.
    pub(super) fn expect(&mut self, signature: &[u8], what: &'static str) -> Result<(), Hdf5Error> {
        let at = self.place;
        if self.take(signature.len())? == signature { Ok(()) } else { Err(Hdf5Error::Damaged { at, what }) }
    }
}
