//! A table that grows by whole lines.

use std::fs::File;
use std::io::{self, Seek, SeekFrom, Write};

#[derive(Debug)]
pub(super) struct Table {
    pub name: String,
    file: File,
    /// The length of the complete lines, bytes.
    pub length: u64,
}

impl Table {
    /// Creates a table in an empty file.
    pub(super) fn new(name: &str, file: File, header: &str) -> io::Result<Self> {
        let mut table = Table { name: name.to_string(), file, length: 0 };
        table.append(header)?;
        Ok(table)
    }

    /// Resumes a table after this number of bytes, which must exist.
    pub(super) fn cut(name: &str, mut file: File, length: u64) -> io::Result<Self> {
        if file.metadata()?.len() < length {
            let message = "it is shorter than at the checkpoint; run without --resume to start a new run";
            return Err(io::Error::new(io::ErrorKind::InvalidData, message));
        }
        file.set_len(length)?;
        file.seek(SeekFrom::Start(length))?;
        Ok(Table { name: name.to_string(), file, length })
    }

    /// Appends whole lines.
    pub(super) fn append(&mut self, lines: &str) -> io::Result<()> {
        let written = self.file.write_all(lines.as_bytes());
        if written.is_err() {
            // A full disk may have taken part of the lines. The earlier ones are kept.
            let _ = self.file.set_len(self.length).and_then(|()| self.file.seek(SeekFrom::Start(self.length)));
        } else {
            self.length += lines.len() as u64;
        }
        written
    }

    /// Writes the lines to the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}
