//! Algorithm BN: the B-differentiable Newton method.

use std::collections::HashSet;

use super::clock::Clock;
use super::{Armijo, Flow, IterationRecord, Outcome, Stop};
use crate::formulation::Formulation;
use crate::linear::{Direct, LinearError};
use crate::sparse::sum;

/// The constants of Algorithm BN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BnSettings {
    /// The step size rule: `β` and `σ`.
    pub armijo: Armijo,
    /// When the iteration ends.
    pub end: End,
    /// The limit of iterations.
    pub max_iterations: usize,
}

/// When the iteration ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// `Theta ≤ ε` after a step, in the unit of the formulation's `Theta`: the paper's test.
    Merit(f64),
    /// The caller's error measure is at most this, be it before the first step. It has stalled
    /// when a full step has been repeated with the same matrix, and refinement does not help. Where the step size rule
    /// finds no step along (21), the directional Newton equation (11) is tried, with the exact derivative (20).
    Error(f64),
}

/// In the places where several cases meet, the branch that a direction leads into is looked for this
/// many times; two nodes that wait for each other would go on for ever.
const BRANCH_TRIALS: usize = 3;

/// Each gains as many digits as the condition of the matrix leaves: one is the rule, three serve up to
/// 1e11 or so.
const REFINEMENTS: usize = 3;

impl BnSettings {
    /// The paper's: `β = 0.9`, `σ = 0.1`, at most 22 backtracks, `ε = 0.01`.
    pub fn paper(max_iterations: usize) -> Self {
        let armijo = Armijo { beta: 0.9, sigma: 0.1, max_backtracks: 22 };
        BnSettings { armijo, end: End::Merit(1e-2), max_iterations }
    }

    /// Ended by the error measure. Steps are halved, down to 1/64: finer ones gain nothing.
    pub fn until(tolerance: f64, max_iterations: usize) -> Self {
        let armijo = Armijo { beta: 0.5, sigma: 0.1, max_backtracks: 6 };
        BnSettings { armijo, end: End::Error(tolerance), max_iterations }
    }
}

/// Algorithm BN with its workspace.
pub struct Bn {
    settings: BnSettings,
    h: Vec<f64>,
    dz: Vec<f64>,
    rhs: Vec<f64>,
    /// What rounding leaves off `z`, where that matters.
    rest: Vec<f64>,
    /// The number of factorisations that `linear` had made after this solver's last one: if it is
    /// still the same, its factors are those of the last linearisation.
    factored: Option<usize>,
}

impl Bn {
    /// A solver for `unknowns` equations.
    pub fn new(settings: BnSettings, unknowns: usize) -> Self {
        let zeros = || vec![0.0; unknowns];
        Bn { settings, h: zeros(), dz: zeros(), rhs: zeros(), rest: zeros(), factored: None }
    }

    /// Solves `H(z) = 0` from the given `z`, which is left at the last iterate. `linear` must have
    /// analysed the pattern of the Jacobian; `error` measures a `z` with its [`Bn::rest`], for
    /// [`End::Error`].
    ///
    /// # Errors
    /// When the linear algebra cannot go on for want of memory or by misuse. A singular matrix is
    /// no error: it is a way to [`Stop`].
    pub fn solve<F: Formulation>(
        &mut self,
        formulation: &mut F,
        linear: &mut Direct,
        z: &mut [f64],
        error: &mut dyn FnMut(&[f64], &[f64]) -> f64,
        observe: &mut dyn FnMut(&IterationRecord) -> Flow,
    ) -> Result<Outcome, LinearError> {
        // Step 1: initialisation.
        let mut clock = Clock::default();
        let mut theta = clock.time(|| {
            formulation.residual(z, &mut self.h);
            formulation.merit(&self.h)
        });
        let mut outcome = Outcome::new(theta);
        self.rest.fill(0.0);
        let tolerance = match self.settings.end {
            End::Merit(_) => None,
            End::Error(tolerance) => Some(tolerance),
        };
        let measured = tolerance.map(|_| error(z, &self.rest));
        if observe(&IterationRecord { error: measured, ..IterationRecord::start(theta) }) == Flow::Stop {
            return Ok(Outcome { stop: Stop::Interrupted, ..outcome });
        }
        if tolerance.zip(measured).is_some_and(|(tolerance, error)| error <= tolerance) {
            return Ok(Outcome { stop: Stop::Met, ..outcome });
        }
        let mut cycle = Cycle::default();
        let mut full_step = false;

        for iteration in 1..=self.settings.max_iterations {
            // Step 2: the direction, H(z) + H̃'(z; dz) = 0 (22). The matrix is factored unless it is
            // that of the last direction.
            let changed = clock.time(|| formulation.linearize(z));
            let fresh = changed || self.factored != Some(linear.statistics().factorizations);
            cycle.visit(formulation.cases());
            let mut backward_error = match self.direction(formulation, linear, fresh)? {
                Ok(error) => error,
                Err(stop) => {
                    outcome.stop = stop;
                    break;
                }
            };

            // Step 3: the step size (12), and the step. A full step repeated with the same matrix
            // refines a solution: there is nothing to search.
            let refines = tolerance.is_some() && full_step && !changed;
            let (mut step, mut backtracks) =
                if refines { (1.0, 0) } else { self.step_size(formulation, z, theta, &mut clock) };
            if tolerance.is_some() && backtracks == self.settings.armijo.max_backtracks {
                for _ in 0..BRANCH_TRIALS {
                    if !formulation.linearize_towards(z, &self.dz) {
                        break;
                    }
                    let Ok(error) = self.direction(formulation, linear, true)? else { break };
                    backward_error = backward_error.max(error);
                    outcome.iterations += 1;
                    (step, backtracks) = self.step_size(formulation, z, theta, &mut clock);
                    if backtracks < self.settings.armijo.max_backtracks {
                        break;
                    }
                }
            }
            theta = clock.time(|| {
                for (z, dz) in z.iter_mut().zip(&self.dz) {
                    *z += step * dz;
                }
                formulation.residual(z, &mut self.h);
                formulation.merit(&self.h)
            });
            full_step = step == 1.0;
            outcome.add(theta, backtracks, backward_error);

            // Step 4: termination.
            let measured = tolerance.map(|_| error(z, &self.rest));
            let record = IterationRecord {
                iteration,
                theta,
                step,
                backtracks,
                backward_error,
                factored: fresh,
                error: measured,
            };
            let flow = observe(&record);
            let mut stalled = false;
            let met = match self.settings.end {
                End::Merit(epsilon) => theta <= epsilon,
                End::Error(tolerance) if measured.is_some_and(|error| error <= tolerance) => true,
                End::Error(tolerance) if refines => {
                    // Nothing is left to gain but by refinement.
                    stalled = self.refine(formulation, linear, z, tolerance, error)? > tolerance;
                    !stalled
                }
                End::Error(_) => false,
            };
            if outcome.ends(met || formulation.is_affine(), flow) {
                break;
            }
            if stalled {
                outcome.stop = Stop::Stalled;
                break;
            }
        }
        if outcome.stop == Stop::MaxIterations && cycle.closed() {
            outcome.stop = Stop::Cycling;
        }
        outcome.assembly_seconds = clock.seconds;
        Ok(outcome)
    }

    /// Solves for `dz`, with the matrix factored if it is `fresh`; returns the backward error, or why
    /// there is no direction.
    fn direction<F: Formulation>(
        &mut self,
        formulation: &F,
        linear: &mut Direct,
        fresh: bool,
    ) -> Result<Result<f64, Stop>, LinearError> {
        if fresh {
            self.factored = None;
            if let Some(motion) = formulation.unheld_motion() {
                return Ok(Err(Stop::Unheld(motion)));
            }
            if let Err(error) = linear.factorize(formulation.jacobian()) {
                return Stop::at(error).map(Err);
            }
            self.factored = Some(linear.statistics().factorizations);
        }
        // The factors solve for -dz; only its sign is turned.
        self.rhs.copy_from_slice(&self.h);
        formulation.right_hand_side(&mut self.rhs);
        let info = match linear.solve(formulation.jacobian(), &self.rhs, &mut self.dz) {
            Ok(info) => info,
            Err(error) => return Stop::at(error).map(Err),
        };
        self.dz.iter_mut().for_each(|dz| *dz = -*dz);
        Ok(Ok(info.backward_error))
    }

    /// Newton steps with the last factors from residuals in twice the working precision, as long as they
    /// gain: `z + rest` then solves the equations where the rounding of `z` alone is too coarse. Returns
    /// the error reached.
    fn refine<F: Formulation>(
        &mut self,
        formulation: &F,
        linear: &mut Direct,
        z: &mut [f64],
        tolerance: f64,
        error: &mut dyn FnMut(&[f64], &[f64]) -> f64,
    ) -> Result<f64, LinearError> {
        let mut best = error(z, &self.rest);
        for _ in 0..REFINEMENTS {
            formulation.residual_beyond(z, &self.rest, &mut self.h);
            if self.direction(formulation, linear, false)?.is_err() {
                break;
            }
            let corrected = z.iter().zip(&self.rest).zip(&self.dz).map(|((z, rest), dz)| sum(*z, rest + dz));
            let (candidate, rest): (Vec<f64>, Vec<f64>) = corrected.unzip();
            let reached = error(&candidate, &rest);
            if reached.is_nan() || reached >= best {
                break;
            }
            z.copy_from_slice(&candidate);
            self.rest = rest;
            best = reached;
            if reached <= tolerance {
                break;
            }
        }
        Ok(best)
    }

    /// Sets another limit of iterations.
    pub fn limit(&mut self, max_iterations: usize) {
        self.settings.max_iterations = max_iterations;
    }

    /// What rounding leaves off the last `z`: the solution is their sum. 0 where that does not matter.
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// (12) along the present direction.
    fn step_size<F: Formulation>(&self, formulation: &F, z: &[f64], theta: f64, clock: &mut Clock) -> (f64, usize) {
        clock.time(|| self.settings.armijo.step(theta, formulation.merit_along(z, &self.dz, &self.h)))
    }
}

/// Which sets of cases an increment has been through.
#[derive(Default)]
struct Cycle {
    seen: HashSet<Vec<u8>>,
    visits: usize,
    /// The visit that brought the last new set.
    last_new: usize,
}

impl Cycle {
    fn visit(&mut self, cases: Vec<u8>) {
        self.visits += 1;
        if self.seen.insert(cases) {
            self.last_new = self.visits;
        }
    }

    /// Whether the second half of the visits brought nothing new.
    fn closed(&self) -> bool {
        2 * self.last_new <= self.visits
    }
}

#[cfg(test)]
mod tests {
    use super::Cycle;

    #[test]
    fn a_cycle_is_closed_when_half_of_the_visits_bring_nothing_new() {
        let closed = |visits: &[u8]| {
            let mut cycle = Cycle::default();
            for &case in visits {
                cycle.visit(vec![case]);
            }
            cycle.closed()
        };
        assert!(closed(&[1, 2, 1, 2]));
        assert!(closed(&[1, 2, 3, 2, 3, 2]));
        assert!(!closed(&[1, 2, 3, 2, 3]));
        assert!(!closed(&[1, 2, 3, 4]));
    }
}
