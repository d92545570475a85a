//! The linear equations that contact nodes obey while none changes its status.

use serde::{Deserialize, Serialize};

use super::node::{Given, NodalContact, NodeStatus};
use crate::algebra::linear::{LinearError, RefinedSolver, Statistics};

/// What equations have taken, from which they can be taken up.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Taken {
    /// The statuses; none before the first are taken.
    pub statuses: Vec<NodeStatus>,
    /// What has come of all statuses so far, where the equations depend on the way to the last ones.
    pub table: Vec<f64>,
    /// What that took.
    pub statistics: Statistics,
}

/// With the status of each contact node given, the contact law is linear in displacements and forces, and in their rates:
///
/// ```text
/// K u + C_nᵀ p_n + C_tᵀ p_t = f
/// open:   p_n = 0,    p_t = 0
/// closed: w_n = g,    stick: w_t = slide,    slip: p_t = ± μ p_n
/// ```
pub(super) trait Tangent {
    /// Takes these statuses, one for each contact node; tells whether the equations are regular with them.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    fn take(&mut self, statuses: &[NodeStatus]) -> Result<bool, LinearError>;

    /// Solves the equations of the statuses taken last; tells whether the solution fulfils them. `answer` is where it goes.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    fn solve(&mut self, given: &Given, answer: &mut NodalContact) -> Result<bool, LinearError>;

    /// What the linear algebra has done.
    fn statistics(&self) -> Statistics;

    /// What they have taken.
    fn taken(&self) -> Taken;

    /// Goes on from what other equations of the same problem have `taken`; tells whether they were such.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    fn take_up(&mut self, taken: &Taken) -> Result<bool, LinearError>;

    /// The linear algebra, for other equations in between, if it is of use to them.
    fn lend(&mut self) -> Option<&mut RefinedSolver>;
}
