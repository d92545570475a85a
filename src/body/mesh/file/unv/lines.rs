//! The lines of a universal file and its datasets, with their places for messages.

use std::borrow::Cow;
use std::str::FromStr;

use crate::body::mesh::file::raw::shortened;
use crate::body::mesh::file::{MeshFormatError, Place};

const AGAIN: &str = "export the mesh again as UNV";
const CUT: &str = "the file is cut off: export or copy it again";

/// The line before and after each dataset.
const DELIMITER: &str = "-1";

/// A reader of the lines of a file from its beginning to its end.
pub(super) struct Lines<'a> {
    file: &'a str,
    rest: &'a [u8],
    /// The number of the last line read, from 1.
    pub(super) line: usize,
    /// The number of the dataset that is read.
    dataset: String,
}

impl<'a> Lines<'a> {
    pub(super) fn new(file: &'a str, bytes: &'a [u8]) -> Self {
        Lines { file, rest: bytes, line: 0, dataset: String::new() }
    }

    /// Returns the next line without its end.
    fn next(&mut self) -> Option<Cow<'a, str>> {
        if self.rest.is_empty() {
            return None;
        }
        let length = self.rest.iter().position(|&byte| byte == b'\n').map_or(self.rest.len(), |end| end + 1);
        let (line, rest) = self.rest.split_at(length);
        self.rest = rest;
        self.line += 1;
        Some(String::from_utf8_lossy(line.trim_ascii_end()))
    }

    fn next_filled(&mut self) -> Option<Cow<'a, str>> {
        std::iter::from_fn(|| self.next()).find(|line| !line.trim().is_empty())
    }

    /// Goes to the next dataset and returns its number; `None` at the end of the file.
    pub(super) fn dataset(&mut self) -> Result<Option<String>, MeshFormatError> {
        let Some(line) = self.next_filled() else { return Ok(None) };
        if line.trim() != DELIMITER {
            let line = shortened(&line);
            return Err(self.damaged(format!("a dataset, which begins with -1, was expected, but there is `{line}`")));
        }
        let Some(line) = self.next_filled() else {
            return Err(self.error("the file ends before the number of a dataset", CUT));
        };
        // 58b and others have binary data, which a header describes.
        let number = line.split_whitespace().next().unwrap_or_default();
        if !number.trim_end_matches('b').bytes().all(|digit| digit.is_ascii_digit()) {
            let message = format!("the number of a dataset was expected, but there is `{}`", shortened(&line));
            return Err(self.damaged(message));
        }
        self.dataset = number.to_string();
        Ok(Some(self.dataset.clone()))
    }

    /// Returns the next line of the dataset that is not empty; `None` at its end.
    pub(super) fn record(&mut self) -> Result<Option<Cow<'a, str>>, MeshFormatError> {
        match self.next_filled() {
            None => Err(self.ends()),
            Some(line) if line.trim() == DELIMITER => Ok(None),
            Some(line) => Ok(Some(line)),
        }
    }

    /// Returns the next line of a record that has begun, where `what` is expected.
    pub(super) fn more(&mut self, what: &str) -> Result<Cow<'a, str>, MeshFormatError> {
        self.record()?.ok_or_else(|| self.malformed(what))
    }

    /// Returns the next line, which may be empty, as a name.
    pub(super) fn name(&mut self) -> Result<String, MeshFormatError> {
        self.next().map(|line| line.trim().to_string()).ok_or_else(|| self.ends())
    }

    /// Reads the numbers of a line, where `what` is expected.
    pub(super) fn numbers<T: FromStr>(&self, line: &str, what: &str) -> Result<Vec<T>, MeshFormatError> {
        line.split_whitespace().map(|word| word.parse().map_err(|_| self.malformed(what))).collect()
    }

    /// Goes to the end of the dataset.
    pub(super) fn skip(&mut self) -> Result<(), MeshFormatError> {
        while self.record()?.is_some() {}
        Ok(())
    }

    fn ends(&self) -> MeshFormatError {
        self.error(format!("the file ends within the dataset {}", self.dataset), CUT)
    }

    /// Creates an error at the line that was read last.
    pub(super) fn error(&self, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        self.error_at(self.line, message, help)
    }

    /// Creates an error at a `line`.
    pub(super) fn error_at(&self, line: usize, message: impl Into<String>, help: impl Into<String>) -> MeshFormatError {
        MeshFormatError::new(self.file, Place::Line(line.max(1)), message, help)
    }

    /// Creates the error of a fault that only a new export cures.
    pub(super) fn damaged(&self, message: impl Into<String>) -> MeshFormatError {
        self.error(message, AGAIN)
    }

    /// Creates the error of a line that does not contain `what`.
    pub(super) fn malformed(&self, what: &str) -> MeshFormatError {
        self.damaged(format!("dataset {}: {what} expected in this line", self.dataset))
    }
}
