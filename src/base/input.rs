//! Reading of input files: scenes, meshes, tables.

mod kind;

pub(crate) use kind::FileKind;

use std::cell::RefCell;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::base::memory::{Budget, in_words};

/// The contents of files by their paths, as named in a scene.
pub type Contents = HashMap<PathBuf, Vec<u8>>;

thread_local! {
    /// The contents that this thread reads instead of files.
    static IN_MEMORY: RefCell<Contents> = RefCell::default();
}

/// Runs `work`, which reads the files in `contents` from memory, whatever the disk has now. It is used for results
/// that are loaded again.
pub fn with_contents<T>(contents: Contents, work: impl FnOnce() -> T) -> T {
    /// Restores the earlier contents, even after a panic.
    struct Before(Contents);
    impl Drop for Before {
        fn drop(&mut self) {
            IN_MEMORY.set(std::mem::take(&mut self.0));
        }
    }
    let _before = Before(IN_MEMORY.replace(contents));
    work()
}

/// Reads the bytes of the file at `path`, without a UTF-8 byte order mark. Pipes and devices are refused: a pipe may
/// have no writer, and can be read only once, while a file is read again for its fingerprint; a device may have no
/// end.
///
/// # Errors
/// If the file cannot be read, is no regular file, or is too large.
pub fn read_bytes(path: &Path) -> io::Result<Vec<u8>> {
    if let Some(bytes) = IN_MEMORY.with_borrow(|contents| contents.get(path).cloned()) {
        return Ok(bytes);
    }
    // The type is checked first, because opening a special file may block or have side effects.
    let kind = std::fs::metadata(path)?.file_type();
    if kind.is_dir() {
        return Err(io::Error::other("it is a folder"));
    }
    if !kind.is_file() {
        return Err(io::Error::other("it is a device or a pipe, not a file"));
    }
    whole(path)
}

/// The largest content, bytes, beyond the size that the system gives: it gives 0 for a pipe and for files of its own.
const MAX_UNDECLARED: u64 = 1 << 24;

fn whole(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let size = file.metadata()?.len();
    if let Some(Budget { bytes, source }) = Budget::of_process().filter(|budget| size > budget.bytes) {
        let [size, left] = [size, bytes].map(in_words);
        return Err(io::Error::other(format!("it has {size}, but {source} leaves {left}: {}", source.remedy())));
    }
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size as usize)?;
    if file.take(size + MAX_UNDECLARED).read_to_end(&mut bytes)? as u64 == size + MAX_UNDECLARED {
        return Err(io::Error::other(format!("it does not end within {}", in_words(size + MAX_UNDECLARED))));
    }
    if bytes.starts_with("\u{feff}".as_bytes()) {
        bytes.drain(..3);
    }
    Ok(bytes)
}

/// Reads the text of the file at `path`, as [`bytes`] does.
pub(crate) fn text(path: &Path) -> io::Result<String> {
    of_utf8(read_bytes(path)?)
}

/// Reads the text of a file, or of a pipe without a name, which a process has opened, for paths named on the command
/// line.
pub(crate) fn text_or_pipe(path: &Path) -> io::Result<String> {
    of_utf8(if is_pipe(path)? { whole(path)? } else { read_bytes(path)? })
}

fn of_utf8(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|_| io::Error::other("it is not a text in UTF-8"))
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::FileTypeExt;
    // A pipe with a name may have no writer, ever.
    Ok(std::fs::metadata(path)?.file_type().is_fifo() && path.canonicalize().is_err())
}

#[cfg(not(unix))]
fn is_pipe(_: &Path) -> io::Result<bool> {
    Ok(false)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A file that tells no size, or more than the memory that is left, is refused before it is read.
    #[cfg(target_os = "linux")]
    #[test]
    fn files_without_an_end_are_refused() {
        let said = |path: &Path| text_or_pipe(path).unwrap_err().to_string();
        assert!(said(Path::new("/proc/self/pagemap")).contains("does not end within"));
        let file = std::env::temp_dir().join(format!("stickslip-sparse-{}", std::process::id()));
        File::create(&file).unwrap().set_len(1 << 43).unwrap();
        let sparse = said(&file);
        std::fs::remove_file(&file).unwrap();
        assert!(sparse.starts_with("it has 8796.1 GB, but "), "{sparse}");
        // A pipe may have no writer.
        assert!(std::process::Command::new("mkfifo").arg(&file).status().unwrap().success());
        let pipe = said(&file);
        std::fs::remove_file(&file).unwrap();
        assert!(pipe.contains("a pipe"), "{pipe}");
    }

    #[test]
    fn files_in_memory_are_read_in_place_of_those_on_the_disk_while_the_work_lasts() {
        let (own, other) = (Path::new("Cargo.toml"), Path::new("rustfmt.toml"));
        let on_disk = [read_bytes(own).unwrap(), read_bytes(other).unwrap()];
        let contents = |text: &str| Contents::from([(own.to_path_buf(), text.as_bytes().to_vec())]);
        with_contents(contents("outer"), || {
            assert_eq!(read_bytes(own).unwrap(), b"outer");
            assert_eq!(read_bytes(other).unwrap(), on_disk[1]);
            let panicked =
                std::panic::catch_unwind(|| with_contents(contents("inner"), || panic!("{}", text(own).unwrap())));
            assert_eq!(panicked.unwrap_err().downcast_ref::<String>().unwrap(), "inner");
            assert_eq!(text(own).unwrap(), "outer");
        });
        assert_eq!(read_bytes(own).unwrap(), on_disk[0]);
    }
}
