//! The lines and numbers of a Gmsh file, text or binary, with their places for messages.

use std::borrow::Cow;
use std::str::{FromStr, SplitWhitespace};

use super::Version;
use crate::body::mesh::file::raw::shortened;
use crate::body::mesh::file::{MeshFormatError, Parsed, Place};

const AGAIN: &str = "export the mesh again from Gmsh";
const CUT: &str = "the file is cut off: export or copy it again";

/// A reader of a file from its beginning to its end. Memory is taken only for what has been read.
pub(super) struct Reader<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// The first byte that is not read yet.
    at: usize,
    /// The first byte of what was read last.
    start: usize,
    /// The number of the last line read, from 1.
    line: usize,
    /// `true` if numbers are binary.
    pub(super) binary: bool,
}

/// The numbers of a line, or of a place in a binary file, from the first to the last.
pub(super) enum Fields<'a> {
    /// The words of a line.
    Text(SplitWhitespace<'a>),
    /// The bytes up to the end of the file, little-endian.
    Bytes {
        /// The bytes not yet read.
        rest: &'a [u8],
        /// `true` if they were too few.
        ended: bool,
    },
}

impl Fields<'_> {
    fn take<T: FromStr, const N: usize>(&mut self, convert: impl Fn([u8; N]) -> T) -> Option<T> {
        match self {
            Fields::Text(words) => words.next()?.parse().ok(),
            Fields::Bytes { rest, ended } => {
                let Some((first, others)) = rest.split_first_chunk() else {
                    *ended = true;
                    return None;
                };
                *rest = others;
                Some(convert(*first))
            }
        }
    }

    /// Returns `true` in a binary file, where numbers that are not needed have to be read, too, to reach the next ones.
    pub(super) fn is_binary(&self) -> bool {
        matches!(self, Fields::Bytes { .. })
    }

    /// Returns the next integer, in a binary file of four bytes.
    pub(super) fn int(&mut self) -> Option<i64> {
        self.take(|bytes| i64::from(i32::from_le_bytes(bytes)))
    }

    /// Returns the next integer that is not negative, in a binary file of eight bytes.
    pub(super) fn size(&mut self) -> Option<usize> {
        usize::try_from(self.take(u64::from_le_bytes)?).ok()
    }

    /// Returns the next integer that is not negative, in a binary file of four bytes.
    pub(super) fn short(&mut self) -> Option<usize> {
        usize::try_from(self.int()?).ok()
    }

    /// Returns the next `N` finite numbers, in a binary file of eight bytes each.
    pub(super) fn doubles<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.take(f64::from_le_bytes).filter(|value| value.is_finite())?;
        }
        Some(values)
    }

    /// Returns the next `count` integers.
    pub(super) fn list<T>(&mut self, count: usize, one: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..count).map(|_| one(self)).collect()
    }

    /// Returns all further integers of a line, or the next `count` in a binary file.
    pub(super) fn read_all<T>(&mut self, count: usize, one: impl Fn(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let count = match self {
            Fields::Text(words) => words.clone().count(),
            Fields::Bytes { .. } => count,
        };
        self.list(count, one)
    }

    /// Returns `value` if the line has no further words.
    pub(super) fn last<T>(&mut self, value: T) -> Option<T> {
        match self {
            Fields::Text(words) => words.next().is_none().then_some(value),
            Fields::Bytes { .. } => Some(value),
        }
    }
}

impl<'a> Reader<'a> {
    pub(super) fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Reader { file, bytes, at: 0, start: 0, line: 0, binary: false }
    }

    /// Returns the next line that is not empty.
    fn advance(&mut self) -> Option<Cow<'a, str>> {
        while self.at < self.bytes.len() {
            let rest = &self.bytes[self.at..];
            let length = rest.iter().position(|&byte| byte == b'\n').map_or(rest.len(), |end| end + 1);
            (self.start, self.at) = (self.at, self.at + length);
            self.line += 1;
            let line = rest[..length].trim_ascii();
            if !line.is_empty() {
                return Some(String::from_utf8_lossy(line));
            }
        }
        None
    }

    /// Returns the next line of `section`.
    pub(super) fn next(&mut self, section: &str) -> Parsed<Cow<'a, str>> {
        match self.advance() {
            None => Err(self.ends_within(section)),
            Some(line) if line.starts_with('$') => {
                Err(self.error(format!("${section} ends before all it announces is there"), AGAIN))
            }
            Some(line) => Ok(line),
        }
    }

    /// Reads numbers from the next line of `section`, or from the next bytes of a binary file; `what` they are is for
    /// messages.
    pub(super) fn row<T>(
        &mut self,
        section: &str,
        what: &str,
        read: impl FnOnce(&mut Fields<'_>) -> Option<T>,
    ) -> Parsed<T> {
        if !self.binary {
            return self.text_row(section, what, read);
        }
        let mut fields = Fields::Bytes { rest: &self.bytes[self.at..], ended: false };
        let value = read(&mut fields);
        self.start = self.at;
        let Fields::Bytes { rest, ended } = fields else { return Err(self.malformed(section, what)) };
        self.at = self.bytes.len() - rest.len();
        match value {
            Some(value) => Ok(value),
            None if ended => Err(self.ends_within(section)),
            None => Err(self.malformed(section, what)),
        }
    }

    /// Reads numbers from the next line of `section`, which is a text also in a binary file.
    pub(super) fn text_row<T>(
        &mut self,
        section: &str,
        what: &str,
        read: impl FnOnce(&mut Fields<'_>) -> Option<T>,
    ) -> Parsed<T> {
        let line = self.next(section)?;
        read(&mut Fields::Text(line.split_whitespace())).ok_or_else(|| self.malformed(section, what))
    }

    /// Reads a number alone in the next line of `section`, or in the next bytes of a binary file.
    pub(super) fn count(&mut self, section: &str) -> Parsed<usize> {
        self.row(section, "1 whole number", |row| row.size().and_then(|count| row.last(count)))
    }

    /// Reads the numbers of blocks and of all members of `section`; MSH 4.1 has also the least and the largest number.
    pub(super) fn counts(&mut self, section: &str, version: Version) -> Parsed<(usize, usize)> {
        let (more, what) = if version == Version::V41 { (2, "4 whole numbers") } else { (0, "2 whole numbers") };
        self.row(section, what, |row| {
            let counts = (row.size()?, row.size()?);
            row.list(more, Fields::size)?;
            row.last(counts)
        })
    }

    /// Returns the next four bytes.
    pub(super) fn four_bytes(&mut self) -> Option<[u8; 4]> {
        let bytes = self.bytes[self.at..].first_chunk().copied()?;
        (self.start, self.at) = (self.at, self.at + 4);
        Some(bytes)
    }

    /// Returns the name of the next section; `None` at the end of the file.
    pub(super) fn section(&mut self) -> Parsed<Option<String>> {
        match self.advance() {
            None => Ok(None),
            Some(line) => match line.strip_prefix('$') {
                Some(name) => Ok(Some(name.to_string())),
                None => Err(self.error(
                    format!("a section was expected, but there is `{}`", shortened(&line)),
                    "export the mesh again from Gmsh: gmsh -2 part.geo -format msh41, in space -3",
                )),
            },
        }
    }

    /// Reads the end of `section`.
    pub(super) fn end(&mut self, section: &str) -> Parsed<()> {
        match self.advance() {
            Some(line) if line.strip_prefix("$End") == Some(section) => Ok(()),
            Some(line) => {
                let message = format!("$End{section} was expected, but there is `{}`", shortened(&line));
                Err(self.error(message, "export or copy the file again"))
            }
            None => Err(self.ends_within(section)),
        }
    }

    /// Skips a section that is not needed.
    pub(super) fn skip_to_end(&mut self, section: &str) -> Parsed<()> {
        if self.binary {
            let end = format!("$End{section}");
            let found = self.bytes[self.at..].windows(end.len()).position(|bytes| bytes == end.as_bytes());
            self.at = found.map_or(self.bytes.len(), |found| self.at + found);
        }
        while let Some(line) = self.advance() {
            if line.strip_prefix("$End") == Some(section) {
                return Ok(());
            }
        }
        Err(self.ends_within(section))
    }

    fn ends_within(&self, section: &str) -> MeshFormatError {
        self.error(format!("the file ends within ${section}"), CUT)
    }

    /// Creates an error at what was read last.
    pub(super) fn error(&self, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        let place = if self.binary { Place::Byte(self.start) } else { Place::Line(self.line.max(1)) };
        MeshFormatError::new(self.file, place, message, help)
    }

    /// Creates the error of a fault that only a new export cures.
    pub(super) fn damaged(&self, message: impl Into<String>) -> MeshFormatError {
        self.error(message, AGAIN)
    }

    /// Creates the error of a place in `section` that does not contain `what`.
    pub(super) fn malformed(&self, section: &str, what: &str) -> MeshFormatError {
        let here = if self.binary { "here" } else { "in this line" };
        self.damaged(format!("${section}: {what} expected {here}"))
    }
}
