//! Mehrotra's predictor–corrector interior point method. If the equations are linear on their faces, as in (25) of
//! Algorithm IP, one step on the right face ends it.
//!
//! No constant depends on the problem: `σ` follows from the step of the predictor, the step from the border, and the
//! caller's error measure is the stopping test.

use super::ip::Workspace;
use super::{Clock, Iteration, IterationRecord, MethodResult, Termination};
use crate::algebra::linear::{Computed, LinearError, RefinedSolver};
use crate::solver::formulation::{Face, InteriorPoint, Pair, largest_step};
use std::ops::ControlFlow;

/// The largest step as a share of the distance to the border. A larger share makes the next steps short; 0.9 costs 8
/// % more iterations, and no difference was found between 0.99 and 0.995.
const SHARE: f64 = 0.99;

/// The length below which a step counts as jammed. If the equations are curved, it is then replaced by a centred
/// step. Without that, three of 160 histories with the exact cone and stiffness over three decades failed, none with
/// 0.1; 0.03 and 0.3 take as many iterations. With equations that are linear on their faces none fails, and the
/// extreme scenes in the plane took 1.3 % more iterations with it.
const JAMMED: f64 = 0.1;

/// The predictor–corrector method with its workspace.
pub(crate) struct PredictorCorrector {
    /// The tolerance of the error measure.
    pub tolerance: f64,
    /// The limit of iterations.
    pub max_iterations: usize,
    work: Workspace,
    /// The iterate before the last step.
    before: Vec<f64>,
}

/// An iterate with its equations.
struct Iterate<'a> {
    z: &'a mut [f64],
    formulation: &'a mut dyn InteriorPoint,
    linear: &'a mut RefinedSolver,
    error: &'a mut dyn FnMut(&[f64]) -> Computed<f64>,
}

/// The result of a step.
struct StepResult {
    step: f64,
    backward_error: f64,
    error: f64,
}

impl PredictorCorrector {
    /// Creates a workspace for iterations up to this error measure, or up to this limit.
    pub fn new(tolerance: f64, max_iterations: usize) -> Self {
        PredictorCorrector { tolerance, max_iterations, work: Workspace::default(), before: Vec::new() }
    }

    /// Solves `H(z) = 0` from a `z` whose pairs are positive, and leaves the last iterate in `z`. `error` measures
    /// the state in `z`. One iteration factors one matrix, which serves the two right-hand sides of predictor and
    /// corrector.
    ///
    /// # Errors
    /// If the linear solver fails for lack of memory or misuse. A singular matrix is no error, but a [`Termination`].
    pub fn solve(
        &mut self,
        formulation: &mut dyn InteriorPoint,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        error: &mut dyn FnMut(&[f64]) -> Computed<f64>,
        observe: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Computed<MethodResult> {
        let mut clock = Clock::default();
        self.work.resize(formulation);
        let mut at = Iterate { z, formulation, linear, error };
        let mut outcome = MethodResult::new(clock.time(|| self.work.evaluate(at.formulation, at.z))?);
        if observe(&Iteration::start(outcome.theta, None)).is_break() {
            return Ok(MethodResult { stop: Termination::Interrupted, ..outcome });
        }
        // The face ahead, and the last face to which a step was tried.
        let (mut ahead, mut tried): (Option<Face>, Option<Face>) = (None, None);
        let mut settled = false;
        // Equations that are not linear on their faces have no face ahead at any point.
        let curved = at.formulation.face_ahead(at.z, at.z).is_none();

        for iteration in 1..=self.max_iterations {
            let result = match &ahead {
                // If two steps have approached the same face, it may be that of the solution.
                Some(face) if settled && tried != ahead => {
                    tried.clone_from(&ahead);
                    self.step_to(face, &mut at)
                }
                _ => {
                    let result = self.step(curved, &mut at);
                    // A failed step has not moved z.
                    if result.is_ok() {
                        let face = at.formulation.face_ahead(&self.before, at.z);
                        settled = ahead == face;
                        ahead = face;
                    }
                    result
                }
            };
            let StepResult { step, backward_error, error } = match result {
                Ok(taken) => taken,
                Err(error) => {
                    outcome.stop = Termination::at(error)?;
                    break;
                }
            };
            let theta = clock.time(|| self.work.evaluate(at.formulation, at.z))?;
            outcome.add(theta, 0, backward_error);
            // The error of a rejected step belongs to its end, not to z.
            let of_z = (step > 0.0).then_some(error);
            let start = IterationRecord::start(theta);
            let record = IterationRecord { iteration, step, backward_error, factored: true, error: of_z, ..start };
            let flow = observe(&Iteration { record, system: Some(self.work.system(at.formulation)) });
            if outcome.ends(error <= self.tolerance || at.formulation.is_affine(), flow) {
                break;
            }
        }
        outcome.assembly_seconds = clock.seconds;
        Ok(outcome)
    }

    /// Computes a predictor and a corrector with one matrix, and takes the step.
    fn step(&mut self, curved: bool, at: &mut Iterate<'_>) -> Computed<StepResult> {
        let Iterate { z, formulation, linear, error } = at;
        let beta = mean_product(formulation.pairs(), z, &self.work.dz, 0.0);
        formulation.linearize(z);
        linear.factorize(formulation.matrix())?;

        // The predictor aims at the solution itself, σ = 0.
        self.work.b.iter_mut().zip(&self.work.h).for_each(|(b, h)| *b = -h);
        let predicted = self.work.solve(*formulation, linear, z)?;
        let max_step = largest_step(formulation.pairs(), z, &self.work.dz).min(1.0);

        // The corrector aims at products of σ β, with Mehrotra's σ, and takes the second order of the products from
        // the predictor.
        let sigma = (mean_product(formulation.pairs(), z, &self.work.dz, max_step) / beta).powi(3).min(1.0);
        let centring = if sigma.is_finite() { sigma * beta } else { 0.0 };
        for pair in formulation.pairs() {
            self.work.b[pair.length] += centring - self.work.dz[pair.force] * self.work.dz[pair.length];
        }
        let mut corrected = self.work.solve(*formulation, linear, z)?;
        let mut step = (SHARE * largest_step(formulation.pairs(), z, &self.work.dz)).min(1.0);
        if curved && step < JAMMED {
            // A very short predictor contains no information on the second order. Without it, σ = 1.
            self.work.b.iter_mut().zip(&self.work.h).for_each(|(b, h)| *b = -h);
            formulation.pairs().iter().for_each(|pair| self.work.b[pair.length] += beta);
            corrected = self.work.solve(*formulation, linear, z)?;
            step = (SHARE * largest_step(formulation.pairs(), z, &self.work.dz)).min(1.0);
        }

        self.before.clear();
        self.before.extend_from_slice(z);
        z.iter_mut().zip(&self.work.dz).for_each(|(z, dz)| *z += step * dz);
        let backward_error = predicted.backward_error.max(corrected.backward_error);
        Ok(StepResult { step, backward_error, error: error(z)? })
    }

    /// Computes the Newton step to `face`. The step is taken if it leads to the solution, within the tolerance;
    /// otherwise `z` is unchanged.
    fn step_to(&mut self, face: &Face, at: &mut Iterate<'_>) -> Computed<StepResult> {
        let Iterate { z, formulation, linear, error } = at;
        let point = face.point(formulation.pairs(), z.len());
        formulation.linearize(&point);
        face.towards(formulation.pairs(), z, &self.work.h, &mut self.work.b);
        let solved = linear.factorize(formulation.matrix()).and_then(|_| self.work.solve(*formulation, linear, &point));
        let info = match solved {
            Ok(info) => info,
            // A face that does not hold the body is not that of the solution.
            Err(LinearError::Singular { .. } | LinearError::NotFinite) => {
                return Ok(StepResult { step: 0.0, backward_error: 0.0, error: f64::INFINITY });
            }
            Err(error) => return Err(error),
        };
        let end: Vec<f64> = z.iter().zip(&self.work.dz).map(|(z, dz)| z + dz).collect();
        let error = error(&end)?;
        let reached = error <= self.tolerance;
        if reached {
            z.copy_from_slice(&end);
        }
        Ok(StepResult { step: f64::from(u8::from(reached)), backward_error: info.backward_error, error })
    }
}

/// Returns the mean product of the `pairs` at `z + t dz`.
fn mean_product(pairs: &[Pair], z: &[f64], dz: &[f64], t: f64) -> f64 {
    pairs.iter().map(|pair| pair.product_ahead(z, dz, t)).sum::<f64>() / pairs.len() as f64
}
