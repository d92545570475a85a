//! The linear equations of the contact nodes while no status changes.

use serde::{Deserialize, Serialize};

use super::node::{Given, NodalContact, NodeStatus};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};

/// A snapshot of the equations.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Taken {
    /// The statuses; empty before the first are set.
    pub statuses: Vec<NodeStatus>,
    /// The dictionary, if the equations depend on all earlier statuses.
    pub table: Vec<f64>,
    /// The statistics up to the snapshot.
    pub statistics: Statistics,
}

/// The equations for given statuses, in which the contact law is linear in displacements and forces, and in their
/// rates:
///
/// ```text
/// K u + C_nᵀ p_n + C_tᵀ p_t = f
/// open:   p_n = 0,    p_t = 0
/// closed: w_n = g,    stick: w_t = slide,    slip: p_t = ± μ p_n
/// ```
pub(super) trait Tangent {
    /// Sets the status of each contact node. Returns `true` if the equations are then regular.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn take(&mut self, statuses: &[NodeStatus]) -> Result<bool, LinearError>;

    /// Solves the equations for the current statuses and writes the solution to `answer`. Returns `true` if it
    /// satisfies them.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Result<bool, LinearError>;

    /// Returns the statistics of the linear solver.
    fn statistics(&self) -> Statistics;

    /// Returns a snapshot of the equations.
    fn taken(&self) -> Taken;

    /// Restores the equations from a snapshot. Returns `false` if the snapshot belongs to another problem.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn take_up(&mut self, taken: &Taken) -> Result<bool, LinearError>;

    /// Returns the linear solver for temporary use by other equations, if they can use it.
    fn lend(&mut self) -> Option<&mut RefinedSolver>;
}
