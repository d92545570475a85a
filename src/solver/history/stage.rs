//! A stage of a history: one set-up of the equations, with the method that solves them. A new stage begins when the working
//! set grows.

use super::body::Body;
use super::response::ClampedBody;
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::task::{Algorithm, IncrementSolver, Response};
use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::solver::solvability::is_carried_without_strain;

/// One set-up of the equations, on all displacements or on those of contact, and the data of the substep tried last.
pub(super) struct Stage {
    pub method: Box<dyn IncrementSolver>,
    /// The response with clamped contact nodes, unless the nodal forces have changed since it was computed.
    pub clamped: Option<ClampedBody>,
    /// `true` if the body may move rigidly, without strain.
    pub may_move_rigidly: bool,
    /// The external forces on the body, n_u, and on the problem for which the method solves, N.
    pub force: Vec<f64>,
    pub solved_force: Vec<f64>,
    /// The gaps (m), coefficients of friction and earlier tangential displacements (m) of the substep, n_c each.
    pub gap: Vec<f64>,
    pub mu: Vec<f64>,
    pub w_t_last: Vec<f64>,
    pub w_o_last: Vec<f64>,
}

impl Stage {
    /// Sets up the equations of the `body`, and analyses their pattern with `linear`. The inner `Err`
    /// means that the body is unconstrained even with clamped contact nodes, and has the weights of its rigid modes if
    /// they are the reason.
    pub(super) fn new(
        body: Body<'_>,
        settings: &HistorySettings,
        algorithm: &dyn Algorithm,
        linear: &mut RefinedSolver,
    ) -> Result<Result<Self, Option<Vec<f64>>>, LinearError> {
        let (problem, (own, loads)) = (body.problem, body.solved());
        let mut method = algorithm.start(own, loads);
        linear.analyze(method.matrix())?;
        let clamped = match ClampedBody::new(method.as_mut(), body, &settings.scaling, linear)? {
            Ok(clamped) => clamped,
            Err(motion) => return Ok(Err(motion)),
        };
        let n_c = problem.contacts();
        Ok(Ok(Stage {
            method,
            clamped: Some(clamped),
            may_move_rigidly: is_carried_without_strain(problem)?,
            force: vec![0.0; problem.displacements()],
            solved_force: vec![0.0; own.displacements()],
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
        body: Body<'_>,
        settings: &HistorySettings,
        (from, to): (Option<f64>, f64),
        linear: &mut RefinedSolver,
    ) -> Result<Option<Response>, LinearError> {
        if self.clamped.is_none() {
            if self.method.starts_on_tangent(linear) {
                return Ok(Some(Response::default()));
            }
            self.clamp(body, settings, linear)?;
        }
        Ok(self.clamped.as_ref().map(|clamped| clamped.response(body.loading, from, to)))
    }

    /// Computes the response with clamped contact nodes.
    pub(super) fn clamp(
        &mut self,
        body: Body<'_>,
        settings: &HistorySettings,
        linear: &mut RefinedSolver,
    ) -> Result<(), LinearError> {
        self.clamped = ClampedBody::new(self.method.as_mut(), body, &settings.scaling, linear)?.ok();
        Ok(())
    }

    /// Starts from the state that the `history` has reached, if an earlier stage has left it.
    pub(super) fn continue_from(&mut self, history: &mut HistoryState, body: Body<'_>) {
        let Some(state) = &history.state else { return };
        self.method.set_state(&body.restricted(state));
        let begun = (self.method.increment_errors(), history.errors.take(), history.reached);
        if let (Some(errors), Some((before, nodes)), Some(time)) = begun {
            errors.continue_from(&before, &nodes, body, time, [&history.w_n, &history.w_t, &history.w_o]);
        }
    }
}
