//! Algorithm IP: the potential reduction interior point method.

use super::{Clock, Iteration, IterationRecord, LinearSystem, MethodResult, Termination};
use crate::algebra::linear::{Computed, RefinedSolver, SolveInfo};
use crate::solver::formulation::{Constrained, InteriorPoint};
use std::ops::ControlFlow;

/// The constants of Algorithm IP.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IpSettings {
    /// `ζ / n_2`, greater than 1.
    pub zeta: f64,
    /// `σ_0`, the initial centring parameter of an increment, in [0, 1].
    pub sigma_0: f64,
    /// The rule for the following `σ_k`.
    pub centring: Centring,
    /// `α`, the required share of the predicted decrease of `ψ`.
    pub alpha: f64,
    /// `ρ`, the factor of each backtrack.
    pub rho: f64,
    /// `τ̂`, the largest step as a share of the distance to the border.
    pub tau_hat: f64,
    /// `ξ`, the longest step.
    pub xi: f64,
    /// The `Theta` below which there is no line search.
    pub search_above: f64,
    /// The step length below which the line search gives up and takes the step. Without it, the iteration stalls when
    /// a step is lost in rounding.
    pub shortest_step: Option<f64>,
    /// `ε` in the stopping test `Theta ≤ ε`.
    pub epsilon: f64,
    /// The limit of iterations.
    pub max_iterations: usize,
}

/// The rule (36): `σ_{k+1} = far σ_k` while `Theta` is above `border`, then `near σ_k`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Centring {
    /// The factor far from the solution.
    pub far: f64,
    /// The factor near it.
    pub near: f64,
    /// The `Theta` between the two.
    pub border: f64,
}

impl IpSettings {
    /// Returns the constants of the paper.
    pub fn paper(max_iterations: usize) -> Self {
        IpSettings {
            zeta: 10.0,
            sigma_0: 1.0,
            centring: Centring { far: 0.5, near: 0.1, border: 1e5 },
            alpha: 0.5,
            rho: 0.5,
            tau_hat: 0.999_999_95,
            xi: 1.0,
            search_above: 1e3,
            shortest_step: None,
            epsilon: 1e-2,
            max_iterations,
        }
    }
}

/// The workspace of an interior point method.
#[derive(Default)]
pub(super) struct Workspace {
    pub h: Vec<f64>,
    pub b: Vec<f64>,
    pub dz: Vec<f64>,
    rhs: Vec<f64>,
}

impl Workspace {
    pub(super) fn resize(&mut self, formulation: &dyn InteriorPoint) {
        let n = formulation.unknowns();
        for vector in [&mut self.h, &mut self.b, &mut self.dz] {
            vector.resize(n, 0.0);
        }
        self.rhs.resize(formulation.matrix().order(), 0.0);
    }

    /// Computes `h = H(z)`. Returns `Theta`.
    pub(super) fn evaluate(&mut self, formulation: &dyn InteriorPoint, z: &[f64]) -> Computed<f64> {
        formulation.residual(z, &mut self.h)?;
        Ok(formulation.theta(z, &self.h))
    }

    /// Solves `∇H(z) dz = b` with the last factors.
    pub(super) fn solve(
        &mut self,
        formulation: &dyn InteriorPoint,
        linear: &mut RefinedSolver,
        z: &[f64],
    ) -> Computed<SolveInfo> {
        formulation.reduce(z, &self.b, &mut self.rhs);
        let info = linear.solve(formulation.matrix(), &self.rhs, &mut self.dz[..self.rhs.len()])?;
        formulation.recover(z, &self.b, &mut self.dz);
        Ok(info)
    }

    /// Returns the last linear system.
    pub(super) fn system<'a>(&'a self, formulation: &'a dyn InteriorPoint) -> LinearSystem<'a> {
        let (matrix, layout, scaling) = (formulation.matrix(), formulation.forces(), *formulation.scaling());
        LinearSystem { matrix, rhs: &self.rhs, solution: &self.dz[..self.rhs.len()], layout, scaling }
    }
}

/// Algorithm IP with its workspace.
#[derive(Default)]
pub struct Ip {
    work: Workspace,
}

impl Ip {
    /// Solves `H_I(z) = 0` from the given `z`, and leaves the last iterate in `z`. `linear` must have analysed the
    /// pattern of the formulation's matrix.
    ///
    /// # Errors
    /// If the linear solver fails for lack of memory or misuse. A singular matrix is no error, but a [`Termination`].
    pub fn solve(
        &mut self,
        settings: &IpSettings,
        formulation: &mut Constrained,
        linear: &mut RefinedSolver,
        z: &mut [f64],
        observe: &mut dyn FnMut(&Iteration<'_>) -> ControlFlow<()>,
    ) -> Computed<MethodResult> {
        // Step 1: initialisation.
        let mut clock = Clock::default();
        self.work.resize(formulation);
        let n_2 = formulation.n_2() as f64;
        let zeta = settings.zeta * n_2;
        let mut sigma = settings.sigma_0;
        formulation.refer_to(z);
        let mut theta = clock.time(|| self.work.evaluate(formulation, z))?;
        let mut outcome = MethodResult::new(theta);
        if observe(&Iteration::start(theta, None)).is_break() {
            return Ok(MethodResult { stop: Termination::Interrupted, ..outcome });
        }

        for iteration in 1..=settings.max_iterations {
            // Step 2: the direction, ∇H_I(z) dz = -H_I(z) + (0, σ β e) (14).
            let centring = sigma * formulation.beta(&self.work.h);
            clock.time(|| {
                formulation.linearize(z);
                self.work.b.iter_mut().zip(&self.work.h).for_each(|(b, h)| *b = -h);
                formulation.g_rows().for_each(|k| self.work.b[k] += centring);
            });
            let solved = linear.factorize(formulation.matrix()).and_then(|_| self.work.solve(formulation, linear, z));
            let backward_error = match solved {
                Ok(info) => info.backward_error,
                Err(error) => {
                    outcome.stop = Termination::at(error)?;
                    break;
                }
            };

            // Step 3: the step size, along ψ (13), and the step.
            let Workspace { h, dz, .. } = &self.work;
            let longest = formulation.largest_step(z, dz, h, centring);
            let first = (settings.tau_hat * longest).min(settings.xi);
            let search = clock.time(|| {
                if theta < settings.search_above || formulation.is_affine() {
                    return Some((first, 0));
                }
                let psi = formulation.potential_along(zeta, z, dz, h, centring);
                let demanded = -settings.alpha * (1.0 - sigma) * (zeta - n_2);
                settings.search(first, demanded, psi)
            });
            let Some((step, backtracks)) = search else {
                outcome.stop = Termination::Stalled;
                break;
            };
            theta = clock.time(|| {
                z.iter_mut().zip(&self.work.dz).for_each(|(z, dz)| *z += step * dz);
                formulation.refer_to(z);
                self.work.evaluate(formulation, z)
            })?;
            outcome.add(theta, backtracks, backward_error);

            // Step 4: termination, and the next σ (36).
            let start = IterationRecord::start(theta);
            let record = IterationRecord { iteration, step, backtracks, backward_error, factored: true, ..start };
            let flow = observe(&Iteration { record, system: Some(self.work.system(formulation)) });
            if outcome.ends(theta <= settings.epsilon || formulation.is_affine(), flow) {
                break;
            }
            let Centring { far, near, border } = settings.centring;
            sigma *= if theta > border { far } else { near };
        }
        outcome.assembly_seconds = clock.seconds;
        Ok(outcome)
    }
}

impl IpSettings {
    /// Returns the first of the steps `first ρ^m` along which `psi` falls by `demanded` times the step, and `m`, or
    /// `None` if there is none above rounding.
    fn search(&self, first: f64, demanded: f64, psi: impl Fn(f64) -> f64) -> Option<(f64, usize)> {
        let (start, mut step) = (psi(0.0), first);
        for m in 0.. {
            let decreased = psi(step) - start <= demanded * step;
            if decreased || self.shortest_step.is_some_and(|shortest| step < shortest) {
                return Some((step, m));
            }
            if step < f64::EPSILON {
                break;
            }
            step *= self.rho;
        }
        None
    }
}
