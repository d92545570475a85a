//! A folder that holds what one run writes: locked, and published whole.
//!
//! What is new is written under hidden names and takes the place of what was there by renaming, all at once when there is
//! something to see. So a reader never meets half a file, nor a mixture of two runs; and whatever ends the process, the next one
//! can go on from what it finds. Files are named relative to the folder that was opened, and none is followed to where a
//! link points.

use std::fs::{self, File};
use std::io::{self, Write};
use std::os::fd::{AsRawFd, OwnedFd};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use rustix::fs::{
    AtFlags, CWD, Dir, FileType, FlockOperation, Mode, OFlags, flock, fstat, fsync, openat, renameat, stat, statat,
    unlinkat,
};
use rustix::io::Errno;

/// The file that says that a folder is one of results. Whoever writes there holds its lock.
pub(super) const MARKER: &str = ".stickslip";

const READ: Mode = Mode::from_raw_mode(0o666);

/// A folder, by a handle that stays with it if it is moved.
#[derive(Debug)]
pub(super) struct Directory {
    path: PathBuf,
    handle: OwnedFd,
}

/// That of a run: nobody else writes there as long as it lives.
#[derive(Debug)]
pub(super) struct Locked {
    pub directory: Directory,
    /// The marker, locked.
    _marker: File,
    /// Whether the folder, and whether the marker, was not there before.
    is_new: [bool; 2],
    /// What is written, and not yet under its name.
    staged: Vec<String>,
    is_published: bool,
    /// What was written since the last time that all was brought to the disk.
    unsynced: Vec<String>,
}

impl Directory {
    /// Opens a folder.
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::CLOEXEC;
        Ok(Directory { path: path.to_path_buf(), handle: openat(CWD, path, flags, Mode::empty())? })
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Where it is now, if it was moved from there while it was open.
    pub(super) fn moved_to(&self) -> Option<PathBuf> {
        let own = fstat(&self.handle).ok()?;
        if own.st_nlink == 0 || stat(&self.path).is_ok_and(|at| (at.st_dev, at.st_ino) == (own.st_dev, own.st_ino)) {
            return None;
        }
        fs::read_link(format!("/proc/self/fd/{}", self.handle.as_raw_fd())).ok()
    }

    /// Takes the folder for its handle alone. Some file systems know no locks of folders.
    pub(super) fn lock(&self) -> io::Result<()> {
        match flock(&self.handle, FlockOperation::NonBlockingLockExclusive) {
            Err(Errno::WOULDBLOCK) => Err(busy()),
            _ => Ok(()),
        }
    }

    /// The names of all that is there, and whether each is a folder.
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

    /// A new file, in the place of what had this name.
    pub(super) fn create(&self, name: &str) -> io::Result<File> {
        plain(name)?;
        self.remove(name)?;
        let flags = OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::CLOEXEC;
        let file = openat(&self.handle, name, flags, READ).map_err(|error| self.explain(error.into()))?;
        Ok(file.into())
    }

    /// A file that is there, or a new one where `creates`, for reading and writing.
    pub(super) fn edit(&self, name: &str, creates: bool) -> io::Result<File> {
        plain(name)?;
        let create = if creates { OFlags::CREATE } else { OFlags::empty() };
        let flags = OFlags::RDWR | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC | create;
        self.opened(name, flags)
    }

    /// A file that is there, for reading.
    pub(super) fn read(&self, name: &str) -> io::Result<File> {
        plain(name)?;
        let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
        self.opened(name, flags)
    }

    /// Opens a file, and nothing else of that name.
    fn opened(&self, name: &str, flags: OFlags) -> io::Result<File> {
        let file: File = match openat(&self.handle, name, flags, READ) {
            // A link; a pipe that nobody reads.
            Err(Errno::LOOP | Errno::NXIO | Errno::ISDIR) => return Err(self.in_the_way(name)),
            opened => opened.map_err(|error| self.explain(error.into()))?.into(),
        };
        if file.metadata()?.is_file() { Ok(file) } else { Err(self.in_the_way(name)) }
    }

    /// The error where something has the name of a file of results, and is none.
    pub(super) fn in_the_way(&self, name: &str) -> io::Error {
        let message = format!("{} is there, but is no file: remove it", self.path.join(name).display());
        io::Error::new(io::ErrorKind::AlreadyExists, message)
    }

    /// The bytes of a file.
    pub(super) fn length(&self, name: &str) -> io::Result<u64> {
        Ok(self.read(name)?.metadata()?.len())
    }

    /// Gives a file another name, in the place of what had that.
    pub(super) fn rename(&self, from: &str, to: &str) -> io::Result<()> {
        plain(to)?;
        renameat(&self.handle, from, &self.handle, to).map_err(|error| self.explain(error.into()))
    }

    /// Removes a file, if it is there.
    pub(super) fn remove(&self, name: &str) -> io::Result<()> {
        match unlinkat(&self.handle, name, AtFlags::empty()) {
            Err(Errno::NOENT) => Ok(()),
            removed => Ok(removed?),
        }
    }

    /// Writes a whole file; a reader never sees half of it.
    pub(super) fn write(&self, name: &str, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        let partial = partial(name);
        let written = self.create(&partial).and_then(|mut file| write(&mut file));
        let written = written.and_then(|()| self.rename(&partial, name));
        if written.is_err() {
            // What is left of a failed write is of no use; that it stays is no second error.
            let _ = self.remove(&partial);
        }
        written
    }

    /// Brings the names of files to the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        ignore_unsupported(fsync(&self.handle).map_err(io::Error::from))
    }

    /// An error that tells if the folder is gone.
    fn explain(&self, error: io::Error) -> io::Error {
        if fstat(&self.handle).is_ok_and(|stat| stat.st_nlink == 0) {
            return io::Error::new(io::ErrorKind::NotFound, "the folder was removed while results were written");
        }
        error
    }
}

impl Locked {
    /// Opens the folder, makes it if need be, and locks it; `may_take` says whether the names there allow it where no run has
    /// written yet.
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
        match flock(&marker, FlockOperation::NonBlockingLockExclusive) {
            Err(Errno::WOULDBLOCK) => return Err(busy()),
            // Some network file systems know no locks.
            locked => ignore_unsupported(locked.map_err(io::Error::from))?,
        }
        // Whoever had it may have removed it in between.
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

    /// Removes what an earlier run had not published when it was ended.
    fn sweep(&mut self) -> io::Result<()> {
        let names = self.directory.names()?;
        let left = names.iter().filter(|(name, is_folder)| !is_folder && is_partial(name));
        left.into_iter().try_for_each(|(name, _)| self.directory.remove(name))
    }

    /// From now on all is written under its own name, and what `is_old` is removed: first what `is_head`, by which readers know
    /// that what is there is whole, or which files belong together.
    pub(super) fn publish(&mut self, is_head: impl Fn(&str) -> bool, is_old: impl Fn(&str) -> bool) -> io::Result<()> {
        if std::mem::replace(&mut self.is_published, true) {
            return Ok(());
        }
        self.sync_files()?;
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

    /// Whether what is written has its name.
    pub(super) fn is_published(&self) -> bool {
        self.is_published
    }

    /// Goes on with what is published already.
    pub(super) fn go_on(&mut self) {
        self.is_published = true;
    }

    /// A file that grows.
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

    /// Writes whole files, each from what stands beside its name, in as many threads as there are.
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

    /// Writes a whole file, under its name if that is published.
    fn put(&self, name: &str, write: impl FnOnce(&mut File) -> io::Result<()>) -> io::Result<()> {
        plain(name)?;
        if self.is_published {
            return self.directory.write(name, write);
        }
        write(&mut self.directory.create(&partial(name))?)
    }

    /// Remembers what is still to be brought to the disk, and to its name.
    fn note(&mut self, name: &str) {
        let lists = [Some(&mut self.unsynced), (!self.is_published).then_some(&mut self.staged)];
        for list in lists.into_iter().flatten() {
            if !list.iter().any(|other| other == name) {
                list.push(name.to_string());
            }
        }
    }

    /// Brings all whole files to the disk that were written since the last time.
    pub(super) fn sync_files(&mut self) -> io::Result<()> {
        for name in std::mem::take(&mut self.unsynced) {
            let name = if self.staged.contains(&name) { partial(&name) } else { name };
            ignore_unsupported(self.directory.read(&name)?.sync_data())?;
        }
        Ok(())
    }
}

impl Drop for Locked {
    /// What was never published goes, and the folder with it if nothing else was ever there.
    fn drop(&mut self) {
        if self.is_published {
            return;
        }
        // There is nobody to tell, and the next run removes the same.
        let _ = self.sweep();
        if self.is_new[1] {
            let _ = self.directory.remove(MARKER);
        }
        if self.is_new[0] {
            let _ = fs::remove_dir(self.directory.path());
        }
    }
}

fn busy() -> io::Error {
    let message = "another run is writing into this folder; wait for it, or choose another one";
    io::Error::new(io::ErrorKind::ResourceBusy, message)
}

/// The name under which a file is written.
fn partial(name: &str) -> String {
    format!(".{name}.partial")
}

fn is_partial(name: &str) -> bool {
    name.starts_with('.') && name.ends_with(".partial")
}

/// An error for a name that would leave the folder.
fn plain(name: &str) -> io::Result<()> {
    if name.is_empty() || name == "." || name == ".." || name.contains(['/', '\0']) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, format!("`{name}` is no name of a file")));
    }
    Ok(())
}

/// Some file systems have no such thing as a lock, or nothing to bring to a disk.
pub(super) fn ignore_unsupported(done: io::Result<()>) -> io::Result<()> {
    match done {
        Err(error) if matches!(error.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput) => Ok(()),
        done => done,
    }
}

/// A folder with tables of several runs: nobody else writes there as long as this lives.
#[derive(Debug)]
pub struct FolderLock {
    /// It has the lock.
    _directory: Directory,
}

impl FolderLock {
    /// Makes the folder if need be, and locks it.
    ///
    /// # Errors
    /// When the folder cannot be made, and when another command writes there ([`io::ErrorKind::ResourceBusy`]).
    pub fn new(path: &Path) -> io::Result<Self> {
        fs::create_dir_all(path)?;
        let directory = Directory::open(path)?;
        directory.lock()?;
        Ok(FolderLock { _directory: directory })
    }
}

/// Writes a whole file into a folder; a reader never sees half of it.
///
/// # Errors
/// When the disk refuses.
pub fn write_file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> io::Result<()> {
    Directory::open(folder)?.write(name, |file| {
        file.write_all(content.as_ref())?;
        ignore_unsupported(file.sync_data())
    })
}
