//! A stage of a history: one set-up of the equations, with the method that solves them. A new stage begins when the working
//! set grows.

use super::body::{Body, Responds};
use super::settings::HistorySettings;
use super::state::HistoryState;
use super::task::{Algorithm, IncrementSolver, Response};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::base::units::Scaling;
use crate::solver::formulation::Layout;
use crate::solver::laws::coulomb::length;
use crate::solver::loading::Loading;
use crate::solver::problem::{ContactProblem, State};
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
    ) -> Computed<Result<Self, Option<Vec<f64>>>> {
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
    ) -> Computed<Option<Response>> {
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
    ) -> Computed<()> {
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

/// The response of a method's linearisation, at the state that it has reached on a condensed problem.
pub(super) struct Linearized<'m> {
    pub method: &'m mut dyn IncrementSolver,
    pub linear: &'m mut RefinedSolver,
    pub problem: &'m ContactProblem,
    pub scaling: Scaling,
    /// The last response.
    pub change: Vec<f64>,
}

impl Responds for Linearized<'_> {
    fn is_regular(&mut self) -> Computed<bool> {
        self.method.linearize();
        match self.linear.factorize(self.method.linearization()) {
            Ok(_) => Ok(true),
            Err(LinearError::Singular { .. } | LinearError::NotFinite) => Ok(false),
            Err(error) => Err(error),
        }
    }

    fn respond(&mut self, forces: &[f64]) -> Computed<State> {
        let n = self.method.linearization().order();
        let mut rhs = vec![0.0; n];
        rhs.iter_mut().zip(forces).for_each(|(b, force)| *b = force / self.scaling.force);
        self.change = vec![0.0; n];
        self.linear.solve(self.method.linearization(), &rhs, &mut self.change)?;
        Ok(Layout::new(self.problem).unpacked(&self.change, &self.scaling))
    }

    fn add_response(&mut self) {
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
    ) -> Computed<Result<Self, Option<Vec<f64>>>> {
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
