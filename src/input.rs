//! The files that people name: scenes, meshes, tables.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The bytes of the file or pipe at `path`, without the mark that some editors put before UTF-8. A device may have no
/// end, so that none is read.
pub(crate) fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    // Asked before it is opened, because opening a device may do something.
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(io::Error::other("it is a folder"));
    }
    if is_device(kind) {
        return Err(io::Error::other("it is a device, not a file"));
    }
    let mut bytes = Vec::new();
    File::open(path)?.read_to_end(&mut bytes)?;
    if bytes.starts_with("\u{feff}".as_bytes()) {
        bytes.drain(..3);
    }
    Ok(bytes)
}

/// The text of the file or pipe at `path`, as [`bytes`].
pub(crate) fn text(path: &Path) -> io::Result<String> {
    String::from_utf8(bytes(path)?).map_err(|_| io::Error::other("it is not a text in UTF-8"))
}

#[cfg(unix)]
fn is_device(kind: std::fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: std::fs::FileType) -> bool {
    false
}
