//! Numbers at addresses: never beyond the end of what there is.

use super::Hdf5Error;

/// How many bytes addresses and lengths take in a file.
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

/// All bytes of a file, and a place in them, from which it reads to an end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    all: &'a [u8],
    /// Where the addresses of the file count from.
    base: usize,
    place: usize,
    end: usize,
    pub(super) sizes: Sizes,
}

impl<'a> Bytes<'a> {
    pub(super) fn new(all: &'a [u8], base: usize, sizes: Sizes) -> Self {
        Bytes { all, base, place: base, end: all.len(), sizes }
    }

    /// The bytes from an address of the file on, to its end.
    pub(super) fn at(self, address: u64) -> Result<Self, Hdf5Error> {
        let place = usize::try_from(address).ok().and_then(|address| address.checked_add(self.base));
        match place {
            Some(place) if place <= self.all.len() => Ok(Bytes { place, end: self.all.len(), ..self }),
            _ => Err(self.damaged("an address is beyond the end of the file")),
        }
    }

    /// The next `length` bytes alone.
    pub(super) fn part(&mut self, length: usize) -> Result<Self, Hdf5Error> {
        let place = self.place;
        self.skip(length)?;
        Ok(Bytes { place, end: self.place, ..*self })
    }

    /// The address of the next byte.
    pub(super) fn address(&self) -> u64 {
        (self.place - self.base) as u64
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.end - self.place
    }

    /// How many bytes the file has.
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

    /// An unsigned number of `size` bytes, at most eight.
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

    /// An address.
    pub(super) fn offset(&mut self) -> Result<u64, Hdf5Error> {
        self.number(self.sizes.offsets)
    }

    /// A length, which is at most that of the file where it is one of stored bytes.
    pub(super) fn length(&mut self) -> Result<u64, Hdf5Error> {
        self.number(self.sizes.lengths)
    }

    /// Whether `address` is the one that stands for none: all bits set.
    pub(super) fn is_undefined(&self, address: u64) -> bool {
        address == u64::MAX >> (64 - 8 * self.sizes.offsets)
    }

    /// An error unless this `signature` is next.
    pub(super) fn expect(&mut self, signature: &[u8], what: &'static str) -> Result<(), Hdf5Error> {
        let at = self.place;
        if self.take(signature.len())? == signature { Ok(()) } else { Err(Hdf5Error::Damaged { at, what }) }
    }
}
