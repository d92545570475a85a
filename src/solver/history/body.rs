//! The body of a history, whole or condensed, and the recovery of its states from those of the contact displacements.
//!
//! The interior follows from the contact displacements (35). If equilibrium is violated by more than rounding, as in
//! slender bodies, the whole system is refined: its imbalance is condensed, the change of the contact displacements is
//! solved for with the linearisation of the recovered state, and the change of the interior follows.

use crate::algebra::linear::{Computed, LinearError, componentwise_error};
use crate::algebra::sparse::sum;
use crate::solver::condensation::Condensed;
use crate::solver::laws::{Judgement, KktScales};
use crate::solver::loading::Loading;
use crate::solver::problem::{ContactProblem, Increment, State};
use std::borrow::Cow;

/// The largest componentwise backward error of the whole system without refinement.
const BACKWARD_ERROR: f64 = 1e-14;

/// The number of refinements. One suffices against rounding alone; in slender bodies each gains five or six digits.
const REFINEMENTS: usize = 4;

/// A body under its loads, and the condensed body if the method solves for the contact displacements alone.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    pub problem: &'a ContactProblem,
    pub loading: &'a Loading,
    pub condensed: Option<&'a Condensed>,
}

/// A state of the whole body.
pub(super) struct RecoveredState {
    pub state: State,
    /// [`ContactProblem::imbalance`], N.
    pub imbalance: Vec<f64>,
    /// The componentwise backward error of the equations of equilibrium with given contact forces.
    pub backward_error: f64,
}

impl<'a> Body<'a> {
    /// Returns the problem and the loads for which the method solves.
    pub(super) fn solved(self) -> (&'a ContactProblem, &'a Loading) {
        self.condensed.map_or((self.problem, self.loading), |condensed| (&condensed.problem, &condensed.loading))
    }

    /// Returns the contact nodes for which the method solves, ascending, if they are not all contact nodes.
    pub(super) fn nodes(self) -> Option<&'a [usize]> {
        self.condensed.and_then(Condensed::nodes)
    }

    /// Restricts per-contact-node values to the nodes for which the method solves.
    pub(super) fn on_nodes(self, values: &[f64]) -> Cow<'_, [f64]> {
        self.condensed.map_or(Cow::Borrowed(values), |condensed| condensed.on_nodes(values))
    }

    /// Restricts a state of the body to the problem for which the method solves.
    pub(super) fn restricted(self, state: &State) -> Cow<'_, State> {
        self.condensed.map_or(Cow::Borrowed(state), |condensed| Cow::Owned(condensed.condensed_state(state)))
    }

    /// Recovers the state of the body at `time` (s) from the method's `state` under the external `force`.
    pub(super) fn recovered(self, time: f64, state: State, force: &[f64]) -> Computed<RecoveredState> {
        let problem = self.problem;
        let Some(condensed) = self.condensed else {
            return Ok(RecoveredState { imbalance: problem.imbalance(force, &state)?, backward_error: 0.0, state });
        };
        let state = condensed.state(time, &state)?;
        let imbalance = problem.imbalance(force, &state)?;
        RecoveredState::of(problem, state, force, imbalance)
    }

    /// Returns a recovered state in `increment`, refined if needed by the response of the contact nodes. `scales` are
    /// those before the increment.
    pub(super) fn refined(
        self,
        recovered: RecoveredState,
        (increment, scales, tolerance): (&Increment<'_>, &KktScales, f64),
        contact: &mut dyn Responds,
    ) -> Computed<RecoveredState> {
        let Body { problem, condensed: Some(condensed), .. } = self else { return Ok(recovered) };
        let (mut reached, force) = (recovered, increment.force);
        for refinement in 0..REFINEMENTS {
            let RecoveredState { state, imbalance, backward_error } = &reached;
            // An imbalance of at most a tenth of the tolerance suffices, since it is rounded itself.
            let judgement = Judgement::new(problem, increment, state, imbalance.clone(), scales)?;
            let is_balanced = judgement.errors().equilibrium <= 0.1 * tolerance;
            let is_accurate = is_balanced && *backward_error <= BACKWARD_ERROR;
            if is_accurate || refinement == 0 && !contact.is_regular()? {
                break;
            }
            let (mut state, mut imbalance) = (state.clone(), imbalance.clone());
            if !is_balanced {
                // The correction is below the rounding of u, so the low-order part is needed.
                state.u_rest.resize(state.u.len(), 0.0);
                imbalance = problem.imbalance(force, &state)?;
            }
            match correct(condensed, &imbalance, &mut state, contact) {
                Err(LinearError::NotFinite) => break,
                corrected => corrected?,
            }
            let imbalance = problem.imbalance(force, &state)?;
            let refined = RecoveredState::of(problem, state, force, imbalance)?;
            if refined.backward_error.is_nan() || refined.backward_error > 0.5 * reached.backward_error {
                break;
            }
            reached = refined;
            contact.add_response();
        }
        Ok(reached)
    }
}

impl RecoveredState {
    /// Adds the backward error to a state under the external `force`.
    fn of(problem: &ContactProblem, state: State, force: &[f64], imbalance: Vec<f64>) -> Computed<Self> {
        let stiffness = problem.stiffness().assembled()?;
        let mut sizes = vec![0.0; state.u.len()];
        stiffness.add_sizes(&state.u, &mut sizes);
        sizes.iter_mut().zip(force).for_each(|(size, force)| *size += force.abs());
        for (map, forces) in [(problem.c_n(), &state.p_n), (problem.c_t(), &state.p_t), (problem.c_o(), &state.p_o)] {
            for (i, p) in forces.iter().enumerate() {
                map.row(i).iter().for_each(|&(dof, c)| sizes[dof] += (c * p).abs());
            }
        }
        let backward_error = componentwise_error(&state.u, &imbalance, &sizes, problem.stiffest(), || {
            let mut row_norm = vec![0.0_f64; imbalance.len()];
            stiffness.entries().for_each(|(i, _, value)| row_norm[i] = row_norm[i].max(value.abs()));
            row_norm
        });
        Ok(RecoveredState { state, imbalance, backward_error })
    }
}

/// Corrects a state of the body by the response to its imbalance.
fn correct(condensed: &Condensed, imbalance: &[f64], state: &mut State, contact: &mut dyn Responds) -> Computed<()> {
    let forces = condensed.reduce(&imbalance.iter().map(|r| -r).collect::<Vec<_>>())?;
    let change = contact.respond(&condensed.on_contact(&forces))?;
    let du = condensed.displacements(&forces, &change.u)?;
    if state.u_rest.is_empty() {
        state.u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
    } else {
        for ((u, u_rest), du) in state.u.iter_mut().zip(&mut state.u_rest).zip(&du) {
            (*u, *u_rest) = sum(*u, *u_rest + du);
        }
    }
    for (p, dp) in [(&mut state.p_n, change.p_n), (&mut state.p_t, change.p_t), (&mut state.p_o, change.p_o)] {
        p.iter_mut().zip(condensed.of_all_nodes(dp)).for_each(|(p, dp)| *p += dp);
    }
    Ok(())
}

/// The response of a condensed problem to forces while no node changes its status.
pub(super) trait Responds {
    /// Returns `true` if the statuses hold the body, so that a response exists.
    fn is_regular(&mut self) -> Computed<bool>;

    /// Returns the change of the state due to forces on its displacements (N).
    fn respond(&mut self, forces: &[f64]) -> Computed<State>;

    /// Adds the last response to the state.
    fn add_response(&mut self);
}
