//! Algorithm BN: the B-differentiable Newton method.

use super::clock::Clock;
use super::{Armijo, Flow, IterationRecord, Outcome, Stop};
use crate::formulation::Formulation;
use crate::linear::{Direct, LinearError};

/// The constants of Algorithm BN.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BnSettings {
    /// The step size rule: `β` and `σ`.
    pub armijo: Armijo,
    /// `ε`: the iteration ends when `Theta ≤ ε`, in the unit of the formulation's `Theta`.
    pub epsilon: f64,
    /// The limit of iterations.
    pub max_iterations: usize,
}

impl BnSettings {
    /// The paper's: `β = 0.9`, `σ = 0.1`, at most 22 backtracks, `ε = 0.01`.
    pub fn paper(max_iterations: usize) -> Self {
        BnSettings { armijo: Armijo { beta: 0.9, sigma: 0.1, max_backtracks: 22 }, epsilon: 1e-2, max_iterations }
    }
}

/// Algorithm BN with its workspace.
pub struct Bn {
    settings: BnSettings,
    h: Vec<f64>,
    dz: Vec<f64>,
    /// The number of factorisations that `linear` had made after this solver's last one: if it is
    /// still the same, its factors are those of the last linearisation.
    factored: Option<usize>,
}

impl Bn {
    /// A solver for `unknowns` equations.
    pub fn new(settings: BnSettings, unknowns: usize) -> Self {
        let zeros = || vec![0.0; unknowns];
        Bn { settings, h: zeros(), dz: zeros(), factored: None }
    }

    /// Solves `H(z) = 0` from the given `z`, which is left at the last iterate. `linear` must have
    /// analysed the pattern of the Jacobian.
    ///
    /// # Errors
    /// When the linear algebra cannot go on for want of memory or by misuse. A singular matrix is
    /// no error: it is a way to [`Stop`].
    pub fn solve<F: Formulation>(
        &mut self,
        formulation: &mut F,
        linear: &mut Direct,
        z: &mut [f64],
        observe: &mut dyn FnMut(&IterationRecord) -> Flow,
    ) -> Result<Outcome, LinearError> {
        // Step 1: initialisation.
        let mut clock = Clock::default();
        let mut theta = clock.time(|| {
            formulation.residual(z, &mut self.h);
            formulation.merit(&self.h)
        });
        let mut outcome = Outcome::new(theta);
        if observe(&IterationRecord::start(theta)) == Flow::Stop {
            return Ok(Outcome { stop: Stop::Interrupted, ..outcome });
        }

        for iteration in 1..=self.settings.max_iterations {
            // Step 2: the direction, H(z) + H̃'(z; dz) = 0 (22). The matrix is factored unless it is
            // that of the last direction.
            let changed = clock.time(|| formulation.linearize(z));
            let fresh = changed || self.factored != Some(linear.statistics().factorizations);
            if fresh {
                self.factored = None;
                if let Some(motion) = formulation.unheld_motion() {
                    outcome.stop = Stop::Unheld(motion);
                    break;
                }
            }
            let backward_error = match self.direction(formulation, linear) {
                Ok(error) => error,
                Err(error) => {
                    outcome.stop = Stop::at(error)?;
                    break;
                }
            };

            // Step 3: the step size (12), and the step.
            let (step, backtracks) = clock.time(|| {
                let merit = formulation.merit_along(z, &self.dz, &self.h);
                self.settings.armijo.step(theta, merit)
            });
            theta = clock.time(|| {
                for (z, dz) in z.iter_mut().zip(&self.dz) {
                    *z += step * dz;
                }
                formulation.residual(z, &mut self.h);
                formulation.merit(&self.h)
            });
            outcome.add(theta, backtracks, backward_error);

            // Step 4: termination.
            let record = IterationRecord { iteration, theta, step, backtracks, backward_error, factored: fresh };
            let flow = observe(&record);
            if outcome.ends(theta <= self.settings.epsilon || formulation.is_affine(), flow) {
                break;
            }
        }
        outcome.assembly_seconds = clock.seconds;
        Ok(outcome)
    }

    /// Solves for `dz`; returns the backward error.
    fn direction<F: Formulation>(&mut self, formulation: &F, linear: &mut Direct) -> Result<f64, LinearError> {
        if self.factored.is_none() {
            linear.factorize(formulation.jacobian())?;
            self.factored = Some(linear.statistics().factorizations);
        }
        // The factors solve for -dz; only its sign is turned.
        let info = linear.solve(formulation.jacobian(), &self.h, &mut self.dz)?;
        self.dz.iter_mut().for_each(|dz| *dz = -*dz);
        Ok(info.backward_error)
    }
}
