//! A backend together with what it did: counts, times, refinement, backward error.

use std::sync::Arc;
use std::time::Instant;

use super::error::expect_length;
use super::refine::{self, SolveInfo, Workspace};
use super::{FactorInfo, LinearError, LinearSolver, SparseLu};
use crate::sparse::{Csc, Pattern};

/// What a [`Direct`] solver has done so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Statistics {
    /// Symbolic analyses.
    pub analyses: usize,
    /// Numerical factorisations.
    pub factorizations: usize,
    /// Right-hand sides solved, refinement steps not counted.
    pub solves: usize,
    /// Refinement steps.
    pub refinements: usize,
    /// Seconds in symbolic analyses.
    pub analysis_seconds: f64,
    /// Seconds in factorisations.
    pub factor_seconds: f64,
    /// Seconds in solves, with refinement and the measuring of the backward error.
    pub solve_seconds: f64,
    /// The largest backward error of any solve.
    pub worst_backward_error: f64,
    /// The last factorisation.
    pub factor: FactorInfo,
}

/// A direct solver in front of a backend.
pub struct Direct {
    backend: Box<dyn LinearSolver>,
    pattern: Option<Arc<Pattern>>,
    work: Workspace,
    statistics: Statistics,
    /// Factorisations begun, those that failed included: as long as it is the same, so are the factors.
    generation: usize,
}

impl Default for Direct {
    /// The sparse LU of this build: UMFPACK where it is built in, otherwise faer.
    fn default() -> Self {
        Direct::new(SparseLu::default().solver())
    }
}

impl Direct {
    /// Wraps `backend`.
    pub fn new(backend: Box<dyn LinearSolver>) -> Self {
        Direct { backend, pattern: None, work: Workspace::default(), statistics: Statistics::default(), generation: 0 }
    }

    /// The same after so much was `done` before: it counts on from there.
    #[must_use]
    pub fn after(self, done: Statistics) -> Self {
        Direct { statistics: done, ..self }
    }

    /// The name of the solver in reports.
    pub fn name(&self) -> &'static str {
        self.backend.name()
    }

    /// A number that changes whenever the factors do, be it that a factorisation fails and leaves none.
    pub fn generation(&self) -> usize {
        self.generation
    }

    /// What was done so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Symbolic analysis of `pattern`, once a run.
    ///
    /// # Errors
    /// As [`LinearSolver::analyze`].
    pub fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        let start = Instant::now();
        self.generation += 1;
        self.backend.analyze(pattern)?;
        self.pattern = Some(Arc::clone(pattern));
        self.statistics.analyses += 1;
        self.statistics.analysis_seconds += start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Factors `a`, which must stand on the analysed pattern.
    ///
    /// # Errors
    /// As [`LinearSolver::factorize`], and [`LinearError::PatternChanged`].
    pub fn factorize(&mut self, a: &Csc) -> Result<FactorInfo, LinearError> {
        self.expect_analysed(a)?;
        let start = Instant::now();
        self.generation += 1;
        let info = self.backend.factorize(a.values())?;
        self.statistics.factorizations += 1;
        self.statistics.factor_seconds += start.elapsed().as_secs_f64();
        self.statistics.factor = info;
        Ok(info)
    }

    /// An error unless `a` stands on the analysed pattern. A formulation shares it, so that nothing is compared.
    fn expect_analysed(&self, a: &Csc) -> Result<(), LinearError> {
        let pattern = self.pattern.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        if Arc::ptr_eq(pattern, a.pattern()) || pattern == a.pattern() {
            Ok(())
        } else {
            Err(LinearError::PatternChanged)
        }
    }

    /// Solves `a x = b` with the last factors, refined.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`], [`LinearError::PatternChanged`], and [`LinearError::NotFinite`].
    pub fn solve(&mut self, a: &Csc, b: &[f64], x: &mut [f64]) -> Result<SolveInfo, LinearError> {
        self.expect_analysed(a)?;
        expect_length("right-hand side", a.pattern().rows(), b.len())?;
        expect_length("solution", a.pattern().columns(), x.len())?;
        let start = Instant::now();
        let info = refine::solve(self.backend.as_mut(), a, b, x, &mut self.work)?;
        let statistics = &mut self.statistics;
        statistics.solves += 1;
        statistics.refinements += info.refinements;
        statistics.solve_seconds += start.elapsed().as_secs_f64();
        statistics.worst_backward_error = statistics.worst_backward_error.max(info.backward_error);
        Ok(info)
    }
}
