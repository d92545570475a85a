//! The predictor–corrector method along a history: where an increment starts.

use super::held::Response;
use super::method::{IncrementSolver, Task};
use super::newton_end::NewtonEnd;
use super::settings::HistorySettings;
use crate::formulation::{Constrained, Conventions};
use crate::linear::{Direct, LinearError};
use crate::nonlinear::{Flow, IterationRecord, Outcome, PredictorCorrector, PredictorCorrectorSettings, Stop};
use crate::problem::{ContactProblem, State};
use crate::scene::{NewtonSystem, Partition};
use crate::sparse::Csc;

/// How far inside the attempts at an increment start, in terms of the estimate. The first is the
/// fastest and nearly always enough: of 12000 increments with random loads, gaps, friction and
/// stiffness it stalled in one and crawled in three; the second got through all.
const ATTEMPTS: [f64; 3] = [1.0, 10.0, 100.0];
/// After so many iterations an attempt is given up for the next one: more than any increment of the
/// tests takes.
const PATIENCE: usize = 30;

/// The error at which BN takes over, unless the tolerance is larger: near enough for the contact
/// statuses, and within what rounding leaves in slender bodies.
const NEAR: f64 = 1e-8;

pub(super) struct PredictorCorrectorMethod<'a> {
    problem: &'a ContactProblem,
    formulation: Constrained,
    settings: PredictorCorrectorSettings,
    method: PredictorCorrector,
    /// The median stiffness of a contact node along its normal, scaled. Only its order of magnitude matters.
    stiffness: f64,
    /// For the end by BN.
    natural: Conventions,
    z: Vec<f64>,
    /// What rounding leaves off `(u, p_t, p_n)`.
    rest: Vec<f64>,
    /// Made when it is first needed.
    end: Option<NewtonEnd>,
}

impl<'a> PredictorCorrectorMethod<'a> {
    pub(super) fn new(
        problem: &'a ContactProblem,
        history: &HistorySettings,
        settings: PredictorCorrectorSettings,
        newton: NewtonSystem,
    ) -> Self {
        let HistorySettings { scaling, conventions, .. } = history;
        let formulation = Constrained::new(problem, *scaling, conventions, Partition::Products, newton);
        PredictorCorrectorMethod {
            stiffness: median(&history.contact_stiffness) / scaling.stiffness(),
            natural: Conventions::of_stiffness(&history.contact_stiffness),
            z: vec![0.0; formulation.layout().unknowns()],
            rest: vec![0.0; formulation.layout().forces().unknowns()],
            end: None,
            method: PredictorCorrector::default(),
            problem,
            formulation,
            settings,
        }
    }

    /// Takes over the last state of another method, with so many iterations left.
    pub(super) fn go_on_from(&mut self, state: &State, left: usize) {
        self.settings.max_iterations = left;
        let forces = self.formulation.layout().forces();
        let z = forces.pack(state, self.formulation.scaling());
        self.z[..forces.unknowns()].copy_from_slice(&z);
    }

    /// Moves the pairs into the interior: as far from the last solution as the change of the load
    /// calls for. It is estimated from the contact forces that would hold the nodes in place and
    /// from the gaps that change or are violated, and taken `times` as far; ten times too much or too
    /// little costs a few iterations.
    fn move_inside(&mut self, response: &Response, times: f64) {
        let layout = self.formulation.layout();
        let contacts = layout.forces().contacts();
        let violated =
            (0..contacts).map(|i| -self.formulation.distance(i, &self.z)).fold(response.gap_change, f64::max);
        let mut force = response.contact_force.max(self.stiffness * violated);
        if force == 0.0 {
            // The load is the same, and still the last state is no solution: any scale will do.
            force = self.stiffness;
        }
        force *= times;
        let length = force / self.stiffness;
        for i in 0..contacts {
            let (p_n, v_n) = (layout.forces().p_n(i), layout.v_n(i));
            let pressure = self.z[p_n].max(0.0);
            if let Some(p_t) = layout.forces().p_t(i) {
                let (mu, s, lambda) = (self.formulation.mu()[i], layout.s(p_t), layout.lambda(p_t));
                for (sign, s, lambda) in [(1.0, s[0], lambda[0]), (-1.0, s[1], lambda[1])] {
                    let reserve = (mu * pressure - sign * self.z[p_t]).max(0.0);
                    (self.z[s], self.z[lambda]) = central_pair(reserve, mu * force, 0.0, length);
                }
            }
            let distance = self.formulation.distance(i, &self.z).max(0.0);
            (self.z[p_n], self.z[v_n]) = central_pair(pressure, force, distance, length);
        }
    }
}

/// The pair with the product `force · length` nearest to a force `x` and a length `y` of which one
/// is about zero: the positive root of `a - 1/a = x/force - y/length`.
fn central_pair(x: f64, force: f64, y: f64, length: f64) -> (f64, f64) {
    let q = x / force - y / length;
    // The larger of a and 1/a, without cancellation.
    let larger = 0.5 * (q.abs() + q.hypot(2.0));
    let a = if q > 0.0 { larger } else { 1.0 / larger };
    (force * a, length / a)
}

/// The median, or 1 of nothing.
fn median(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    if values.is_empty() { 1.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

impl IncrementSolver for PredictorCorrectorMethod<'_> {
    fn matrix(&self) -> &Csc {
        self.formulation.matrix()
    }

    fn linearize(&mut self) {
        self.formulation.linearize(&self.z);
    }

    fn hold_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.formulation.hold_contacts();
        self.formulation.unheld_motion().map_or(Ok(()), Err)
    }

    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut Direct,
        observe: &mut dyn FnMut(&IterationRecord) -> Flow,
    ) -> Result<Outcome, LinearError> {
        self.formulation.begin(task.increment);
        task.response.add_to(&mut self.z);
        let (problem, scaling) = (self.problem, *self.formulation.scaling());
        let forces = self.formulation.layout().forces().clone();
        let mut error = |z: &[f64]| task.error(problem, &forces.unpack(z, &scaling));
        let tolerance = self.settings.tolerance;
        self.rest.fill(0.0);
        // An increment in which nothing happens that the held body does not do by itself is solved.
        if error(&self.z) <= tolerance {
            return Ok(Outcome { stop: Stop::Met, ..Outcome::new(0.0) });
        }
        let last = self.z.clone();
        let mut outcome = Outcome::new(f64::NAN);
        for times in ATTEMPTS {
            self.z.copy_from_slice(&last);
            self.move_inside(task.response, times);
            let left = self.settings.max_iterations.saturating_sub(outcome.iterations);
            let last_attempt = times == ATTEMPTS[ATTEMPTS.len() - 1];
            let max_iterations = if last_attempt { left } else { left.min(PATIENCE) };
            let settings = PredictorCorrectorSettings { max_iterations, tolerance: tolerance.max(NEAR) };
            let attempt =
                self.method.solve(&settings, &mut self.formulation, linear, &mut self.z, &mut error, observe)?;
            outcome = outcome.then(attempt);
            let left = self.settings.max_iterations.saturating_sub(outcome.iterations);
            if left > 0 && outcome.stop != Stop::Interrupted && error(&self.z) > tolerance {
                let end = self.end.get_or_insert_with(|| NewtonEnd::new(problem, scaling, &self.natural, tolerance));
                let mut ended = end.solve(problem, task, linear, &self.z, left, observe)?;
                if ended.stop == Stop::Met {
                    let (z, rest) = end.reached();
                    self.z[..z.len()].copy_from_slice(z);
                    self.rest.copy_from_slice(rest);
                } else if ended.stop != Stop::Interrupted {
                    // Near the solution perhaps, but not within the tolerance.
                    ended.stop = if outcome.stop == Stop::Met { Stop::Stalled } else { outcome.stop.clone() };
                }
                outcome = outcome.then(ended);
            }
            if matches!(outcome.stop, Stop::Met | Stop::Interrupted)
                || outcome.iterations >= self.settings.max_iterations
            {
                break;
            }
        }
        Ok(outcome)
    }

    fn state(&self) -> State {
        self.formulation.layout().forces().unpack_with(&self.z, &self.rest, self.formulation.scaling())
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        &mut self.z
    }
}

#[cfg(test)]
mod tests {
    use super::central_pair;

    #[test]
    fn a_central_pair_keeps_what_is_large() {
        for (x, y) in [(0.0, 0.0), (5.0, 0.0), (0.0, 7.0), (1e12, 0.0), (0.0, 1e12)] {
            let (a, b) = central_pair(x, 2.0, y, 3.0);
            assert!((a * b / 6.0 - 1.0).abs() < 1e-12, "{a} {b}");
            assert!((a / 2.0 - b / 3.0 - (x / 2.0 - y / 3.0)).abs() <= 1e-12 * (a + b));
        }
    }
}
