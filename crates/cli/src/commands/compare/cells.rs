//! Stores the finished histories of an unfinished comparison in a folder beside its tables.

use super::csv::OF_RUN;
use crate::compare::Cells;
use std::path::{Path, PathBuf};
use std::{fs, io};
use stickslip::scene::Provenance;
use stickslip::solver::Checkpoint;
use stickslip_output::{FolderLock, write_file};

/// The files of a comparison. Not all comparisons have all pictures.
const FILES: [&str; 10] = [
    "compare.csv",
    "iterations.csv",
    "meshes.csv",
    "compare.md",
    "forces.svg",
    "work.svg",
    "growth.svg",
    "increment.svg",
    "mesh-size.svg",
    "mesh-time.svg",
];

/// The name of the folder, which is removed once the tables are written.
const FOLDER: &str = ".cells";

pub(super) struct CellFolder {
    path: PathBuf,
    /// Part of the file names, so that a history of another scene is never found.
    origin: Provenance,
    _alone: FolderLock,
}

impl CellFolder {
    /// Opens the store of the results in `out`. It is emptied unless the comparison `resumes`.
    pub(super) fn open(out: &Path, origin: Provenance, resumes: bool) -> io::Result<Self> {
        let cells =
            CellFolder { path: out.join(FOLDER), origin, _alone: FolderLock::new(out, &FILES, &OF_RUN.join(","))? };
        if !resumes {
            cells.remove()?;
        }
        fs::create_dir_all(&cells.path)?;
        Ok(cells)
    }

    /// Removes the store.
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

    /// A history that cannot be stored is solved again next time. Disk errors are reported when the tables are written.
    fn keep(&self, name: &str, history: &Checkpoint) {
        if let Ok(bytes) = history.to_bytes() {
            let _ = write_file(&self.path, &self.origin.fingerprint_of(name), bytes);
        }
    }
}
