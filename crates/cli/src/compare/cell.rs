//! Histories of a comparison that are done, as they are kept for another time.

use serde::{Deserialize, Serialize};

use super::{Iterate, Phases};
use stickslip::run::report::Seen;
use stickslip::solver::checkpoint::Checkpoint;
use stickslip::solver::history::Status;
use stickslip::solver::problem::{ContactProblem, State};

/// Keeps the histories of a comparison that are done, so that one that is ended goes on with the others. Histories that are computed at
/// a time are kept by several threads.
pub trait Cells: Sync {
    /// What was kept under this name, which is that of a history among those of the scene.
    fn kept(&self, _name: &str) -> Option<Checkpoint> {
        None
    }
    /// Keeps a history.
    fn keep(&self, _name: &str, _history: &Checkpoint) {}
}

/// Keeps nothing.
impl Cells for () {}

/// A history, solved.
#[derive(Serialize, Deserialize)]
pub(super) struct Solved {
    /// The increments asked for; 0 where that is the exact path.
    pub increments: usize,
    pub status: Status,
    /// The increments that converged.
    pub converged: usize,
    pub iterations: usize,
    pub factorizations: usize,
    pub factor_entries: usize,
    pub factor_peak_bytes: f64,
    pub kkt: f64,
    /// The state at its end.
    pub state: State,
    /// The friction work of the whole, J.
    pub work: f64,
    pub seconds: Phases,
    pub iterates: Vec<Iterate>,
    /// What its end has shown, of a reference.
    pub seen: Option<Seen>,
}

impl Solved {
    /// The history of this name: as it was kept if it was, or else as `solve` does.
    pub(super) fn or_kept<E>(
        cells: &dyn Cells,
        name: &str,
        problem: &ContactProblem,
        solve: impl FnOnce() -> Result<Self, E>,
    ) -> Result<Self, E> {
        let kept = cells.kept(name).and_then(|kept| kept.part::<Solved>(0).ok());
        if let Some(kept) = kept.filter(|kept| kept.state.check(problem).is_ok()) {
            return Ok(kept);
        }
        let solved = solve()?;
        cells.keep(name, &Checkpoint::new(solved.converged, 0.0, &solved));
        Ok(solved)
    }
}
