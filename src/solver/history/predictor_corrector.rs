//! The predictor–corrector interior point method along a history, with its starting points.

use super::saved::{Snapshot, take_over};
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Response, Task};
use crate::algebra::linear::{Computed, RefinedSolver, SystemMatrix};
use crate::algebra::vector::median;
use crate::solver::formulation::{
    Assembled, Bdiff, ConeSystem, Constrained, FormulationScaling, InteriorPoint, Partition,
};
use crate::solver::newton::{Armijo, Bn, MethodResult, PredictorCorrector, StopCriterion, Termination};
use crate::solver::problem::State;

/// The error at which BN takes over, unless the tolerance is larger: near enough for the contact statuses, and
/// attainable despite rounding in slender bodies.
const NEAR: f64 = 1e-8;

/// The predictor–corrector method with its starts in a history.
pub(super) struct PredictorCorrectorMethod {
    formulation: Box<dyn InteriorPoint>,
    method: PredictorCorrector,
    /// The tolerance of the error measure.
    tolerance: f64,
    /// The distance of the start from the border, in terms of the estimate; see [`super::strategy`].
    distance: f64,
    /// The limit of the iterations in an increment, with those of BN at the end.
    most: usize,
    /// The median stiffness of a contact node along its normal, scaled. Only its order of magnitude matters.
    stiffness: f64,
    z: Vec<f64>,
    /// The low-order part of `(u, p_t, p_n)`.
    z_lo: Vec<f64>,
    end: NewtonEnd,
}

impl PredictorCorrectorMethod {
    /// Creates the method on an assembled problem.
    pub(super) fn beside(assembled: Assembled, history: &HistorySettings) -> Self {
        let (conventions, stiffness) = (&history.conventions, &history.contact_stiffness);
        if assembled.layout().has_second_tangent() {
            let formulation = Box::new(ConeSystem::on(assembled.clone(), conventions));
            Self::with(assembled, history, formulation, mean_of_compliances(stiffness))
        } else {
            let formulation = Box::new(Constrained::on(assembled.clone(), conventions, Partition::Products));
            Self::with(assembled, history, formulation, median(&mut stiffness.clone()).unwrap_or(1.0))
        }
    }

    fn with(
        assembled: Assembled,
        history: &HistorySettings,
        formulation: Box<dyn InteriorPoint>,
        stiffness: f64,
    ) -> Self {
        let HistorySettings { tolerance, max_iterations, .. } = *history;
        let natural = FormulationScaling::of_stiffness(assembled.layout(), &history.contact_stiffness);
        PredictorCorrectorMethod {
            distance: 1.0,
            most: max_iterations,
            stiffness: stiffness / history.scaling.stiffness(),
            z: vec![0.0; formulation.unknowns()],
            z_lo: vec![0.0; formulation.forces().unknowns()],
            end: NewtonEnd::new(assembled, &natural),
            method: PredictorCorrector::new(tolerance.max(NEAR), max_iterations),
            tolerance,
            formulation,
        }
    }

    /// Sets the start of the next increments, `distance` times as far from the border as estimated, and the limits of
    /// their iterations, without those of BN at the end and with them.
    pub(super) fn start_at(&mut self, distance: f64, patience: usize, max_iterations: usize) {
        (self.distance, self.most) = (distance, max_iterations);
        self.method.max_iterations = patience.min(max_iterations);
    }

    /// Moves the pairs into the interior, to a distance from the last solution that fits the change of the load. It
    /// is estimated from the contact forces that would clamp the nodes and from the gaps that change or are violated,
    /// and multiplied by `distance`. A factor of ten too large or too small costs a few iterations.
    fn move_inside(&mut self, response: &Response) {
        let contacts = self.formulation.forces().contacts();
        let violated =
            (0..contacts).map(|i| -self.formulation.distance(i, &self.z)).fold(response.gap_change, f64::max);
        let mut force = response.contact_force.max(self.stiffness * violated);
        if force == 0.0 {
            // The load is unchanged or its response is not known, and the last state is no solution: any scale will do.
            force = self.stiffness;
        }
        force *= self.distance;
        self.formulation.move_inside(&mut self.z, force, force / self.stiffness);
    }
}

/// Returns the stiffness with the mean compliance: the cold start of the exact cone must cover the soft nodes. On
/// stiffnesses over six decades the median fails in a quarter of the histories, this in a tenth.
fn mean_of_compliances(stiffness: &[f64]) -> f64 {
    stiffness.len() as f64 / stiffness.iter().map(|k| 1.0 / k).sum::<f64>()
}

impl IncrementSolver for PredictorCorrectorMethod {
    fn matrix(&self) -> &SystemMatrix {
        self.formulation.matrix()
    }

    /// Linearises BN's equations: at a solution both members of a pair may vanish, and then the interior point matrix
    /// is singular.
    fn linearize(&mut self) {
        self.end.linearize(&self.z);
    }

    fn linearization(&self) -> &SystemMatrix {
        self.end.formulation.jacobian()
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.formulation.clamp_contacts();
        self.formulation.unconstrained_mode().map_or(Ok(()), Err)
    }

    fn solve(&mut self, task: &Task<'_>, linear: &mut RefinedSolver, observe: Observe<'_>) -> Computed<MethodResult> {
        self.formulation.begin(task.increment, &self.z);
        self.end.formulation.begin(task.increment, &self.z);
        let scaling = *self.formulation.scaling();
        let forces = self.formulation.forces().clone();
        let before = forces.unpacked(&self.z, &scaling);
        task.response.add_to(&mut self.z);
        let error = |z: &[f64]| task.error(&forces.unpacked(z, &scaling));
        let tolerance = self.tolerance;
        self.z_lo.fill(0.0);
        // The increment is solved if the response with clamped contact nodes already solves it.
        if error(&self.z)? <= tolerance {
            return Ok(MethodResult { stop: Termination::Converged, ..MethodResult::new(0.0) });
        }
        let last = self.z.clone();
        self.move_inside(task.response);
        let mut of_yielding = |z: &[f64]| task.error_of_yielding_nodes(&forces.unpacked(z, &scaling), &before);
        let formulation = self.formulation.as_mut();
        let mut outcome = self.method.solve(formulation, linear, &mut self.z, &mut of_yielding, observe)?;
        let iterations_left = self.most.saturating_sub(outcome.iterations);
        let unfinished = self.end.formulation.has_dependent_nodes() || error(&self.z)? > tolerance;
        if iterations_left > 0 && outcome.stop != Termination::Interrupted && unfinished {
            let mut ended = self.end.solve(task, linear, &self.z, iterations_left, observe)?;
            if ended.stop == Termination::Converged {
                self.z[..self.end.z.len()].copy_from_slice(&self.end.z);
                self.z_lo.copy_from_slice(self.end.bn.z_lo());
            } else if ended.stop != Termination::Interrupted {
                // Perhaps near the solution, but not within the tolerance.
                ended.stop = match outcome.stop {
                    Termination::Converged => Termination::Stalled,
                    ref stop => stop.clone(),
                };
            }
            outcome = MethodResult { attempts: outcome.attempts, ..outcome.then(ended) };
        }
        if outcome.stop == Termination::Converged && !task.problem.rigid_modes().is_empty() {
            // Perhaps one of many solutions: takes the nearest, if it remains a solution after rounding.
            let settled = self.end.settled(&self.z, &last);
            if let Some(settled) = settled
                && error(&settled)? <= error(&self.z)?.max(tolerance)
            {
                self.z[..settled.len()].copy_from_slice(&settled);
            }
        }
        Ok(outcome)
    }

    fn state(&self) -> State {
        self.formulation.forces().unpacked_with(&self.z, &self.z_lo, self.formulation.scaling())
    }

    fn set_state(&mut self, state: &State) {
        let forces = self.formulation.forces();
        let z = forces.packed(state, self.formulation.scaling());
        self.z[..forces.unknowns()].copy_from_slice(&z);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        &mut self.z
    }

    fn snapshot(&self, _linear: &RefinedSolver) -> Snapshot {
        let linearization = Some(self.end.formulation.linearization());
        Snapshot { unknowns: self.z.clone(), z_lo: self.z_lo.clone(), linearization, ..Snapshot::default() }
    }

    fn restore(&mut self, snapshot: Snapshot, _linear: &mut RefinedSolver) -> Computed<bool> {
        let Snapshot { unknowns, z_lo, linearization, .. } = snapshot;
        let end = linearization.is_some_and(|kept| self.end.formulation.linearize_as(&kept));
        Ok(take_over(&mut self.z, &unknowns) && take_over(&mut self.z_lo, &z_lo) && end)
    }
}

/// The limit of BN's iterations. From near the solution it takes two or three; more show that it is not near.
const ITERATIONS: usize = 10;

/// BN from the end of the interior point method.
struct NewtonEnd {
    formulation: Bdiff,
    bn: Bn,
    z: Vec<f64>,
}

impl NewtonEnd {
    fn new(assembled: Assembled, natural: &FormulationScaling) -> Self {
        let formulation = Bdiff::on(assembled, natural);
        let unknowns = formulation.unknowns();
        NewtonEnd { formulation, bn: Bn::new(Armijo::HALVING, ITERATIONS, unknowns), z: vec![0.0; unknowns] }
    }

    /// Solves by BN from a `z` that begins with `(u, p_t, p_n)`, in at most `left` iterations.
    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        z: &[f64],
        left: usize,
        observe: Observe<'_>,
    ) -> Computed<MethodResult> {
        let NewtonEnd { formulation, bn, z: own } = self;
        bn.limit(left.min(ITERATIONS));
        own.copy_from_slice(&z[..formulation.unknowns()]);
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        let mut error = |z: &[f64], z_lo: &[f64]| task.error(&layout.unpacked_with(z, z_lo, &scaling));
        bn.solve(
            formulation,
            linear,
            own,
            StopCriterion::Measured { tolerance: task.tolerance, error: &mut error },
            observe,
        )
    }

    /// Returns the solution nearest to `to` along the modes that contact leaves unconstrained at `z`, which begins
    /// with `(u, p_t, p_n)`. Returns its `(u, p_t, p_n)`, or `None` if the solution is unique.
    fn settled(&mut self, z: &[f64], to: &[f64]) -> Option<Vec<f64>> {
        self.linearize(z);
        let n = self.z.len();
        self.formulation.is_pinned().then(|| self.formulation.settled(&z[..n], &to[..n]))
    }

    /// Linearises at a `z` that begins with `(u, p_t, p_n)`.
    fn linearize(&mut self, z: &[f64]) {
        self.formulation.linearize(&z[..self.z.len()]);
    }
}
