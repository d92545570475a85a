//! The files that people name: scenes, meshes, tables.

mod kind;

pub(crate) use kind::FileKind;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The bytes of the file at `path`, without the mark that some editors put before UTF-8. A pipe may have nobody who writes, and gives what
/// it has only once, while a file is read again for its fingerprint; a device may have no end.
pub(crate) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    // Asked before it is opened, because opening what is none may wait, or do something.
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(io::Error::other("it is a folder"));
    }
    if !kind.is_file() {
        return Err(io::Error::other("it is a device or a pipe, not a file"));
    }
    whole(path)
}

fn whole(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.read_to_end(&mut bytes)?;
    if bytes.starts_with("\u{feff}".as_bytes()) {
        bytes.drain(..3);
    }
    Ok(bytes)
}

/// The text of the file at `path`, as [`bytes`].
pub(crate) fn text(path: &Path) -> io::Result<String> {
    of_utf8(bytes(path)?)
}

/// The same of a file or a pipe, which is what people name on the command line.
pub(crate) fn text_or_pipe(path: &Path) -> io::Result<String> {
    of_utf8(if is_pipe(path)? { whole(path)? } else { bytes(path)? })
}

fn of_utf8(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|_| io::Error::other("it is not a text in UTF-8"))
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::FileTypeExt;
    Ok(std::fs::metadata(path)?.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(_: &Path) -> io::Result<bool> {
    Ok(false)
}
