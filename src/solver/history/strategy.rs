//! The strategy: what is tried for an increment, in which order.
//!
//! | attempt | start | at most |
//! | --- | --- | --- |
//! | Algorithm BN, with `method = "bn"` | the last solution and the tangent there, or the response with clamped contact nodes | 40 iterations; alone, as many as are allowed |
//! | the interior point method | the last solution, moved away from the border by the distance that fits the load | 30 iterations |
//! | the interior point method | ten times that distance | 30 iterations |
//! | the interior point method | a hundred times that distance | the iterations that are left |
//!
//! If a state shows that the body slides whatever is tried (see below), nothing is. It is looked for before the first attempt
//! and after it. If an attempt of the interior point method comes near a solution, BN finishes it in at most ten iterations. If no
//! attempt solves a substep and the working set lacks nodes, the set grows. Otherwise the substep is halved, at most six
//! times (`increment.rs`). A method of the paper is not in this table: `algorithm.rs` creates it alone, and its increments
//! are not halved.
//!
//! | of 615 random scenes | converge |
//! | --- | --- |
//! | all attempts | 479 |
//! | BN alone | 474 |
//! | the interior point method from the first start | 472 |
//! | the interior point method from the first two starts | 477 |
//!
//! # The slip of a joint as a whole
//!
//! This is the criterion by which an increment that does not converge has no equilibrium at its end.
//!
//! Let a rigid motion `v` move the body along its contact, and let friction act against `v` at every node that presses.
//! The equations of this *sliding state*, with a drag along `v`, have neither a history nor a slip: they depend
//! only on the loads, gaps and friction at the end of the increment. If the loads do more work on `v` than friction
//! takes up, and all laws of contact hold however far the body moves along `v`, then the body slides without end while
//! a drag proportional to its velocity carries the excess, for any such drag. If an equilibrium existed, a body with a
//! vanishing drag would have two states, one at rest and one that slides. That is excluded where the solution of such an
//! increment is unique, which is assumed.
//!
//! The motion is that of a rigid body with the normal forces of the last state; a linear solve gives the forces of its
//! sliding state, and these the next motion. Where the load takes pressure off the joint, that friction still suffices: then the
//! first motion is that against half of it.

use super::bn::BnMethod;
use super::increment_error::IncrementErrors;
use super::predictor_corrector::PredictorCorrectorMethod;
use super::saved::Snapshot;
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{LinearError, RefinedSolver, SystemMatrix};
use crate::algebra::vector::dot;
use crate::solver::laws::coulomb::TangentialCase;
use crate::solver::newton::{MethodResult, Termination};
use crate::solver::problem::State;
use crate::solver::solvability::{Load, excess, friction_work, sliding_motion};

/// An attempt at an increment.
#[derive(Clone, Copy)]
pub(super) struct Attempt {
    /// The distance from the border at which the interior point method starts, as a multiple of the one that the load
    /// suggests; `None` for BN.
    distance: Option<f64>,
    /// The number of iterations after which the attempt is abandoned, without those of BN at its end. No attempt that
    /// solves an increment of the tests takes as many.
    patience: usize,
}

const NEWTON: Attempt = Attempt { distance: None, patience: 40 };
const NEAR: Attempt = Attempt { distance: Some(1.0), patience: 30 };
const FAR: Attempt = Attempt { distance: Some(10.0), patience: 30 };
const FARTHEST: Attempt = Attempt { distance: Some(100.0), patience: usize::MAX };

/// Returns `true` if no other attempt is needed.
fn ends(result: &MethodResult) -> bool {
    matches!(result.stop, Termination::Converged | Termination::Interrupted | Termination::Slips(_))
}

/// The attempts of BN without the interior point method.
pub(super) const BN_ALONE: &[Attempt] = &[Attempt { patience: usize::MAX, ..NEWTON }];

/// The attempts of `method = "bn"`.
pub(super) const BN: &[Attempt] = &[NEWTON, NEAR, FAR, FARTHEST];

/// The attempts of `method = "ip"`.
pub(super) const IP: &[Attempt] = &[NEAR, FAR, FARTHEST];

/// The largest number of linear solves. The nodes that press in the sliding state are those of the last state but for a
/// few.
const ROUNDS: usize = 4;

/// The attempts, with the methods that make them.
pub(super) struct Strategy {
    attempts: &'static [Attempt],
    settings: HistorySettings,
    /// BN, which has the state of the history and the estimate of its time-step error.
    bn: Box<BnMethod>,
    /// The interior point method, created when it is first needed.
    ip: Option<PredictorCorrectorMethod>,
}

impl Strategy {
    /// Creates these attempts.
    pub(super) fn new(bn: BnMethod, settings: &HistorySettings, attempts: &'static [Attempt]) -> Self {
        Strategy { attempts, settings: settings.clone(), bn: Box::new(bn), ip: None }
    }

    /// Returns the normal forces that clamp the nodes, N: the first estimate of the pressures.
    fn clamping_forces(&self, task: &Task<'_>) -> Vec<f64> {
        let clamping = task.response.p_n(task.problem.contacts());
        clamping.into_iter().map(|p| p * self.settings.scaling.force).collect()
    }

    /// Looks for a sliding state, from the normal forces `pressed` (n_c, N) and this `share` of their friction. Returns the
    /// solves that it took, and moves to the sliding state if there is one.
    fn slide(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        last: &State,
        (pressed, share): (&[f64], f64),
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let (problem, increment) = (task.problem, task.increment);
        let sizes: Vec<f64> = increment.force.iter().map(|f| f.abs()).collect();
        let load = Load { force: increment.force, sizes: &sizes };
        let BnMethod { formulation, bn, .. } = &mut *self.bn;
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        let mut result = MethodResult::nothing();
        // Without pressure nothing is known of the contact.
        let presses = pressed.iter().all(|p| p.is_finite()) && pressed.iter().any(|p| *p > 0.0);
        let rounds = if presses { ROUNDS } else { 0 };
        let from = layout.packed(last, &scaling);
        let (mut z, mut p_n) = (from.clone(), pressed.to_vec());
        for round in 0..rounds {
            if round == ROUNDS / 2 {
                p_n.copy_from_slice(pressed);
            }
            let share = if round == 0 { share } else { 1.0 };
            let mu: Vec<f64> = increment.mu.iter().map(|mu| share * mu).collect();
            let Some(motion) = sliding_motion(problem, &mu, &load, &p_n) else { break };
            // Pins carry what exceeds the friction of these forces. If that is much, it changes the pressure at these nodes:
            // then a drag spreads it over the body.
            let v = problem.rigid_motion(&motion);
            let much = excess(problem, increment.mu, increment.force, &p_n, &motion) / (dot(&v, &v) * scaling.force);
            let drag = if round < ROUNDS / 2 { 0.0 } else { much };
            let drag: Vec<f64> = v.iter().map(|v| drag * v).collect();
            formulation.begin(increment, &from);
            formulation.linearize_sliding(&p_n, &motion);
            if !bn.solve_cases(formulation, linear, &drag, &mut z, &mut result, observe)? {
                break;
            }
            p_n = formulation.pressing(&z).into_iter().map(|p| p * scaling.force).collect();
            // At the very limit of friction the excess is rounding, and the joint still holds.
            let limit = task.tolerance * friction_work(problem, increment.mu, &p_n, &v);
            let slides = excess(problem, increment.mu, increment.force, &p_n, &motion) > limit;
            if slides && formulation.slides_on(&z, &motion, &problem.natural().contact_part) {
                result.stop = Termination::Slips(motion);
                self.bn.set_state(&layout.unpacked(&z, &scaling));
                break;
            }
        }
        Ok(result)
    }
}

impl IncrementSolver for Strategy {
    fn matrix(&self) -> &SystemMatrix {
        self.bn.matrix()
    }

    fn linearize(&mut self) {
        self.bn.linearize();
    }

    fn clamp_contacts(&mut self) -> Result<(), Vec<f64>> {
        self.bn.clamp_contacts()
    }

    fn starts_on_tangent(&self, linear: &RefinedSolver) -> bool {
        self.bn.starts_on_tangent(linear)
    }

    /// Makes one attempt after the other, each from the last solution, until one solves the increment.
    fn solve(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        observe: Observe<'_>,
    ) -> Result<MethodResult, LinearError> {
        let last = self.bn.last_solution(task);
        let pressed = if task.first { self.clamping_forces(task) } else { last.p_n.clone() };
        let mut tested = self.slide(task, linear, &last, (&pressed, 1.0), observe)?;
        if ends(&tested) {
            return Ok(tested);
        }
        let mut result: Option<MethodResult> = None;
        for attempt in self.attempts {
            let Strategy { settings, bn, ip, .. } = self;
            let left = settings.max_iterations.saturating_sub(result.as_ref().map_or(0, |result| result.iterations));
            if left == 0 {
                break;
            }
            let tried = match attempt.distance {
                None => {
                    bn.bn.limit(left.min(attempt.patience));
                    bn.solve(task, linear, observe)?
                }
                Some(distance) => {
                    let leads = self.attempts[0].distance.is_some();
                    if leads && result.is_none() {
                        bn.begin(task, None, linear)?;
                    }
                    let ip = ip
                        .get_or_insert_with(|| PredictorCorrectorMethod::beside(bn.formulation.assembled(), settings));
                    ip.set_state(&last);
                    ip.start_at(distance, attempt.patience, left);
                    let mut tried = ip.solve(task, linear, observe)?;
                    tried.rescued = !leads && tried.stop == Termination::Converged;
                    if leads || tried.rescued {
                        bn.set_state(&ip.state());
                    }
                    if tried.stop == Termination::Converged {
                        bn.follow(task.problem, linear)?;
                    } else if let (Some(result), false) = (&result, leads || tried.stop == Termination::Interrupted) {
                        // The termination of BN is more informative.
                        tried.stop.clone_from(&result.stop);
                    }
                    tried
                }
            };
            let reached = match result.take() {
                None => tried,
                Some(before) => before.then(tried),
            };
            if ends(&reached) {
                return Ok(tested.then(reached));
            }
            // The first attempt tells the pressures.
            if result.is_none() {
                let p_n = self.bn.state().p_n;
                for (p_n, share) in [(&p_n, 1.0), (&pressed, 0.5)] {
                    let again = self.slide(task, linear, &last, (p_n, share), observe)?;
                    if ends(&again) {
                        return Ok(tested.then(reached).then(again));
                    }
                    tested = tested.then(again);
                }
            }
            result = Some(reached);
        }
        Ok(tested.then(result.unwrap_or_else(|| MethodResult::new(f64::NAN))))
    }

    fn state(&self) -> State {
        self.bn.state()
    }

    fn ahead(
        &mut self,
        start: &[f64],
        cases: &[(bool, TangentialCase)],
        linear: &mut RefinedSolver,
    ) -> Result<Option<State>, LinearError> {
        self.bn.ahead(start, cases, linear)
    }

    fn set_state(&mut self, state: &State) {
        self.bn.set_state(state);
    }

    fn unknowns(&mut self) -> &mut Vec<f64> {
        self.bn.unknowns()
    }

    fn increment_errors(&mut self) -> Option<&mut IncrementErrors> {
        self.bn.increment_errors()
    }

    fn snapshot(&self, linear: &RefinedSolver) -> Snapshot {
        let rescue = self.ip.as_ref().map(|ip| Box::new(ip.snapshot(linear)));
        Snapshot { rescue, ..self.bn.snapshot(linear) }
    }

    fn restore(&mut self, mut snapshot: Snapshot, linear: &mut RefinedSolver) -> Result<bool, LinearError> {
        if let Some(rescue) = snapshot.rescue.take() {
            let ip = self.ip.insert(PredictorCorrectorMethod::beside(self.bn.formulation.assembled(), &self.settings));
            if !ip.restore(*rescue, linear)? {
                return Ok(false);
            }
        }
        self.bn.restore(snapshot, linear)
    }
}
