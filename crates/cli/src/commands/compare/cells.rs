//! The histories of a comparison that is not done yet, in a folder of their own beside its tables.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use stickslip::scene::Origin;
use stickslip::solver::checkpoint::Checkpoint;
use stickslip_cli::compare::Cells;
use stickslip_output::{FolderLock, write_file};

/// They go when the tables are written.
const FOLDER: &str = ".cells";

pub(super) struct CellFolder {
    path: PathBuf,
    /// What the names of files are made of, so that a history of another scene is never found.
    origin: Origin,
    _alone: FolderLock,
}

impl CellFolder {
    /// That of the results in `out`: as it was left if the comparison `resumes`, otherwise empty.
    pub(super) fn open(out: &Path, origin: Origin, resumes: bool) -> io::Result<Self> {
        let cells = CellFolder { path: out.join(FOLDER), origin, _alone: FolderLock::new(out)? };
        if !resumes {
            cells.remove()?;
        }
        fs::create_dir_all(&cells.path)?;
        Ok(cells)
    }

    /// Removes them all.
    pub(super) fn remove(&self) -> io::Result<()> {
        match fs::remove_dir_all(&self.path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
            removed => removed,
        }
    }
}

impl Cells for CellFolder {
    fn kept(&self, name: &str) -> Option<Checkpoint> {
        let bytes = fs::read(self.path.join(self.origin.fingerprint_of(name))).ok()?;
        Checkpoint::from_bytes(&bytes).ok()
    }

    /// What cannot be kept is solved again another time; a disk that refuses is told when the tables are written.
    fn keep(&self, name: &str, history: &Checkpoint) {
        if let Ok(bytes) = history.to_bytes() {
            let _ = write_file(&self.path, &self.origin.fingerprint_of(name), bytes);
        }
    }
}
