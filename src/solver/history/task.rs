//! What a history asks of a method, and what it gives: the seam at which a method of one's own goes in.

use super::increment_error::IncrementErrors;
use super::saved::Snapshot;
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::algebra::sparse::SystemMatrix;
use crate::solver::formulation::Layout;
use crate::solver::laws::{KktScales, judge};
use crate::solver::loading::Loading;
use crate::solver::newton::{Iteration, MethodResult};
use crate::solver::problem::{ContactProblem, Increment, State};
use std::ops::ControlFlow;

/// One increment to solve.
pub struct Task<'a> {
    /// Whether it is the first of its history.
    pub first: bool,
    /// Its data.
    pub increment: &'a Increment<'a>,
    /// What the change of the load does while the contact nodes are held.
    pub response: &'a Response,
    /// Of a body that contact alone holds, the contact nodes on which it comes to rest, as far as that is known.
    pub landed: Option<&'a [usize]>,
    /// How long it is relative to the one before, if there is one.
    pub stretch: Option<f64>,
    /// The scales of the error measure, from the increments before and the load of this one.
    pub scales: &'a KktScales,
    /// The error that is allowed.
    pub tolerance: f64,
}

impl Task<'_> {
    /// The error of a state at the end of the increment. For `state`s of `problem` only.
    pub fn error(&self, problem: &ContactProblem, state: &State) -> f64 {
        let imbalance = problem.imbalance(self.increment.force, state);
        judge(problem, self.increment, state, &imbalance, &self.scales.with_state(state), self.tolerance).worst().1
    }
}

/// What the change of the load from one increment to the next does to the body while its contact nodes are held, in
/// the units of the history's scaling.
pub struct Response {
    pub(super) u: Vec<f64>,
    /// The changes of the contact forces that hold the nodes, `(p_t, p_o, p_n)`.
    pub(super) forces: Vec<f64>,
    /// The largest change of a contact force that holds a node, `p_n` or `|p_T|`.
    pub contact_force: f64,
    /// The largest change of a gap.
    pub gap_change: f64,
}

impl Response {
    /// Moves the displacements at the beginning of `z`.
    pub fn add_to(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.u).for_each(|(u, du)| *u += du);
    }

    /// Adds the contact forces, which follow the displacements in `z`.
    pub fn add_forces_to(&self, z: &mut [f64]) {
        z.iter_mut().skip(self.u.len()).zip(&self.forces).for_each(|(p, dp)| *p += dp);
    }
}

/// What is told of each iteration, and answered with whether to go on.
pub type Observe<'a> = &'a mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>;

/// A method with the state it has reached, in its own units.
pub trait IncrementSolver {
    /// The matrix it factors; its pattern never changes.
    fn matrix(&self) -> &SystemMatrix;

    /// Linearises at the state it has reached; see [`IncrementSolver::linearization`].
    fn linearize(&mut self);

    /// The matrix that [`IncrementSolver::linearize`] has written, on the pattern of the other.
    fn linearization(&self) -> &SystemMatrix {
        self.matrix()
    }

    /// Writes the matrix of the body with all contact nodes held: closed, and sticking where there is friction.
    ///
    /// # Errors
    /// The weights of a free motion that is possible all the same.
    fn hold_contacts(&mut self) -> Result<(), Vec<f64>>;

    /// Solves the increment from the last state.
    ///
    /// # Errors
    /// When the linear algebra cannot go on. That a method does not converge is no error, but told by the
    /// [`MethodResult`].
    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError>;

    /// The state it has reached.
    fn state(&self) -> State;

    /// Takes over a state, as of another method or of the same with fewer contact nodes: an increment after the first starts there.
    fn go_on_from(&mut self, state: &State);

    /// Its unknowns, to be kept and put back if an increment fails.
    fn unknowns(&mut self) -> &mut Vec<f64>;

    /// What its increments leave, to be kept and put back with its unknowns; `None` of a method that does not estimate that.
    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        None
    }

    /// All that its next increment depends on; `linear` is what it solves with.
    fn memory(&self, linear: &RefinedSolver) -> Snapshot {
        let _ = linear;
        Snapshot::of_state(self.state())
    }

    /// Becomes as it was when it had this `memory`, with factors if it had some; whether that is one of such a method.
    ///
    /// # Errors
    /// When the linear algebra cannot go on.
    fn restore(&mut self, memory: Snapshot, linear: &mut RefinedSolver) -> Result<bool, LinearError> {
        let _ = linear;
        let (length, state) = (self.state().u.len(), memory.into_state());
        let state = state.filter(|state| state.u.len() == length);
        Ok(state.map(|state| self.go_on_from(&state)).is_some())
    }
}

/// What makes an [`IncrementSolver`]: one of the methods that [`super::HistorySettings`] name, or a method of one's own.
///
/// A history may condense the problem first, so the method is made for the `problem` and `loading` that it is handed.
pub trait Algorithm {
    /// Sets up the method in the unloaded body.
    fn start<'a>(&self, problem: &'a ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver + 'a>;

    /// The same for some contact `nodes` of the problem alone, ascending. `None` for a method that wants them all.
    fn of_nodes(&self, nodes: &[usize]) -> Option<Box<dyn Algorithm>> {
        let _ = nodes;
        None
    }

    /// Whether it solves problems with these unknowns.
    fn knows(&self, layout: &Layout) -> bool {
        let _ = layout;
        true
    }
}
