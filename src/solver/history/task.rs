//! The interface between a history and a method, for the methods here and for a caller's own.

use super::increment_error::IncrementErrors;
use super::saved::Snapshot;
use crate::algebra::linear::{Computed, RefinedSolver, SystemMatrix};
use crate::solver::formulation::Layout;
use crate::solver::laws::coulomb::TangentialCase;
use crate::solver::laws::{Judgement, KktScales};
use crate::solver::loading::Loading;
use crate::solver::newton::{Iteration, MethodResult};
use crate::solver::problem::{ContactProblem, Increment, State};
use std::ops::ControlFlow;

/// One increment to solve.
pub struct Task<'a> {
    /// The problem of the method's equations: the whole body, or the condensed one.
    pub problem: &'a ContactProblem,
    /// `true` for the first increment of its history.
    pub first: bool,
    /// The data of the increment.
    pub increment: &'a Increment<'a>,
    /// The response to the change of the load with clamped contact nodes; zero if the method starts on a tangent and
    /// the response is not known.
    pub response: &'a Response,
    /// The contact nodes on which a body comes to rest that only contact holds, if they are known.
    pub landed: Option<&'a [usize]>,
    /// The scales of the error measure, from the earlier increments and the loads whose sum is that of this one.
    pub scales: &'a KktScales,
    /// The tolerance of the error measure.
    pub tolerance: f64,
}

impl Task<'_> {
    /// Returns the error of a state of the problem at the end of the increment.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed.
    pub fn error(&self, state: &State) -> Computed<f64> {
        self.error_of(self.increment, state)
    }

    /// Returns the error of a state in the first step of the proximal point method, in which the gaps and slips of
    /// dependent contact nodes yield to their pressures and to the change of their friction since the state `before`.
    ///
    /// # Errors
    /// As [`Task::error`].
    pub(super) fn error_of_yielding_nodes(&self, state: &State, before: &State) -> Computed<f64> {
        let compliance = &self.problem.natural().compliance;
        let Increment { gap, w_t_last, w_o_last, .. } = self.increment;
        let nodes = || 0..compliance.len();
        let gap: Vec<f64> = nodes().map(|i| gap[i] + compliance[i][0] * state.p_n[i]).collect();
        let slid = |last: &[f64], p: &[f64], before: &[f64]| -> Vec<f64> {
            nodes().map(|i| last[i] + compliance[i][1] * (p[i] - before[i])).collect()
        };
        let w_t_last = slid(w_t_last, &state.p_t, &before.p_t);
        let w_o_last = slid(w_o_last, &state.p_o, &before.p_o);
        let increment = Increment { gap: &gap, w_t_last: &w_t_last, w_o_last: &w_o_last, ..*self.increment };
        self.error_of(&increment, state)
    }

    pub(super) fn error_of(&self, increment: &Increment<'_>, state: &State) -> Computed<f64> {
        let judgement = Judgement::near(self.problem, increment, state, self.scales, self.tolerance)?;
        Ok(judgement.errors().worst().1)
    }
}

/// The response of the body to the change of the load in an increment with clamped contact nodes, in the units of the
/// history's scaling.
#[derive(Default)]
pub struct Response {
    pub(super) u: Vec<f64>,
    /// The changes of the contact forces that clamp the nodes, `(p_t, p_o, p_n)`.
    pub(super) forces: Vec<f64>,
    /// The largest change of a contact force that clamps a node, `p_n` or `|p_T|`.
    pub contact_force: f64,
    /// The largest change of a gap.
    pub gap_change: f64,
}

impl Response {
    /// Adds the displacements to the start of `z`.
    pub fn add_to(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.u).for_each(|(u, du)| *u += du);
    }

    /// Returns the changes of the normal forces that clamp `contacts` nodes; 0 where the response is not known.
    pub(super) fn p_n(&self, contacts: usize) -> Vec<f64> {
        let known = self.forces.len().saturating_sub(contacts);
        let mut p_n = self.forces[known..].to_vec();
        p_n.resize(contacts, 0.0);
        p_n
    }

    /// Adds the contact forces, which follow the displacements in `z`.
    pub fn add_forces_to(&self, z: &mut [f64]) {
        z.iter_mut().skip(self.u.len()).zip(&self.forces).for_each(|(p, dp)| *p += dp);
    }
}

/// A callback that receives each iteration and returns if the method may continue.
pub type Observe<'a> = &'a mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>;

/// A method for the increments of a history, with its state in its own units.
pub trait IncrementSolver: Send {
    /// Returns the matrix that the method factors. Its pattern never changes.
    fn matrix(&self) -> &SystemMatrix;

    /// Linearises at the present state; see [`IncrementSolver::linearization`].
    fn linearize(&mut self);

    /// Returns the matrix written by [`IncrementSolver::linearize`], on the pattern of [`IncrementSolver::matrix`].
    fn linearization(&self) -> &SystemMatrix {
        self.matrix()
    }

    /// Writes the matrix with all contact nodes clamped: closed, and sticking if there is friction.
    ///
    /// # Errors
    /// The weights of a rigid mode that remains unconstrained.
    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>>;

    /// Returns `true` if the next increment starts on the tangent at the present state, whose factors are in `linear`,
    /// so that its start needs no [`Response`].
    fn starts_on_tangent(&self, _linear: &RefinedSolver) -> bool {
        false
    }

    /// Solves the increment from the last state.
    ///
    /// # Errors
    /// If the linear solver fails. A method that does not converge is no error, but is reported in the
    /// [`MethodResult`].
    fn solve(&mut self, task: &Task<'_>, linear: &mut RefinedSolver, observe: Observe<'_>) -> Computed<MethodResult>;

    /// Returns the present state.
    fn state(&self) -> State;

    /// Returns the state at the end of the increment that was solved last on the tangent at its start, where the unknowns
    /// were `start` and the nodes had these `cases`. `None` means that there is none, or that the method has no tangents.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn ahead(
        &mut self,
        _start: &[f64],
        _cases: &[(bool, TangentialCase)],
        _linear: &mut RefinedSolver,
    ) -> Computed<Option<State>> {
        Ok(None)
    }

    /// Sets the state, for example from another method or from a smaller working set. An increment after the first
    /// starts there.
    fn set_state(&mut self, state: &State);

    /// Returns the unknowns, which are saved, and restored if an increment fails.
    fn unknowns(&mut self) -> &mut Vec<f64>;

    /// Returns the accumulated time-step error, saved and restored with the unknowns, or `None` if the method does
    /// not estimate it.
    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        None
    }

    /// Takes a snapshot of all data on which the next increment depends. `linear` is the solver of the method.
    fn snapshot(&self, _linear: &RefinedSolver) -> Snapshot {
        Snapshot::of_state(self.state())
    }

    /// Restores the method from a snapshot and refactors if the snapshot had factors. Returns `false` if the snapshot
    /// belongs to another method.
    ///
    /// # Errors
    /// If the linear solver fails.
    fn restore(&mut self, snapshot: Snapshot, _linear: &mut RefinedSolver) -> Computed<bool> {
        let (length, state) = (self.state().u.len(), snapshot.into_state());
        let state = state.filter(|state| state.u.len() == length);
        Ok(state.map(|state| self.set_state(&state)).is_some())
    }
}

/// The factory of an [`IncrementSolver`]: a method that [`super::HistorySettings`] name, or a caller's own.
///
/// A history may condense the problem first, so the factory receives the `problem` and `loading` for the method.
pub trait Algorithm {
    /// Creates the method in the unloaded body.
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver>;

    /// Returns a factory for the contact `nodes` alone, ascending, or `None` if the method needs all contact nodes.
    fn of_nodes(&self, _nodes: &[usize]) -> Option<Box<dyn Algorithm>> {
        None
    }

    /// Returns `true` if the method supports these unknowns.
    fn knows(&self, _layout: &Layout) -> bool {
        true
    }
}
