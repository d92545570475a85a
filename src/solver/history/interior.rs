//! Recovery of the whole body's states at the ends of increments that were solved on the contact displacements.
//!
//! The interior follows from the contact displacements (35). If equilibrium is violated by more than rounding, as in slender bodies, the
//! whole system is refined: its imbalance is reduced and solved for with the linearisation of that state, and the
//! interior follows from the change.

use super::task::{IncrementSolver, Response};
use crate::algebra::linear::{LinearError, RefinedSolver, componentwise_error};
use crate::algebra::sparse::sum;
use crate::base::units::Scaling;
use crate::solver::condensation::Condensed;
use crate::solver::formulation::Layout;
use crate::solver::laws::coulomb::length;
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
    pub(super) fn recovered(self, time: f64, state: State, force: &[f64]) -> Result<RecoveredState, LinearError> {
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
    ) -> Result<RecoveredState, LinearError> {
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
            contact.go_on();
        }
        Ok(reached)
    }
}

impl RecoveredState {
    /// Adds the backward error to a state under the external `force`.
    fn of(problem: &ContactProblem, state: State, force: &[f64], imbalance: Vec<f64>) -> Result<Self, LinearError> {
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
fn correct(
    condensed: &Condensed,
    imbalance: &[f64],
    state: &mut State,
    contact: &mut dyn Responds,
) -> Result<(), LinearError> {
    let forces = condensed.reduce(&imbalance.iter().map(|r| -r).collect::<Vec<_>>())?;
    let change = contact.respond(&condensed.on_contact(&forces))?;
    let du = condensed.displacements(&forces, &change.u)?;
    if state.u_rest.is_empty() {
        state.u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
    } else {
        for ((u, rest), du) in state.u.iter_mut().zip(&mut state.u_rest).zip(&du) {
            (*u, *rest) = sum(*u, *rest + du);
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
    fn is_regular(&mut self) -> Result<bool, LinearError>;

    /// Returns the change of the state due to forces on its displacements (N).
    fn respond(&mut self, forces: &[f64]) -> Result<State, LinearError>;

    /// Adds the last response to the state.
    fn go_on(&mut self);
}

/// The response of a method's linearisation.
pub(super) struct Linearized<'m> {
    method: &'m mut dyn IncrementSolver,
    linear: &'m mut RefinedSolver,
    problem: &'m ContactProblem,
    scaling: Scaling,
    change: Vec<f64>,
}

impl<'m> Linearized<'m> {
    /// Creates the response at the state that the `method` has reached on a condensed `problem`.
    pub(super) fn new(
        method: &'m mut dyn IncrementSolver,
        linear: &'m mut RefinedSolver,
        problem: &'m ContactProblem,
        scaling: Scaling,
    ) -> Self {
        Linearized { method, linear, problem, scaling, change: Vec::new() }
    }
}

impl Responds for Linearized<'_> {
    fn is_regular(&mut self) -> Result<bool, LinearError> {
        self.method.linearize();
        match self.linear.factorize(self.method.linearization()) {
            Ok(_) => Ok(true),
            Err(LinearError::Singular { .. } | LinearError::NotFinite) => Ok(false),
            Err(error) => Err(error),
        }
    }

    fn respond(&mut self, forces: &[f64]) -> Result<State, LinearError> {
        let n = self.method.linearization().order();
        let mut rhs = vec![0.0; n];
        rhs.iter_mut().zip(forces).for_each(|(b, force)| *b = force / self.scaling.force);
        self.change = vec![0.0; n];
        self.linear.solve(self.method.linearization(), &rhs, &mut self.change)?;
        Ok(Layout::new(self.problem).unpacked(&self.change, &self.scaling))
    }

    fn go_on(&mut self) {
        self.method.unknowns().iter_mut().zip(&self.change).for_each(|(z, dz)| *z += dz);
    }
}

/// The response of the body to each load case with clamped contact nodes.
pub(super) struct ClampedBody {
    /// `∂(u, p_t, p_n)/∂factor` per case, scaled.
    answers: Vec<Vec<f64>>,
    layout: Layout,
    scaling: Scaling,
}

impl ClampedBody {
    /// Computes the responses by one factorisation with clamped contact nodes and one solve per load case. The inner
    /// `Err` means that the body is unconstrained even then, and has the weights of its rigid modes if they are the
    /// reason.
    pub(super) fn new(
        method: &mut dyn IncrementSolver,
        body: Body<'_>,
        scaling: &Scaling,
        linear: &mut RefinedSolver,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        let (problem, loading) = body.solved();
        if let Err(motion) = method.clamp_contacts() {
            return Ok(Err(Some(motion)));
        }
        let layout = Layout::new(problem);
        let mut answers = Vec::with_capacity(loading.cases().len());
        // Without contact nodes one Newton step solves the increment.
        if problem.contacts() > 0 && !loading.cases().is_empty() {
            match linear.factorize(method.matrix()) {
                Ok(_) => {}
                Err(LinearError::Singular { .. }) => return Ok(Err(None)),
                Err(error) => return Err(error),
            }
            let n = method.matrix().order();
            let (mut rhs, mut z) = (vec![0.0; n], vec![0.0; n]);
            for case in loading.cases() {
                for (to, from) in rhs.iter_mut().zip(case.force()) {
                    *to = from / scaling.force;
                }
                match linear.solve(method.matrix(), &rhs, &mut z) {
                    Ok(_) => {}
                    Err(LinearError::NotFinite) => return Ok(Err(None)),
                    Err(error) => return Err(error),
                }
                answers.push(z[..layout.unknowns()].to_vec());
            }
        }
        Ok(Ok(ClampedBody { answers, layout, scaling: *scaling }))
    }

    /// Returns the response to the change of the load from one time to another; `None` means the unloaded body.
    pub(super) fn response(&self, loading: &Loading, from: Option<f64>, to: f64) -> Response {
        let mut u = vec![0.0; self.answers.first().map_or(0, Vec::len)];
        for (case, answer) in loading.cases().iter().zip(&self.answers) {
            let change = case.factor(to) - from.map_or(0.0, |from| case.factor(from));
            for (u, a) in u.iter_mut().zip(answer) {
                *u += change * a;
            }
        }
        let contacts = if u.is_empty() { 0 } else { self.layout.contacts() };
        let force = |i: usize| {
            let friction = self.layout.tangential(i).map(|k| k.map_or(0.0, |k| u[k]));
            length(friction).max(u[self.layout.p_n(i)].abs())
        };
        let contact_force = (0..contacts).map(force).fold(0.0, f64::max);
        let forces = u.split_off(self.layout.displacements().min(u.len()));
        let (mut before, mut after) = (loading.gap().to_vec(), loading.gap().to_vec());
        if let Some(from) = from {
            loading.gap_at(from, &mut before);
        }
        loading.gap_at(to, &mut after);
        let gap_change = after.iter().zip(&before).fold(0.0_f64, |m, (now, before)| m.max((now - before).abs()));
        Response { u, contact_force, forces, gap_change: gap_change / self.scaling.length }
    }
}
