//! A linear solver with refinement, backward error and statistics.

use std::sync::Arc;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::refine::{self, SolveInfo, Workspace};
use super::{Computed, FactorInfo, Iterated, LinearError, LinearSolver, SparseLu, SystemMatrix, expect_length};
use crate::algebra::sparse::Pattern;

/// The statistics of a [`RefinedSolver`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// The number of symbolic analyses.
    pub analyses: usize,
    /// The number of numerical factorisations.
    pub factorizations: usize,
    /// The number of right-hand sides solved, without refinement steps.
    pub solves: usize,
    /// The number of refinement steps.
    pub refinements: usize,
    /// The time for symbolic analyses, s.
    pub analysis_seconds: f64,
    /// The time for factorisations, s.
    pub factor_seconds: f64,
    /// The time for solves, with refinement and backward error, s.
    pub solve_seconds: f64,
    /// The largest backward error of all refined solves.
    pub worst_backward_error: f64,
    /// The number of iterations within the solves of an iterative solver.
    pub krylov_iterations: usize,
    /// The direct solver that took over, if the iterations stalled.
    pub instead: Option<SparseLu>,
    /// The properties of the last factorisation.
    pub factor: FactorInfo,
}

/// A linear solver that refines and measures the solutions of a backend.
pub struct RefinedSolver {
    solver: Box<dyn LinearSolver>,
    pattern: Option<Arc<Pattern>>,
    work: Workspace,
    statistics: Statistics,
    /// The number of analyses and factorisations begun, including failed ones. While it is unchanged, so are the factors.
    generation: usize,
}

impl Default for RefinedSolver {
    /// Creates this build's sparse LU: UMFPACK if it is built in, otherwise faer.
    fn default() -> Self {
        RefinedSolver::new(SparseLu::default().solver())
    }
}

impl RefinedSolver {
    /// Wraps a solver.
    pub fn new(solver: Box<dyn LinearSolver>) -> Self {
        RefinedSolver {
            solver,
            pattern: None,
            work: Workspace::default(),
            statistics: Statistics::default(),
            generation: 0,
        }
    }

    /// Continues the statistics from earlier work, `done`.
    #[must_use]
    pub fn after(self, done: Statistics) -> Self {
        RefinedSolver { statistics: done, ..self }
    }

    /// Returns the name of the solver in reports.
    pub fn name(&self) -> &'static str {
        self.solver.name()
    }

    /// Returns a number that changes whenever the factors do, also if a factorisation fails and leaves none.
    pub fn generation(&self) -> usize {
        self.generation
    }

    /// Returns the statistics so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Analyses the pattern of `a`, once for a set-up of the equations. A sparse pattern that equals the last one is not analysed again.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    pub fn analyze(&mut self, a: &SystemMatrix) -> Computed<()> {
        let start = Instant::now();
        self.generation += 1;
        let known = self.pattern.take().is_some_and(|pattern| pattern == *a.pattern());
        if known && a.leading().is_none() {
            self.pattern = Some(Arc::clone(a.pattern()));
            return Ok(());
        }
        self.solver.analyze_system(a)?;
        self.pattern = Some(Arc::clone(a.pattern()));
        self.statistics.analyses += 1;
        self.statistics.analysis_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Factors `a`, which must have the analysed pattern.
    ///
    /// # Errors
    /// As [`LinearSolver::factorize`], and [`LinearError::PatternChanged`].
    pub fn factorize(&mut self, a: &SystemMatrix) -> Computed<FactorInfo> {
        self.expect_analysed(a)?;
        let start = Instant::now();
        self.generation += 1;
        let info = self.solver.factorize_system(a)?;
        self.statistics.factorizations += 1;
        self.statistics.factor_seconds += start.elapsed().as_secs_f64();
        self.statistics.factor = info;
        Ok(info)
    }

    /// Returns an error unless `a` has the analysed pattern, and both vectors fit it.
    fn fits(&self, a: &SystemMatrix, b: &[f64], x: &[f64]) -> Computed<()> {
        self.expect_analysed(a)?;
        expect_length("right-hand side", a.pattern().rows(), b.len())?;
        expect_length("solution", a.order(), x.len())
    }

    /// Returns an error unless `a` has the analysed pattern. A formulation shares it, so that no entries are
    /// compared.
    fn expect_analysed(&self, a: &SystemMatrix) -> Computed<()> {
        let pattern = self.pattern.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        if Arc::ptr_eq(pattern, a.pattern()) || pattern == a.pattern() {
            Ok(())
        } else {
            Err(LinearError::PatternChanged)
        }
    }

    /// Solves `a x = b` with the last factors, for an estimate, without refinement and backward error.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`].
    pub fn solve_roughly(&mut self, b: &[f64], x: &mut [f64]) -> Computed<()> {
        let start = Instant::now();
        self.solver.solve(b, x)?;
        self.count_solve(start);
        Ok(())
    }

    /// Computes an upper bound of the reciprocal condition number of `a` from the last factors: `1 / ‖A⁻¹ b‖` in the maximum norm,
    /// for fixed right-hand sides of size one, after each row of `A` is divided by the sum of its sizes. The bound is 0 if a solution
    /// is not finite. Every backend gives the same bound up to rounding. It costs one solve without refinement, or two if the first
    /// is doubtful.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`], and [`LinearError::PatternChanged`].
    pub fn reciprocal_condition(&mut self, a: &SystemMatrix) -> Computed<f64> {
        const DOUBTFUL: f64 = 1e-10;
        self.expect_analysed(a)?;
        let n = a.order();
        let (mut product, mut row_sums) = (vec![0.0; n], vec![0.0; n]);
        a.residual(&vec![1.0; n], &vec![0.0; n], &mut product, &mut row_sums)?;
        // Signs without order, so that hardly a null vector is at right angles to them.
        let sign = |i: usize| if (i.wrapping_mul(0x9E37_79B9) >> 16) & 1 == 0 { 1.0 } else { -1.0 };
        let mut x: Vec<f64> = (0..n).map(sign).collect();
        let mut ratio = 1.0_f64;
        for _ in 0..2 {
            let b: Vec<f64> = x.iter().zip(&row_sums).map(|(x, sum)| x * sum).collect();
            match self.solve_roughly(&b, &mut x) {
                Ok(()) => {}
                Err(LinearError::NotFinite) => return Ok(0.0),
                Err(error) => return Err(error),
            }
            let size = x.iter().fold(0.0_f64, |m, x| if x.is_nan() { f64::NAN } else { m.max(x.abs()) });
            if !size.is_finite() {
                return Ok(0.0);
            }
            ratio = ratio.min(1.0 / size);
            if ratio > DOUBTFUL {
                break;
            }
            // A step of inverse iteration finds the direction that matters.
            for x in &mut x {
                *x /= size;
            }
        }
        Ok(ratio)
    }

    /// Returns `true` if the solver is iterative.
    pub fn iterates(&self) -> bool {
        self.solver.iterates()
    }

    /// Solves `a x = b` to a relative residual of `tolerance` if the solver is iterative. There is no refinement
    /// then, and the backward error does not enter the largest one of the statistics. A direct solver works as in
    /// [`RefinedSolver::solve`].
    ///
    /// # Errors
    /// As [`RefinedSolver::solve`].
    pub fn solve_to(&mut self, tolerance: f64, a: &SystemMatrix, b: &[f64], x: &mut [f64]) -> Computed<SolveInfo> {
        self.fits(a, b, x)?;
        let start = Instant::now();
        if !self.solver.iterates() {
            return self.solve(a, b, x);
        }
        self.solver.solve_to(tolerance, b, x)?;
        let error = refine::backward_error(a, b, x)?;
        self.count_solve(start);
        if error.is_finite() {
            Ok(SolveInfo { backward_error: error, refinements: 0 })
        } else {
            Err(LinearError::NotFinite)
        }
    }

    /// Solves `a x = b` with the last factors, with refinement. The caller judges the backward error that is returned, see
    /// [`SolveInfo::within`].
    ///
    /// # Errors
    /// As [`LinearSolver::solve`], [`LinearError::PatternChanged`], and [`LinearError::NotFinite`].
    pub fn solve(&mut self, a: &SystemMatrix, b: &[f64], x: &mut [f64]) -> Computed<SolveInfo> {
        self.fits(a, b, x)?;
        let start = Instant::now();
        let info = refine::solve(&mut |b, x| self.solver.solve(b, x), a, b, x, &mut self.work)?;
        self.count_solve(start);
        let statistics = &mut self.statistics;
        statistics.refinements += info.refinements;
        statistics.worst_backward_error = statistics.worst_backward_error.max(info.backward_error);
        Ok(info)
    }

    fn count_solve(&mut self, start: Instant) {
        let Iterated { iterations, instead } = self.solver.iterated();
        let statistics = &mut self.statistics;
        statistics.solves += 1;
        statistics.solve_seconds += start.elapsed().as_secs_f64();
        statistics.krylov_iterations += iterations;
        statistics.instead = statistics.instead.or(instead);
    }
}
