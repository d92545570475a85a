//! Stored histories of a comparison.

use super::Course;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::{fs, io};
use stickslip::run::report::EstimateWatch;
use stickslip::scene::Provenance;
use stickslip::solver::history::Status;
use stickslip::solver::{Checkpoint, ContactProblem, State};
use stickslip_output::write_file;

/// A store of finished histories, with which an interrupted comparison is resumed. It must accept calls from several
/// threads.
pub trait Cells: Sync {
    /// Returns the history stored under this name, which is unique within the scene.
    fn stored(&self, _name: &str) -> Option<Checkpoint> {
        None
    }
    /// Stores a history.
    fn keep(&self, _name: &str, _history: &Checkpoint) {}
}

/// A store that keeps nothing.
impl Cells for () {}

/// A store in a folder beside the tables, which is removed once these are written.
pub(crate) struct CellFolder {
    path: PathBuf,
    /// Part of the file names, so that a history of another scene is never found.
    origin: Provenance,
}

impl CellFolder {
    /// Opens the store of the results in `out`. It is emptied unless the comparison `resumes`.
    pub fn open(out: &Path, origin: Provenance, resumes: bool) -> io::Result<Self> {
        let cells = CellFolder { path: out.join(".cells"), origin };
        if !resumes {
            cells.remove()?;
        }
        fs::create_dir_all(&cells.path)?;
        Ok(cells)
    }

    /// Removes the store.
    pub fn remove(&self) -> io::Result<()> {
        if self.path.exists() { fs::remove_dir_all(&self.path) } else { Ok(()) }
    }
}

impl Cells for CellFolder {
    fn stored(&self, name: &str) -> Option<Checkpoint> {
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
/// A solved history.
#[derive(Serialize, Deserialize)]
pub(super) struct Solved {
    /// The requested increments; 0 for the exact path.
    pub increments: usize,
    pub course: Course,
    /// The final state.
    pub state: State,
    /// The total friction work, J.
    pub work: f64,
    /// For a reference, the data for its error estimates.
    pub seen: Option<EstimateWatch>,
}

impl Solved {
    /// Returns the history of this name from the store, or solves and stores it.
    pub(super) fn stored_or<E>(
        cells: &dyn Cells,
        name: &str,
        problem: &ContactProblem,
        solve: impl FnOnce() -> Result<Self, E>,
    ) -> Result<Self, E> {
        let stored = cells.stored(name).and_then(|kept| kept.part::<Solved>(0).ok());
        if let Some(kept) = stored.filter(|stored| stored.state.check(problem).is_ok()) {
            return Ok(kept);
        }
        let solved = solve()?;
        if solved.course.status != Status::Interrupted {
            cells.keep(name, &Checkpoint::new(solved.course.converged, 0.0, &solved));
        }
        Ok(solved)
    }
}
