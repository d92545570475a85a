//! A run that is saved as it goes, and goes on from there.

use crate::error::of_file;
use crate::recorder::{Keep, Kept};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::time::Duration;
use std::{fs, io};
use stickslip::body::mesh::Mesh;
use stickslip::scene::Provenance;
use stickslip::solver::Checkpoint;
use stickslip_output::{FileLock, Pace, write_file};

/// The part of a checkpoint that this module adds, after those of the history and of the run.
const PART: usize = 2;

/// The run of a checkpoint: a run of another identity is refused.
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    pub origin: Provenance,
    /// A hash of the mesh, which need not be in a file.
    pub mesh: u64,
    pub tolerance: f64,
    pub keep: Keep,
}

impl Identity {
    /// Describes the changes since `earlier`; empty without changes.
    fn changes_since(&self, earlier: &Identity) -> String {
        let mut changes = self.origin.changes_since(&earlier.origin);
        let told = [
            (self.mesh != earlier.mesh, "the mesh is another"),
            (self.tolerance != earlier.tolerance, "tolerance is another"),
            (self.keep != earlier.keep, "keep_u is another"),
        ];
        changes.extend(told.into_iter().filter(|(differs, _)| *differs).map(|(_, what)| what.to_string()));
        changes.join("; ")
    }
}

/// Returns a hash of a mesh: nodes, cells, groups and boundaries.
pub(crate) fn hash_of(mesh: &Mesh) -> u64 {
    let mut hasher = DefaultHasher::new();
    for x in mesh.nodes.as_flattened() {
        x.to_bits().hash(&mut hasher);
    }
    for cell in &mesh.cells {
        (cell.kind, &cell.nodes, cell.group).hash(&mut hasher);
    }
    mesh.groups.hash(&mut hasher);
    for boundary in &mesh.boundaries {
        (&boundary.name, &boundary.facets).hash(&mut hasher);
    }
    hasher.finish()
}

/// The part of a file beside the state of the run.
#[derive(Serialize, Deserialize)]
struct Saved<I, K> {
    of: I,
    kept: K,
}

pub(crate) struct Saver {
    folder: PathBuf,
    name: String,
    of: Identity,
    pace: Pace,
    /// Two runs that write one file would lose one of them.
    _lock: FileLock,
}

fn refused(message: String) -> PyErr {
    PyValueError::new_err(format!("checkpoint: {message}"))
}

impl Saver {
    /// Saves the run `of` this identity in `file`, `every` so often; with `None` two hundredths of the time go there.
    pub fn new(file: &Path, every: Option<Duration>, of: Identity) -> PyResult<Self> {
        let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let Some(name) = file.file_name().and_then(|name| name.to_str()) else {
            return Err(refused(format!("{} names no file", file.display())));
        };
        let failed = |error: io::Error| match error.kind() {
            io::ErrorKind::ResourceBusy => {
                refused(format!("{} is in use: another run saves itself there", file.display()))
            }
            _ => of_file(&error, file.display().to_string()),
        };
        let lock = FileLock::new(folder, name).map_err(failed)?;
        Ok(Saver { folder: folder.to_path_buf(), name: name.to_string(), of, pace: Pace::new(every), _lock: lock })
    }

    fn file(&self) -> PathBuf {
        self.folder.join(&self.name)
    }

    /// Returns the state that an earlier run has left in the file, and what it kept; `None` if there is no file.
    pub fn left(&self) -> PyResult<Option<(Checkpoint, Kept)>> {
        let file = self.file();
        let name = file.display();
        match fs::metadata(&file) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            // A device or a pipe may be read without end.
            Ok(found) if !found.is_file() => return Err(refused(format!("{name} is no regular file; name another"))),
            _ => {}
        }
        let bytes = fs::read(&file).map_err(|error| of_file(&error, name.to_string()))?;
        let unreadable =
            |_| refused(format!("{name} is no checkpoint, is damaged, or is of another version; remove it"));
        let checkpoint = Checkpoint::from_bytes(&bytes).map_err(unreadable)?;
        let saved: Saved<Identity, Kept> = checkpoint.part(PART).map_err(unreadable)?;
        let changes = self.of.changes_since(&saved.of);
        if !changes.is_empty() {
            return Err(refused(format!("{name} is of another run: {changes}; remove it, or name another file")));
        }
        Ok(Some((checkpoint, saved.kept)))
    }

    /// Returns `true` if it is time to write the file.
    pub fn is_due(&self) -> bool {
        self.pace.is_due()
    }

    /// Writes the file. A reader never sees half of it.
    pub fn save(&mut self, here: &dyn Fn() -> Checkpoint, kept: &Kept) -> Result<(), String> {
        let Saver { folder, name, of, pace, .. } = self;
        let write = || {
            let bytes = here().with(&Saved { of: &*of, kept }).to_bytes().map_err(io::Error::other)?;
            write_file(folder, name, bytes)
        };
        pace.keep(write).map_err(|error| format!("{}: {error}", self.file().display()))
    }
}
