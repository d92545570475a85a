//! Linear algebra from outside the library: solvers that one or several processes share.

use std::sync::{Arc, OnceLock};

use super::{Computed, Grid, LinearSolver, Stiffness};
use crate::algebra::sparse::NodeRows;

/// The solvers that a program adds to the library, and the processes that share their work.
pub trait Engine: Send + Sync {
    /// Returns the number of processes, 1 or more.
    fn ranks(&self) -> usize;

    /// Returns the resources used by each of several processes; empty if there is only one.
    fn used(&self) -> Vec<RankUse>;

    /// Creates the stiffness of `body`, of which each process assembles the rows of its own nodes. This process keeps
    /// a copy of the columns at the nodes `near` contact, which has this number of nodes, `contacts`. Returns `None` if
    /// a process cannot assemble its rows, or has another body.
    ///
    /// # Errors
    /// If the processes cannot work together, or memory is short.
    fn share(&self, body: Arc<dyn NodeRows>, near: &[bool], contacts: usize) -> Computed<Option<Stiffness>>;

    /// Creates the direct solver, a factorisation on all processes.
    fn direct(&self) -> Box<dyn LinearSolver>;

    /// Creates the iterative solver of systems with the unknowns of `grid`. The `options` say how it solves, in the
    /// words of the engine.
    fn iterative(&self, grid: Grid, options: Option<&str>) -> Box<dyn LinearSolver>;
}

/// The resources used by one process.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RankUse {
    /// The CPU time, s.
    pub cpu_seconds: f64,
    /// The peak resident memory, bytes.
    pub peak_rss_bytes: u64,
}

static ENGINE: OnceLock<&'static dyn Engine> = OnceLock::new();

/// Adds `engine` to the linear solvers of this process, for good. Only the first one counts.
pub fn add_engine(engine: &'static dyn Engine) {
    // A second call is no failure: it is of the same program.
    let _ = ENGINE.set(engine);
}

/// Returns the engine of this process, if the program has added one.
pub(crate) fn engine() -> Option<&'static dyn Engine> {
    ENGINE.get().copied()
}
