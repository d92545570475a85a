//! A stage of a history: one set-up of the equations, with the method that solves them. A new stage begins when the working
//! set grows.

use super::interior::ClampedBody;
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::task::{Algorithm, IncrementSolver, Response};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::condensation::Condensed;
use crate::solver::loading::Loading;
use crate::solver::problem::ContactProblem;
use crate::solver::solvability::is_carried_without_strain;

/// One set-up of the equations, on all displacements or on those of contact, and the data of the substep tried last.
pub(super) struct Stage {
    pub method: Box<dyn IncrementSolver>,
    /// The response with clamped contact nodes, unless the nodal forces have changed since it was computed.
    pub clamped: Option<ClampedBody>,
    /// `true` if the body may move rigidly, without strain.
    pub may_move_rigidly: bool,
    /// The external forces on the whole body, n_u, N, and on the condensed problem, if there is one.
    pub force: Vec<f64>,
    pub condensed_force: Vec<f64>,
    /// The gaps (m), coefficients of friction and earlier tangential displacements (m) of the substep, n_c each.
    pub gap: Vec<f64>,
    pub mu: Vec<f64>,
    pub w_t_last: Vec<f64>,
    pub w_o_last: Vec<f64>,
}

impl Stage {
    /// Sets up the equations on the body or on `condensed`, and analyses their pattern with `linear`. The inner `Err`
    /// means that the body is unconstrained even with clamped contact nodes, and has the weights of its rigid modes if
    /// they are the reason.
    pub(super) fn new(
        problem: &ContactProblem,
        loading: &Loading,
        settings: &HistorySettings,
        algorithm: &dyn Algorithm,
        condensed: Option<&Condensed>,
        linear: &mut RefinedSolver,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        let (own, loads) = condensed.map_or((problem, loading), |body| (&body.problem, &body.loading));
        let mut method = algorithm.start(own, loads);
        linear.analyze(method.matrix())?;
        let clamped = match ClampedBody::new(method.as_mut(), own, loads, &settings.scaling, linear)? {
            Ok(clamped) => clamped,
            Err(motion) => return Ok(Err(motion)),
        };
        let n_c = problem.contacts();
        Ok(Ok(Stage {
            method,
            clamped: Some(clamped),
            may_move_rigidly: is_carried_without_strain(problem)?,
            force: vec![0.0; problem.displacements()],
            condensed_force: vec![0.0; condensed.map_or(0, |_| own.displacements())],
            gap: vec![0.0; n_c],
            mu: problem.mu().to_vec(),
            w_t_last: vec![0.0; n_c],
            w_o_last: vec![0.0; n_c],
        }))
    }

    /// Returns the response to the change of the load from one time to another; `None` means the unloaded body. It is
    /// computed again if the nodal forces have changed and the method needs it. Returns `None` if there is none.
    pub(super) fn response(
        &mut self,
        body: (&ContactProblem, &Loading),
        condensed: Option<&Condensed>,
        settings: &HistorySettings,
        (from, to): (Option<f64>, f64),
        linear: &mut RefinedSolver,
    ) -> Result<Option<Response>, LinearError> {
        if self.clamped.is_none() {
            if self.method.starts_on_tangent(linear) {
                return Ok(Some(Response::default()));
            }
            self.clamp(body, condensed, settings, linear)?;
        }
        Ok(self.clamped.as_ref().map(|clamped| clamped.response(body.1, from, to)))
    }

    /// Computes the response with clamped contact nodes.
    pub(super) fn clamp(
        &mut self,
        body: (&ContactProblem, &Loading),
        condensed: Option<&Condensed>,
        settings: &HistorySettings,
        linear: &mut RefinedSolver,
    ) -> Result<(), LinearError> {
        let (own, loads) = condensed.map_or(body, |condensed| (&condensed.problem, &condensed.loading));
        self.clamped = ClampedBody::new(self.method.as_mut(), own, loads, &settings.scaling, linear)?.ok();
        Ok(())
    }

    /// Starts from the state `at` that the history has reached, if an earlier stage has left it.
    pub(super) fn continue_from(&mut self, at: &mut HistoryState, condensed: Option<&Condensed>, loading: &Loading) {
        let Some(state) = &at.state else { return };
        let Some(condensed) = condensed else { return self.method.set_state(state) };
        self.method.set_state(&condensed.condensed_state(state));
        let begun = (self.method.increment_errors(), at.errors.take(), at.reached);
        if let (Some(errors), Some((before, nodes)), Some(time)) = begun {
            errors.continue_from(&before, &nodes, condensed, loading, time, [&at.w_n, &at.w_t, &at.w_o]);
        }
    }
}
