//! The state of the whole body at the end of an increment that was solved on the contact displacements.
//!
//! The interior follows from them (35). Where that leaves a law of equilibrium violated by more than
//! rounding, as in slender bodies, the whole system is refined: its imbalance, reduced, is solved for with
//! the linearisation of that state, and the interior follows the change.

use super::settings::HistorySettings;
use super::task::IncrementSolver;
use crate::condense::Condensed;
use crate::contact::KktScales;
use crate::formulation::Layout;
use crate::linear::{Direct, LinearError, componentwise_error};
use crate::problem::{ContactProblem, Increment, State};
use crate::sparse::sum;

/// The componentwise backward error of the whole system that needs no refinement.
const BACKWARD_ERROR: f64 = 1e-14;

/// One serves where rounding alone is to blame; slender bodies gain five or six digits by each.
const REFINEMENTS: usize = 4;

/// What the state is put together from.
pub(super) struct Whole<'a> {
    pub problem: &'a ContactProblem,
    pub condensed: &'a Condensed,
    pub increment: &'a Increment<'a>,
    pub scales: &'a KktScales,
    pub settings: &'a HistorySettings,
    /// The end of the increment, s.
    pub time: f64,
}

impl Whole<'_> {
    /// The state, and the backward error of its equilibrium.
    pub(super) fn state(
        &self,
        method: &mut dyn IncrementSolver,
        linear: &mut Direct,
    ) -> Result<(State, f64), LinearError> {
        let mut state = self.condensed.state(self.time, &method.state())?;
        let mut imbalance = self.problem.imbalance(self.increment.force, &state);
        let mut error = self.backward_error(&state, &imbalance);
        for refinement in 0..REFINEMENTS {
            let violation = imbalance.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            // A tenth, as the rounding of the imbalance counts, too.
            let allowed = 0.1 * self.settings.tolerance * self.scales.with_state(&state).force;
            if error <= BACKWARD_ERROR && violation <= allowed {
                break;
            }
            if refinement == 0 && !factor(method, linear)? {
                break;
            }
            let mut refined = state.clone();
            if violation > allowed {
                // Below the rounding of u: its second word is needed.
                refined.u_rest.resize(state.u.len(), 0.0);
                imbalance = self.problem.imbalance(self.increment.force, &refined);
            }
            let change = match self.correct(&imbalance, &mut refined, method, linear) {
                Err(LinearError::NotFinite) => break,
                change => change?,
            };
            let left = self.problem.imbalance(self.increment.force, &refined);
            let reached = self.backward_error(&refined, &left);
            if reached.is_nan() || reached > 0.5 * error {
                break;
            }
            (state, imbalance, error) = (refined, left, reached);
            method.unknowns().iter_mut().zip(&change).for_each(|(z, dz)| *z += dz);
        }
        Ok((state, error))
    }

    /// Takes an imbalance off a state; what that changes in the unknowns of the method.
    fn correct(
        &self,
        imbalance: &[f64],
        state: &mut State,
        method: &mut dyn IncrementSolver,
        linear: &mut Direct,
    ) -> Result<Vec<f64>, LinearError> {
        let scaling = self.settings.scaling;
        let forces = self.condensed.reduce(&imbalance.iter().map(|r| -r).collect::<Vec<_>>())?;
        let n = method.linearization().order();
        let (mut rhs, mut change) = (vec![0.0; n], vec![0.0; n]);
        let on_contact = self.condensed.on_contact(&forces);
        rhs.iter_mut().zip(&on_contact).for_each(|(b, force)| *b = force / scaling.force);
        linear.solve(method.linearization(), &rhs, &mut change)?;
        let border: Vec<f64> = change.iter().take(on_contact.len()).map(|du| du * scaling.length).collect();
        let du = self.condensed.displacements(&forces, &border)?;
        if state.u_rest.is_empty() {
            state.u.iter_mut().zip(&du).for_each(|(u, du)| *u += du);
        } else {
            for ((u, rest), du) in state.u.iter_mut().zip(&mut state.u_rest).zip(&du) {
                (*u, *rest) = sum(*u, *rest + du);
            }
        }
        let dp = Layout::new(&self.condensed.problem).unpacked(&change, &scaling);
        for (p, dp) in [(&mut state.p_n, dp.p_n), (&mut state.p_t, dp.p_t), (&mut state.p_o, dp.p_o)] {
            p.iter_mut().zip(&dp).for_each(|(p, dp)| *p += dp);
        }
        Ok(change)
    }

    /// The componentwise backward error of the equations of equilibrium, whose contact forces are given.
    fn backward_error(&self, state: &State, imbalance: &[f64]) -> f64 {
        let Whole { problem, increment, .. } = self;
        let mut sizes: Vec<f64> = increment.force.iter().map(|f| f.abs()).collect();
        problem.stiffness().add_sizes(&state.u, &mut sizes);
        let largest = problem.stiffness().lower().values().iter().fold(0.0_f64, |m, value| m.max(value.abs()));
        for (map, forces) in [(problem.c_n(), &state.p_n), (problem.c_t(), &state.p_t), (problem.c_o(), &state.p_o)] {
            for (i, p) in forces.iter().enumerate() {
                map.row(i).iter().for_each(|&(dof, c)| sizes[dof] += (c * p).abs());
            }
        }
        componentwise_error(&state.u, imbalance, &sizes, largest, || {
            let mut row_norm = vec![0.0_f64; imbalance.len()];
            problem.stiffness().entries().for_each(|(i, _, value)| row_norm[i] = row_norm[i].max(value.abs()));
            row_norm
        })
    }
}

/// Factors the linearisation of the state that the method has reached; tells whether that can be solved with.
fn factor(method: &mut dyn IncrementSolver, linear: &mut Direct) -> Result<bool, LinearError> {
    method.linearize();
    match linear.factorize(method.linearization()) {
        Ok(_) => Ok(true),
        Err(LinearError::Singular { .. } | LinearError::NotFinite) => Ok(false),
        Err(error) => Err(error),
    }
}
