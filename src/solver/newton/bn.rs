//! Algorithm BN: the B-differentiable Newton method. Steps 1 to 4 of the paper are marked in [`Bn::solve`]. `H` (19) and its
//! linearisation (21) are assembled in `formulation/bdiff.rs` from the rows of a node in `laws/coulomb.rs`; the step size (12) is in `armijo.rs`, the stopping tests in
//! [`StopCriterion`], what goes beyond the paper in `bn/extensions.rs`.

mod extensions;

use super::{Armijo, Clock, Iteration, IterationRecord, LinearSystem, MethodResult, Termination};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::solver::formulation::Bdiff;
use extensions::Branch;
use std::collections::HashSet;
use std::ops::ControlFlow;

/// Algorithm BN with its workspace.
pub struct Bn {
    armijo: Armijo,
    max_iterations: usize,
    h: Vec<f64>,
    dz: Vec<f64>,
    rhs: Vec<f64>,
    /// The low-order part of `z`, where it matters.
    z_lo: Vec<f64>,
    /// The generation of the factors in `linear` after this method's last factorisation. If it is unchanged, they are
    /// still the factors of the last linearisation.
    factored: Option<usize>,
    /// The accuracy of the directions, if a measured error reveals their residuals.
    forcing: Option<Forcing>,
}

/// The backward error of a direction, or the reason why there is none.
type Direction = Result<f64, Termination>;

impl Bn {
    /// Creates a workspace for `unknowns` equations, with this rule for the step size.
    pub fn new(armijo: Armijo, max_iterations: usize, unknowns: usize) -> Self {
        let zeros = || vec![0.0; unknowns];
        Bn {
            armijo,
            max_iterations,
            h: zeros(),
            dz: zeros(),
            rhs: zeros(),
            z_lo: zeros(),
            factored: None,
            forcing: None,
        }
    }

    /// Solves `H(z) = 0` from the given `z`, and leaves the last iterate in `z`, with its [`Bn::z_lo`]. `linear` must
    /// have analysed the pattern of the Jacobian, and `z` must have [`Bdiff::unknowns`] entries.
    ///
    /// # Errors
    /// If the linear solver fails for lack of memory or misuse. A singular matrix is no error, but a [`Termination`].
    pub fn solve(
        &mut self,
        formulation: &mut Bdiff,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        mut end: StopCriterion<'_>,
        observe: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Computed<MethodResult> {
        // Step 1: initialisation.
        expect_unknowns(formulation, &self.h, z)?;
        let mut clock = Clock::default();
        let mut theta = clock.time(|| self.evaluate(formulation, z))?;
        let mut outcome = MethodResult::new(theta);
        self.z_lo.fill(0.0);
        let mut error = end.measure(z, &self.z_lo)?;
        if observe(&Iteration::start(theta, error)).is_break() {
            return Ok(MethodResult { stop: Termination::Interrupted, ..outcome });
        }
        // The paper's test applies only after a step.
        if end.is_met(f64::INFINITY, error) {
            return Ok(MethodResult { stop: Termination::Converged, ..outcome });
        }
        self.forcing = end.is_measured().then(Forcing::default);
        let (mut cycle, mut full_step) = (Cycle::default(), false);

        for iteration in 1..=self.max_iterations {
            // Step 2: the direction, H(z) + H̃'(z; dz) = 0 (22), instead of (11). The matrix is factored unless it is
            // that of the last direction.
            let changed = clock.time(|| formulation.linearize(z));
            let factored = changed || self.factored != Some(linear.generation());
            cycle.visit(formulation.cases());
            // Where rows depend on each other, this solves the proximal equations for the reference forces so far.
            if full_step && !changed && formulation.refer_to(z) {
                theta = clock.time(|| self.evaluate(formulation, z))?;
            }
            let backward_error = match self.direction(formulation, linear, factored)? {
                Ok(error) => error,
                Err(stop) => {
                    outcome.stop = stop;
                    break;
                }
            };

            // Step 3: the step size (12), and the step. A full step repeated with the same matrix refines a solution
            // and needs no search.
            let repeated = end.is_measured() && full_step && !changed;
            let mut branch = Branch { step: 1.0, backtracks: 0, backward_error, solves: 0 };
            if !repeated {
                (branch.step, branch.backtracks) = clock.time(|| self.step_size(formulation, z, theta));
            }
            if end.is_measured() && branch.backtracks == self.armijo.max_backtracks {
                self.branch_ahead(&mut branch, formulation, linear, z, theta)?;
            }
            let Branch { step, backtracks, backward_error, solves } = branch;
            theta = clock.time(|| {
                z.iter_mut().zip(&self.dz).for_each(|(z, dz)| *z += step * dz);
                self.evaluate(formulation, z)
            })?;
            full_step = step == 1.0;
            outcome.iterations += solves;
            outcome.add(theta, backtracks, backward_error);

            // Step 4: termination.
            error = end.measure(z, &self.z_lo)?;
            let record = IterationRecord { iteration, theta, step, backtracks, backward_error, factored, error };
            let flow = observe(&Iteration { record, system: Some(self.system(formulation)) });
            let mut converged = formulation.is_referred() && end.is_met(theta, error);
            if (repeated || formulation.is_affine() && end.is_measured()) && !converged {
                // Only refinement, or a motion along an unconstrained mode, can still reduce the error.
                converged = self.refine(formulation, linear, z, &mut end)?;
                match self.motion_ahead(formulation, z, converged) {
                    None => theta = self.evaluate(formulation, z)?,
                    Some(stop) => outcome.stop = stop,
                }
            }
            // Affine equations have this one solution; whether it is good enough is for the verdict.
            if outcome.ends(converged || formulation.is_affine(), flow) || outcome.stop != Termination::MaxIterations {
                break;
            }
        }
        if outcome.stop == Termination::MaxIterations {
            outcome.stop = match formulation.unconstrained_mode() {
                Some(motion) => Termination::Unconstrained(motion),
                None if cycle.closed() => Termination::Cycling,
                None => Termination::MaxIterations,
            };
        }
        outcome.assembly_seconds = clock.seconds;
        Ok(outcome)
    }

    /// Evaluates `H(z)`. Returns its merit `Theta` (10).
    fn evaluate(&mut self, formulation: &Bdiff, z: &[f64]) -> Computed<f64> {
        formulation.residual(z, &mut self.h)?;
        Ok(formulation.merit(&self.h))
    }

    /// Solves (22) for `dz`, with the matrix factored if it is `fresh`. Returns the backward error, or the reason why
    /// there is no direction.
    fn direction(&mut self, formulation: &Bdiff, linear: &mut RefinedSolver, fresh: bool) -> Computed<Direction> {
        if fresh {
            self.factored = None;
            if let Some(motion) = formulation.unpinned_mode() {
                return Ok(Err(Termination::Unconstrained(motion)));
            }
            if let Err(error) = linear.factorize(formulation.jacobian()) {
                return Termination::at(error).map(Err);
            }
            self.factored = Some(linear.generation());
        }
        self.rhs.copy_from_slice(&self.h);
        formulation.right_hand_side(&mut self.rhs);
        self.rhs.iter_mut().for_each(|b| *b = -*b);
        let solved = match &mut self.forcing {
            Some(forcing) if fresh => {
                linear.solve_to(forcing.term(&self.rhs), formulation.jacobian(), &self.rhs, &mut self.dz)
            }
            _ => linear.solve(formulation.jacobian(), &self.rhs, &mut self.dz),
        };
        match solved {
            Ok(info) => Ok(Ok(info.backward_error)),
            Err(error) => Termination::at(error).map(Err),
        }
    }

    /// Solves for the change of `z` that removes a residual `h`, with the factors of the last linearisation, if
    /// `linear` still has them. This does not count as an iteration.
    ///
    /// # Errors
    /// As [`Bn::solve`].
    pub fn substitute(
        &mut self,
        formulation: &Bdiff,
        linear: &mut RefinedSolver,
        h: &[f64],
    ) -> Computed<Option<&[f64]>> {
        if self.factored != Some(linear.generation()) {
            return Ok(None);
        }
        self.rhs.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        match linear.solve(formulation.jacobian(), &self.rhs, &mut self.dz) {
            Ok(_) => Ok(Some(&self.dz)),
            Err(error) => Termination::at(error).map(|_| None),
        }
    }

    /// Applies (12) along the present direction. Returns the step and the number of times it was shortened.
    fn step_size(&self, formulation: &Bdiff, z: &[f64], theta: f64) -> (f64, usize) {
        self.armijo.step(theta, formulation.merit_along(z, &self.dz, &self.h))
    }

    /// Returns the low-order part of the last `z`: the solution is their sum. It is 0 where it does not matter.
    pub fn z_lo(&self) -> &[f64] {
        &self.z_lo
    }

    /// Returns `true` if the factors of `linear` are those of the last linearisation.
    pub fn has_factors(&self, linear: &RefinedSolver) -> bool {
        self.factored == Some(linear.generation())
    }

    /// Factors the last linearisation, for direct use and for the next iteration. Returns `false` if it is singular.
    ///
    /// # Errors
    /// As [`Bn::solve`].
    pub fn factor(&mut self, formulation: &Bdiff, linear: &mut RefinedSolver) -> Computed<bool> {
        self.factored = None;
        if formulation.unpinned_mode().is_some() {
            return Ok(false);
        }
        match linear.factorize(formulation.jacobian()) {
            Ok(_) => self.factored = Some(linear.generation()),
            Err(error) => drop(Termination::at(error)?),
        }
        Ok(self.factored.is_some())
    }

    /// Sets the limit of iterations.
    pub fn limit(&mut self, max_iterations: usize) {
        self.max_iterations = max_iterations;
    }

    /// Returns the linear system of the last direction.
    fn system<'a>(&'a self, formulation: &'a Bdiff) -> LinearSystem<'a> {
        let (matrix, layout, scaling) = (formulation.jacobian(), formulation.layout(), *formulation.scaling());
        LinearSystem { matrix, rhs: &self.rhs, solution: &self.dz, layout, scaling }
    }
}

fn expect_unknowns(formulation: &Bdiff, own: &[f64], z: &[f64]) -> Computed<()> {
    let expected = formulation.unknowns();
    for (what, found) in [("unknowns of the solver", own.len()), ("z", z.len())] {
        if found != expected {
            return Err(LinearError::Shape { what, expected, found });
        }
    }
    Ok(())
}

/// The sets of cases that an increment has visited.
#[derive(Default)]
struct Cycle {
    visited: HashSet<Vec<u8>>,
    visits: usize,
    /// The number of the visit that brought the last new set.
    last_new: usize,
}

impl Cycle {
    fn visit(&mut self, cases: Vec<u8>) {
        self.visits += 1;
        if self.visited.insert(cases) {
            self.last_new = self.visits;
        }
    }

    /// Returns `true` if the second half of the visits brought no new set.
    fn closed(&self) -> bool {
        2 * self.last_new <= self.visits
    }
}

/// A measure of the distance of `z + z_lo` from the exact law, where `z_lo` is the low-order part of `z`.
pub type Measure<'a> = &'a mut dyn FnMut(&[f64], &[f64]) -> Computed<f64>;

/// The stopping test of Algorithm BN.
pub enum StopCriterion<'a> {
    /// `Theta ≤ ε` after a step, in the unit of the formulation's `Theta`: the paper's test.
    Merit(f64),
    /// The caller's error measure is at most the tolerance, possibly before the first step.
    ///
    /// This test demands the last digits: a full step that repeats with the same matrix is followed by refinement. If
    /// the step size rule finds no step along (21), the exact derivative (20) is tried. If neither helps, the
    /// iteration has stalled.
    Measured {
        /// The tolerance of the error measure.
        tolerance: f64,
        /// The error measure.
        error: Measure<'a>,
    },
}

impl StopCriterion<'_> {
    /// Returns the error at `z + z_lo`, if it is measured.
    fn measure(&mut self, z: &[f64], z_lo: &[f64]) -> Computed<Option<f64>> {
        match self {
            StopCriterion::Merit(_) => Ok(None),
            StopCriterion::Measured { error, .. } => error(z, z_lo).map(Some),
        }
    }

    /// Returns `true` if the iterate with the merit `theta` and this error is a solution.
    fn is_met(&self, theta: f64, measured: Option<f64>) -> bool {
        match self {
            StopCriterion::Merit(epsilon) => theta <= *epsilon,
            StopCriterion::Measured { tolerance, .. } => measured.is_some_and(|error| error <= *tolerance),
        }
    }

    /// Returns `true` if the last digits are needed.
    fn is_measured(&self) -> bool {
        matches!(self, StopCriterion::Measured { .. })
    }
}

/// The accuracy far from the solution.
const LOOSE: f64 = 1e-2;
/// The accuracy that rounding and the end of an increment require.
const TIGHT: f64 = 1e-8;
/// The share of the expected reduction.
const SAFETY: f64 = 0.9;

/// The forcing terms of Eisenstat and Walker (1996), choice 2: `0.9 (|b| / |b_last|)²`.
#[derive(Debug, Default)]
struct Forcing {
    last: f64,
}

impl Forcing {
    /// Returns the admissible residual of the direction for the right-hand side `b`, relative to `b`. If `b` has
    /// grown, as at the start of an increment, the loosest term is used.
    fn term(&mut self, b: &[f64]) -> f64 {
        let size = b.iter().map(|b| b * b).sum::<f64>().sqrt();
        let last = std::mem::replace(&mut self.last, size);
        if last > 0.0 { (SAFETY * (size / last).powi(2)).clamp(TIGHT, LOOSE) } else { LOOSE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn terms_follow_the_reduction() {
        let mut forcing = Forcing::default();
        assert_eq!(forcing.term(&[3.0, 4.0]), LOOSE);
        assert!((forcing.term(&[0.3, 0.4]) - 0.9e-2).abs() < 1e-15);
        assert_eq!(forcing.term(&[3e-6, 4e-6]), TIGHT);
        assert_eq!(forcing.term(&[1.0, 1.0]), LOOSE);
    }
}
