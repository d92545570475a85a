//! A folder for the files of one run: locked, and published all at once.
//!
//! New files are written under hidden names. They replace older files by renaming, all at once when the first results
//! are complete. So a reader never sees half a file or a mixture of two runs, and the next process can resume, however
//! this one ends. File names are relative to the opened folder, and links are never followed.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::fd::{AsRawFd, OwnedFd};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use rustix::fs::{
    AtFlags, CWD, Dir, FileType, FlockOperation, Mode, OFlags, flock, fstat, fsync, openat, renameat, stat, statat,
    unlinkat,
};
use rustix::io::Errno;

use super::names::CHECKPOINT;

/// The file that marks a result folder. The writing process holds its lock.
pub(super) const MARKER: &str = ".stickslip";

/// The first line of a table is no longer, bytes.
const LONGEST_LINE: u64 = 1 << 20;

const READ: Mode = Mode::from_raw_mode(0o666);

/// A folder, by a handle that remains valid if the folder is moved.
#[derive(Debug)]
pub(super) struct Directory {
    pub path: PathBuf,
    handle: OwnedFd,
}

/// The folder of a run, locked against other writers.
#[derive(Debug)]
pub(super) struct Locked {
    pub directory: Directory,
    /// The marker, locked.
    _marker: File,
    /// `true` if the folder, and `true` if the marker, did not exist before.
    is_new: [bool; 2],
    /// Files written under their hidden names only.
    staged: Vec<String>,
    /// `true` if the files have their own names.
    pub is_published: bool,
    /// Files written since the last synchronisation with the disk.
    unsynced: Vec<String>,
}

impl Directory {
    /// Opens a folder.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        Ok(Directory { path: path.to_path_buf(), handle: openat(CWD, path, flags, Mode::empty())? })
    }

    /// Returns the present path if the folder was moved while open.
    pub(super) fn moved_to(&self) -> Option<PathBuf> {
        let own = fstat(&self.handle).ok()?;
        if own.st_nlink == 0 || stat(&self.path).is_ok_and(|at| (at.st_dev, at.st_ino) == (own.st_dev, own.st_ino)) {
            return None;
        }
        fs::read_link(format!("/proc/self/fd/{}", self.handle.as_raw_fd())).ok()
    }

    /// Locks the folder by its handle only. Some file systems cannot lock folders.
    pub(super) fn lock(&self) -> io::Result<()> {
        match flock(&self.handle, FlockOperation::NonBlockingLockExclusive) {
            Err(Errno::WOULDBLOCK) => Err(busy()),
            _ => Ok(()),
        }
    }

    /// Returns the names of all entries, each with `true` for a folder.
    pub(super) fn names(&self) -> io::Result<Vec<(String, bool)>> {
        let mut names = Vec::new();
        for entry in Dir::read_from(&self.handle)? {
            let entry = entry?;
            if let Ok(name) = entry.file_name().to_str()
                && name != "."
                && name != ".."
            {
                let kind = statat(&self.handle, name, AtFlags::SYMLINK_NOFOLLOW)
                    .map(|stat| FileType::from_raw_mode(stat.st_mode));
                names.push((name.to_string(), kind == Ok(FileType::Directory)));
            }
        }
        Ok(names)
    }

    /// Creates a file and replaces an existing one.
    pub(super) fn create(&self, name: &str) -> io::Result<File> {
        plain(name)?;
        self.remove(name)?;
        let flags = OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::CLOEXEC;
        let file = openat(&self.handle, name, flags, READ).map_err(|error| self.explain(error.into()))?;
        Ok(file.into())
    }

    /// Opens an existing file, or creates it if `creates`, for reading and writing.
    pub(super) fn edit(&self, name: &str, creates: bool) -> io::Result<File> {
        plain(name)?;
        let create = if creates { OFlags::CREATE } else { OFlags::empty() };
        let flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC | create;
        self.opened(name, flags)
    }

    /// Opens an existing file for reading.
    pub(super) fn read(&self, name: &str) -> io::Result<File> {
        plain(name)?;
        let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
        self.opened(name, flags)
    }

    /// Opens a regular file; fails for any other type of entry.
    fn opened(&self, name: &str, flags: OFlags) -> io::Result<File> {
        let file: File = match openat(&self.handle, name, flags, READ) {
            // A link, a pipe without a reader, or a folder.
            Err(Errno::LOOP | Errno::NXIO | Errno::ISDIR) => return Err(self.in_the_way(name)),
            opened => opened.map_err(|error| self.explain(error.into()))?.into(),
        };
        if file.metadata()?.is_file() { Ok(file) } else { Err(self.in_the_way(name)) }
    }

    /// Returns the error for an entry with the name of a result file that is no regular file.
    pub(super) fn in_the_way(&self, name: &str) -> io::Error {
        let message = format!("{} exists, but is no regular file: remove it", self.path.join(name).display());
        io::Error::new(io::ErrorKind::AlreadyExists, message)
    }

    /// Returns `true` if the first line of a file contains `columns`.
    fn begins(&self, name: &str, columns: &str) -> bool {
        let mut line = Vec::new();
        let read =
            self.read(name).and_then(|file| BufReader::new(file).take(LONGEST_LINE).read_until(b'\n', &mut line));
        read.is_ok() && String::from_utf8_lossy(&line).contains(columns)
    }

    /// Returns the error for a result file that this program did not write.
    pub(super) fn not_written_here(&self, name: &str) -> io::Error {
        let message = format!("{} already exists, and was not written by stickslip", self.path.join(name).display());
        io::Error::new(io::ErrorKind::AlreadyExists, message)
    }

    /// Returns the length of a file, bytes.
    pub(super) fn length(&self, name: &str) -> io::Result<u64> {
        Ok(self.read(name)?.metadata()?.len())
    }

    /// Renames a file and replaces an existing one.
    pub(super) fn rename(&self, from: &str, to: &str) -> io::Result<()> {
        plain(to)?;
        match renameat(&self.handle, from, &self.handle, to) {
            // The files go before their folder.
            Err(Errno::NOENT) => Err(removed()),
            renamed => renamed.map_err(|error| self.explain(error.into())),
        }
    }

    /// Removes a file if it exists.
    pub(super) fn remove(&self, name: &str) -> io::Result<()> {
        match unlinkat(&self.handle, name, AtFlags::empty()) {
            Err(Errno::NOENT) => Ok(()),
            removed => Ok(removed?),
        }
    }

    /// Writes a whole file. A reader never sees half of it.
    pub(super) fn write(&self, name: &str, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        let partial = partial(name);
        let written = self.create(&partial).and_then(|mut file| write(&mut file));
        let written = written.and_then(|()| self.rename(&partial, name));
        if written.is_err() {
            // The remains of a failed write are useless. A failure to remove them is no second error.
            let _ = self.remove(&partial);
        }
        written
    }

    /// Writes the names of files to the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        ignore_unsupported(fsync(&self.handle).map_err(io::Error::from))
    }

    /// Extends an error if the folder has been removed.
    fn explain(&self, error: io::Error) -> io::Error {
        if fstat(&self.handle).is_ok_and(|stat| stat.st_nlink == 0) {
            return removed();
        }
        error
    }
}

/// Returns the error for a folder that was removed.
fn removed() -> io::Error {
    io::Error::new(io::ErrorKind::NotFound, "the folder was removed while results were written")
}

impl Locked {
    /// Opens the folder, creates it if necessary, and locks it. `may_take` decides whether a folder without a marker
    /// may be used, by the names in it.
    pub(super) fn open(path: &Path, may_take: impl FnOnce(&Directory) -> io::Result<()>) -> io::Result<Self> {
        if path.exists() && !path.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        let new_folder = !path.exists();
        fs::create_dir_all(path)?;
        let directory = Directory::open(path)?;
        directory.lock()?;
        let new_marker = match directory.edit(MARKER, false) {
            Ok(_) => false,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                may_take(&directory)?;
                true
            }
            Err(error) => return Err(error),
        };
        let marker = directory.edit(MARKER, true)?;
        lock(&marker, busy)?;
        // Its earlier owner may have removed it in the meantime.
        let here = statat(&directory.handle, MARKER, AtFlags::SYMLINK_NOFOLLOW).map(|stat| stat.st_ino);
        if here != fstat(&marker).map(|stat| stat.st_ino) {
            return Err(busy());
        }
        let (staged, unsynced) = (Vec::new(), Vec::new());
        let mut locked = Locked {
            directory,
            _marker: marker,
            is_new: [new_folder, new_marker],
            staged,
            is_published: false,
            unsynced,
        };
        locked.sweep()?;
        Ok(locked)
    }

    /// Removes unpublished files of an earlier run that was interrupted.
    fn sweep(&mut self) -> io::Result<()> {
        let names = self.directory.names()?;
        let is_partial = |name: &str| name.starts_with('.') && name.ends_with(".partial");
        let left = names.iter().filter(|(name, is_folder)| !is_folder && is_partial(name));
        left.into_iter().try_for_each(|(name, _)| self.directory.remove(name))
    }

    /// Publishes all files under their own names and removes those for which `is_old`. Files for which `is_head` are
    /// removed first, because by these readers know that a result is complete, or which files belong together; of these
    /// first the checkpoint, which promises the others to the next run.
    pub(super) fn publish(&mut self, is_head: impl Fn(&str) -> bool, is_old: impl Fn(&str) -> bool) -> io::Result<()> {
        if std::mem::replace(&mut self.is_published, true) {
            return Ok(());
        }
        self.sync_files()?;
        self.directory.remove(CHECKPOINT)?;
        let mut heads = self.directory.names()?.into_iter().filter(|(name, is_folder)| !is_folder && is_head(name));
        heads.try_for_each(|(name, _)| self.directory.remove(&name))?;
        let staged = std::mem::take(&mut self.staged);
        for name in &staged {
            self.directory.rename(&partial(name), name)?;
        }
        for (name, is_folder) in self.directory.names()? {
            if !is_folder && is_old(&name) && !staged.contains(&name) {
                self.directory.remove(&name)?;
            }
        }
        Ok(())
    }

    /// Creates a file that grows.
    pub(super) fn table(&mut self, name: &str) -> io::Result<File> {
        plain(name)?;
        if self.is_published {
            return self.directory.create(name);
        }
        self.staged.push(name.to_string());
        self.directory.create(&partial(name))
    }

    /// Writes a whole file.
    pub(super) fn write(&mut self, name: &str, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        self.put(name, write)?;
        self.note(name);
        Ok(())
    }

    /// Writes whole files in parallel, each from the value beside its name.
    pub(super) fn write_each<T: Sync>(
        &mut self,
        files: &[(String, T)],
        write: impl Fn(&T, &mut File) -> io::Result<()> + Sync,
    ) -> io::Result<()> {
        files.par_iter().try_for_each(|(name, from)| self.put(name, |file| write(from, file)))?;
        for (name, _) in files {
            self.note(name);
        }
        Ok(())
    }

    /// Writes a whole file, under its own name if the folder is published.
    fn put(&self, name: &str, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        plain(name)?;
        if self.is_published {
            return self.directory.write(name, write);
        }
        write(&mut self.directory.create(&partial(name))?)
    }

    /// Records that a file must still be synchronised and published.
    fn note(&mut self, name: &str) {
        let lists = [Some(&mut self.unsynced), (!self.is_published).then_some(&mut self.staged)];
        for list in lists.into_iter().flatten() {
            if !list.iter().any(|other| other == name) {
                list.push(name.to_string());
            }
        }
    }

    /// Writes all whole files to the disk that were written since the last synchronisation.
    pub(super) fn sync_files(&mut self) -> io::Result<()> {
        for name in std::mem::take(&mut self.unsynced) {
            let name = if self.staged.contains(&name) { partial(&name) } else { name };
            ignore_unsupported(self.directory.read(&name)?.sync_data())?;
        }
        Ok(())
    }
}

impl Drop for Locked {
    /// Removes unpublished files, and the folder if it is new and otherwise empty.
    fn drop(&mut self) {
        if self.is_published {
            return;
        }
        // An error cannot be reported here, and the next run removes the same files.
        let _ = self.sweep();
        if self.is_new[1] {
            let _ = self.directory.remove(MARKER);
        }
        if self.is_new[0] {
            let _ = fs::remove_dir(&self.directory.path);
        }
    }
}

/// Locks a file. Some network file systems have no locks.
fn lock(file: &File, busy: impl FnOnce() -> io::Error) -> io::Result<()> {
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(Errno::WOULDBLOCK) => Err(busy()),
        locked => ignore_unsupported(locked.map_err(io::Error::from)),
    }
}

fn busy() -> io::Error {
    let message = "another run is writing into this folder; wait for it, or choose another one";
    io::Error::new(io::ErrorKind::ResourceBusy, message)
}

/// Returns the hidden name under which a file is written.
fn partial(name: &str) -> String {
    format!(".{name}.partial")
}

/// Returns an error for a name that would leave the folder.
fn plain(name: &str) -> io::Result<()> {
    if name.is_empty() || name == "." || name == ".." || name.contains(['/', '\0']) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("`{name}` is not a valid file name")));
    }
    Ok(())
}

/// Ignores the error of file systems without locks or synchronisation.
pub(super) fn ignore_unsupported(done: io::Result<()>) -> io::Result<()> {
    match done {
        Err(error) if matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput) => Ok(()),
        done => done,
    }
}

/// A folder with tables of several runs, locked against other writers as long as this value exists.
#[derive(Debug)]
pub struct FolderLock {
    /// Holds the lock.
    _directory: Directory,
}

impl FolderLock {
    /// Creates the folder if necessary, and locks it. `files` are those that will be written. The first one is a table;
    /// an earlier one is known by `columns`, which its first line contains.
    ///
    /// # Errors
    /// When the folder cannot be created, when another command writes there ([`io::ErrorKind::ResourceBusy`]), and when
    /// it contains files of these names that no command of this program wrote.
    pub fn new(path: &Path, files: &[&str], columns: &str) -> io::Result<Self> {
        fs::create_dir_all(path)?;
        let directory = Directory::open(path)?;
        directory.lock()?;
        let names = directory.names()?;
        let there = names.iter().find(|(name, is_folder)| !is_folder && files.contains(&name.as_str()));
        if let (Some((name, _)), Some(table)) = (there, files.first())
            && !directory.begins(table, columns)
        {
            return Err(directory.not_written_here(name));
        }
        Ok(FolderLock { _directory: directory })
    }
}

/// Writes a whole file into a folder. A reader never sees half of it.
///
/// # Errors
/// When the disk refuses.
pub fn write_file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> io::Result<()> {
    Directory::open(folder)?.write(name, |file| {
        file.write_all(content.as_ref())?;
        ignore_unsupported(file.sync_data())
    })
}

/// A lock of one file against other writers, as long as this value exists: a hidden file beside it.
#[derive(Debug)]
pub struct FileLock {
    directory: Directory,
    name: String,
    _file: File,
}

impl FileLock {
    /// Locks the file `name` of `folder`, whether it exists or not.
    ///
    /// # Errors
    /// When the folder does not exist or cannot be written, and when another owner has the lock
    /// ([`io::ErrorKind::ResourceBusy`]).
    pub fn new(folder: &Path, name: &str) -> io::Result<Self> {
        let directory = Directory::open(folder)?;
        let name = format!(".{name}.lock");
        let file = directory.edit(&name, true)?;
        lock(&file, || io::Error::new(io::ErrorKind::ResourceBusy, "another run writes this file"))?;
        Ok(FileLock { directory, name, _file: file })
    }
}

impl Drop for FileLock {
    fn drop(&mut self) {
        // A lock file that remains hinders nobody.
        let _ = self.directory.remove(&self.name);
    }
}
