//! The strategy: what is tried for an increment, in which order.
//!
//! | attempt | start | at most |
//! | --- | --- | --- |
//! | Algorithm BN, with `method = "bn"` | the last solution and the tangent there, or the response with clamped contact nodes | 40 iterations; alone, as many as are allowed |
//! | the interior point method | the last solution, moved away from the border by the distance that fits the load | 30 iterations |
//! | the interior point method | ten times that distance | 30 iterations |
//! | the interior point method | a hundred times that distance | the iterations that are left |
//!
//! If a state shows that the body slides or leaves its obstacles (see below), nothing is. It is looked for before the first
//! attempt if the friction of the last normal forces does not suffice, and else after it. If an attempt of the interior point
//! method comes near a solution, BN finishes it in at most ten iterations. If no attempt solves a substep and the working set
//! lacks nodes, the set grows. Otherwise the substep is halved, at most six times (`increment.rs`). A method of the paper is not
//! in this table: `algorithm.rs` creates it alone, and its increments are not halved.
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
//! A small drag on the contact nodes, `D (u - u_last)` in (15), determines every motion. BN solves this increment in a few
//! iterations. Let `v` be a rigid motion on which the loads do more work than the friction of its normal forces takes up,
//! without approach of any node and without loss of a pressed one. If all contact nodes keep their cases however far the body
//! moves along `v`, then the body moves without end: the drag carries the excess, however small it is. If an equilibrium
//! existed, a body with a vanishing drag would have two states, one at rest and one that moves. That is excluded where the
//! solution of such an increment is unique, which is assumed.

use super::bn::BnMethod;
use super::increment_error::IncrementErrors;
use super::predictor_corrector::PredictorCorrectorMethod;
use super::saved::Snapshot;
use super::settings::HistorySettings;
use super::task::{IncrementSolver, Observe, Task};
use crate::algebra::linear::{Computed, RefinedSolver, SystemMatrix};
use crate::solver::formulation::Bdiff;
use crate::solver::laws::coulomb::TangentialCase;
use crate::solver::newton::{Armijo, Bn, MethodResult, StopCriterion, Termination};
use crate::solver::problem::{Increment, State};
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
const IP_START_1: Attempt = Attempt { distance: Some(1.0), patience: 30 };
const IP_START_10: Attempt = Attempt { distance: Some(10.0), patience: 30 };
const IP_START_100: Attempt = Attempt { distance: Some(100.0), patience: usize::MAX };

/// Returns `true` if no other attempt is needed.
fn ends(result: &MethodResult) -> bool {
    use Termination::{Converged, Interrupted, NoEquilibrium, Slips};
    matches!(result.stop, Converged | Interrupted | Slips(_) | NoEquilibrium(_))
}

/// The attempts of BN without the interior point method.
pub(super) const BN_ALONE: &[Attempt] = &[Attempt { patience: usize::MAX, ..NEWTON }];

/// The attempts of `method = "bn"`.
pub(super) const BN: &[Attempt] = &[NEWTON, IP_START_1, IP_START_10, IP_START_100];

/// The attempts of `method = "ip"`.
pub(super) const IP: &[Attempt] = &[IP_START_1, IP_START_10, IP_START_100];

/// The error of an increment with a drag, which is to tell pressures and statuses only.
const DRAGGED: f64 = 1e-6;

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

    /// Solves the increment with a drag, from the state `last`, or from where the loads exceed the friction of the normal forces
    /// `p_n` (n_c, N). Ends the increment if the body slides there or leaves its obstacles.
    fn slide(
        &mut self,
        task: &Task<'_>,
        linear: &mut RefinedSolver,
        last: &State,
        p_n: &[f64],
        observe: Observe<'_>,
    ) -> Computed<MethodResult> {
        let (problem, increment) = (task.problem, task.increment);
        let excess = |p_n: &[f64], motion: &[f64]| excess(problem, increment.mu, increment.force, p_n, motion);
        let mut formulation = Bdiff::on(self.bn.formulation.assembled(), &self.settings.conventions);
        let mut bn = Bn::new(Armijo::HALVING, NEWTON.patience, formulation.unknowns());
        let (layout, scaling) = (formulation.layout().clone(), *formulation.scaling());
        let from = layout.packed(last, &scaling);
        formulation.begin(increment, &from);
        let drag = formulation.drag_from(&from);
        let mut z = from.clone();
        task.response.add_to(&mut z);
        if task.first {
            task.response.add_forces_to(&mut z);
        }
        if let Some(motion) = motion_against(task, p_n) {
            // The drag carries what exceeds friction.
            let v = problem.rigid_motion(&motion);
            let resistance: f64 = v.iter().zip(&drag).map(|(v, drag)| v * v * drag).sum();
            let speed = excess(p_n, &motion) / (resistance * scaling.force);
            z.iter_mut().zip(&v).for_each(|(z, v)| *z += speed * v);
        }
        let mut error = |z: &[f64], z_lo: &[f64]| {
            let force = increment.force.iter().zip(&drag).enumerate();
            let force: Vec<f64> = force.map(|(k, (f, drag))| f - drag * (z[k] - from[k]) * scaling.force).collect();
            task.error_of(&Increment { force: &force, ..*increment }, &layout.unpacked_with(z, z_lo, &scaling))
        };
        let end = StopCriterion::Measured { tolerance: DRAGGED, error: &mut error };
        let mut result = bn.solve(&mut formulation, linear, &mut z, end, observe)?;
        let state = layout.unpacked(&z, &scaling);
        formulation.linearize(&z);
        if let (Termination::Converged, Some(motion)) = (&result.stop, motion_against(task, &state.p_n)) {
            // At the very limit of friction the excess is rounding, and the joint still holds.
            let v = problem.rigid_motion(&motion);
            let friction = friction_work(problem, increment.mu, &state.p_n, &v);
            let moves = excess(&state.p_n, &motion) > DRAGGED * friction;
            if moves && formulation.keeps_cases_along(&z, v, &problem.natural().contact_part) {
                result.stop =
                    if friction > 0.0 { Termination::Slips(motion) } else { Termination::NoEquilibrium(motion) };
            }
        }
        if result.stop == Termination::Converged {
            // The drag still carries something.
            result.stop = Termination::Stalled;
        }
        self.bn.set_state(&state);
        Ok(MethodResult { attempts: 0, ..result })
    }
}

/// Returns a rigid motion on which the load does more work than the friction of the normal forces `p_n` (n_c, N).
fn motion_against(task: &Task<'_>, p_n: &[f64]) -> Option<Vec<f64>> {
    let force = task.increment.force;
    let sizes: Vec<f64> = force.iter().map(|f| f.abs()).collect();
    let is_finite = p_n.iter().all(|p| p.is_finite());
    is_finite.then(|| sliding_motion(task.problem, task.increment.mu, &Load { force, sizes: &sizes }, p_n))?
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
    fn solve(&mut self, task: &Task<'_>, linear: &mut RefinedSolver, observe: Observe<'_>) -> Computed<MethodResult> {
        let last = if task.first { State::zero(task.problem) } else { self.bn.state() };
        // The forces that clamp the nodes are the first estimate of the pressures.
        let clamping = || task.response.p_n(last.p_n.len()).iter().map(|p| p * self.settings.scaling.force).collect();
        let pressed: Vec<f64> = if task.first { clamping() } else { last.p_n.clone() };
        let mut is_tested = task.problem.rigid_modes().is_empty();
        let mut tested = MethodResult::nothing();
        if pressed.iter().any(|p| *p > 0.0) && motion_against(task, &pressed).is_some() {
            tested = self.slide(task, linear, &last, &pressed, observe)?;
            if ends(&tested) {
                return Ok(tested);
            }
            self.bn.set_state(&last);
            is_tested = true;
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
            // A body that BN finds held may only need the interior point method.
            let is_free = matches!(reached.stop, Termination::Unconstrained(_) | Termination::Singular(_));
            if !is_tested && (is_free || attempt.distance.is_some() || self.attempts.len() == 1) {
                let p_n = self.bn.state().p_n;
                tested = self.slide(task, linear, &last, &p_n, observe)?;
                if ends(&tested) {
                    return Ok(reached.then(tested));
                }
                is_tested = true;
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
    ) -> Computed<Option<State>> {
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

    fn restore(&mut self, mut snapshot: Snapshot, linear: &mut RefinedSolver) -> Computed<bool> {
        if let Some(rescue) = snapshot.rescue.take() {
            let ip = self.ip.insert(PredictorCorrectorMethod::beside(self.bn.formulation.assembled(), &self.settings));
            if !ip.restore(*rescue, linear)? {
                return Ok(false);
            }
        }
        self.bn.restore(snapshot, linear)
    }
}
