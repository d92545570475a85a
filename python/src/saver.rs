//! A run that is saved as it goes, and goes on from there.

use crate::error::of_file;
use crate::recorder::{Keep, Kept};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};
use stickslip::scene::Provenance;
use stickslip::solver::Checkpoint;
use stickslip_output::{Pace, write_file};

/// The part of a checkpoint that this module adds, after those of the history and of the run.
const PART: usize = 2;

/// What a file has beside the state of the run.
#[derive(Serialize, Deserialize)]
struct Saved<O, K, R> {
    origin: O,
    keep: K,
    kept: R,
}

pub(crate) struct Saver {
    file: PathBuf,
    origin: Provenance,
    pace: Pace,
}

fn refused(message: String) -> PyErr {
    PyValueError::new_err(format!("checkpoint: {message}"))
}

impl Saver {
    /// Saves runs of this `origin` in `file`, `every` so often; with `None` two hundredths of the time go there.
    pub fn new(file: PathBuf, every: Option<Duration>, origin: Provenance) -> Self {
        Saver { file, origin, pace: Pace::new(every) }
    }

    /// Returns the state that an earlier run has left in the file, and what it kept; `None` if there is no file.
    pub fn left(&mut self, keep: &Keep) -> PyResult<Option<(Checkpoint, Kept)>> {
        let bytes = match fs::read(&self.file) {
            Ok(bytes) => bytes,
            // A folder that is missing is found before the work, not after it.
            Err(error) if error.kind() == io::ErrorKind::NotFound && self.folder().is_dir() => return Ok(None),
            Err(error) => return Err(self.failed(&error)),
        };
        let name = self.file.display();
        let unreadable =
            |_| refused(format!("{name} is no checkpoint, is damaged, or is of another version; remove it"));
        let checkpoint = Checkpoint::from_bytes(&bytes).map_err(unreadable)?;
        let saved: Saved<Provenance, Keep, Kept> = checkpoint.part(PART).map_err(unreadable)?;
        let changes = self.origin.changes_since(&saved.origin);
        if !changes.is_empty() {
            return Err(refused(format!(
                "{name} is of another run: {}; remove it, or name another file",
                changes.join("; ")
            )));
        }
        if saved.keep != *keep {
            return Err(refused(format!("{name} is of a run with another keep_u; give the same, or remove the file")));
        }
        Ok(Some((checkpoint, saved.kept)))
    }

    /// Returns `true` if it is time to write the file.
    pub fn is_due(&self) -> bool {
        self.pace.is_due()
    }

    /// Writes the file. A reader never sees half of it.
    pub fn save(&mut self, here: &dyn Fn() -> Checkpoint, keep: &Keep, kept: &Kept) -> PyResult<()> {
        let folder = self.folder().to_path_buf();
        let Saver { file, origin, pace } = self;
        let name = file.file_name().map(OsString::from).unwrap_or_default();
        let write = || {
            let bytes = here().with(&Saved { origin: &*origin, keep, kept }).to_bytes().map_err(io::Error::other)?;
            write_file(&folder, &name.to_string_lossy(), bytes)
        };
        pace.keep(write).map_err(|error| self.failed(&error))
    }

    fn folder(&self) -> &Path {
        self.file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    fn failed(&self, error: &io::Error) -> PyErr {
        of_file(error, self.file.display().to_string())
    }
}
