//! A backend together with what it did: counts, times, refinement, backward error.

use std::sync::Arc;
use std::time::Instant;

use super::refine::{self, SolveInfo, Workspace};
use super::{Dense, FactorInfo, LinearError, LinearSolver, built_in};
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
    condenses: bool,
    /// What was factored beforehand, on which all else stands.
    body: FactorInfo,
}

impl Default for Direct {
    /// The sparse LU of this build: UMFPACK where it is built in, otherwise faer.
    fn default() -> Self {
        Direct::new(if cfg!(feature = "umfpack") { built_in::umfpack() } else { built_in::faer() })
    }
}

impl Direct {
    /// Wraps `backend`.
    pub fn new(backend: Box<dyn LinearSolver>) -> Self {
        Direct {
            backend,
            pattern: None,
            work: Workspace::default(),
            statistics: Statistics::default(),
            condenses: false,
            body: FactorInfo::default(),
        }
    }

    /// A dense solver for a body that is condensed to so many contact displacements first.
    pub fn condensing(contact_displacements: usize) -> Self {
        Direct { condenses: true, ..Direct::new(Box::new(Dense::new(contact_displacements))) }
    }

    /// Whether it expects a condensed body.
    pub fn condenses(&self) -> bool {
        self.condenses
    }

    /// The name of the path in reports.
    pub fn name(&self) -> &'static str {
        if self.condenses { "condensed" } else { self.backend.name() }
    }

    /// Adds the factors of the condensed body to what is reported of the others.
    pub fn stand_on(&mut self, body: FactorInfo) {
        self.body = body;
        self.statistics.factor = body;
    }

    /// Counts the backward error of a solution of the whole system that was put together elsewhere.
    pub fn count_backward_error(&mut self, error: f64) {
        self.statistics.worst_backward_error = self.statistics.worst_backward_error.max(error);
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
        let pattern = self.pattern.as_ref().ok_or(LinearError::Order { missing: "analyze" })?;
        if !Arc::ptr_eq(pattern, &a.pattern) && *pattern != a.pattern {
            return Err(LinearError::PatternChanged);
        }
        let start = Instant::now();
        let info = self.backend.factorize(&a.values)?;
        self.statistics.factorizations += 1;
        self.statistics.factor_seconds += start.elapsed().as_secs_f64();
        self.statistics.factor = FactorInfo {
            entries: self.body.entries + info.entries,
            peak_bytes: self.body.peak_bytes + info.peak_bytes,
            ..info
        };
        Ok(info)
    }

    /// Solves `a x = b` with the last factors, refined.
    ///
    /// # Errors
    /// As [`LinearSolver::solve`], and [`LinearError::NotFinite`].
    pub fn solve(&mut self, a: &Csc, b: &[f64], x: &mut [f64]) -> Result<SolveInfo, LinearError> {
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
