//! Chooses the linear solver of a problem by its sizes.
//!
//! Condensed equations have a dense matrix on the contact displacements, the Schur complement of the stiffness `K`. It
//! is formed once a run, and a Newton matrix costs a part of it. The factors of the whole system are sparse, and are
//! made anew for each Newton matrix. The ratio of the entries of both matrices decides. It is a rule of experience: on
//! the scenes in doc/method/benchmarks.md, with few and many increments, BN and IP, it takes the faster way.

use super::need::{factor_of, factors, most_entries};
use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::{Computed, SparseLu};
use crate::base::memory::{Budget, in_words};
use crate::solver::history::LinearAlgebra;
use crate::solver::initial_working_set::InitialWorkingSet;
use crate::solver::problem::ContactProblem;

/// The most entries of the Schur complement relative to those of the lower triangle of `K`, up to which the body is
/// condensed.
const DENSE: usize = 10;

/// The number of displacements from which on several processes take less time with multigrid than with MUMPS: cubes of
/// 20³ elements do.
const LARGE: usize = 20_000;

const MUMPS: LinearAlgebra = LinearAlgebra::Whole(SparseLu::Mumps);

/// A linear solver and the reason for its choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The linear solver.
    pub linear: LinearAlgebra,
    /// The solver and the reason for it in a line, if there was a choice.
    pub reason: Option<String>,
}

/// The solvers to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AvailableSolvers {
    /// Free memory, bytes, if known.
    pub available: Option<u64>,
    /// `true` if multigrid is suitable for the problem, see [`crate::run::unsuited`].
    pub multigrid: bool,
    /// The number of MPI processes. With several, solvers that use all of them come first, if there are any in this
    /// build.
    pub ranks: usize,
}

impl AvailableSolvers {
    /// Returns the memory left for this process, without multigrid, for a problem whose node positions are unknown,
    /// which multigrid needs.
    pub fn of_process() -> Self {
        let available = Budget::of_process().map(|budget| budget.bytes);
        AvailableSolvers { available, multigrid: false, ranks: ranks() }
    }

    /// Returns the solvers of this build, the best first, for `n` displacements and a contact that is `small`.
    fn ranked(self, n: usize, small: bool) -> Vec<LinearAlgebra> {
        let (whole, condensed, multigrid) =
            (LinearAlgebra::default(), LinearAlgebra::condensed(), LinearAlgebra::Multigrid);
        let shared = if n >= LARGE { vec![multigrid, MUMPS] } else { vec![MUMPS, multigrid] };
        let alone = if small { [condensed, multigrid, MUMPS, whole] } else { [whole, MUMPS, condensed, multigrid] };
        let usable = |all: Vec<LinearAlgebra>| {
            let usable = |linear: &LinearAlgebra| linear.is_built_in() && (self.multigrid || *linear != multigrid);
            all.into_iter().filter(usable).collect::<Vec<_>>()
        };
        let shared = if self.ranks > 1 { usable(shared) } else { Vec::new() };
        if shared.is_empty() { usable(alone.to_vec()) } else { shared }
    }
}

impl Choice {
    /// Returns the requested linear solver.
    pub fn named(linear: LinearAlgebra) -> Self {
        Choice { linear, reason: None }
    }

    /// Returns the best solver for the sizes of `problem` that fits into memory, where condensed equations contain the
    /// contact nodes `initial_set` or all. If none fits, returns the one with the least memory.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis, which is made if memory may not suffice.
    pub fn by_size(
        problem: &ContactProblem,
        initial_set: &InitialWorkingSet,
        solvers: AvailableSolvers,
    ) -> Computed<Self> {
        let (n, m) = (problem.displacements(), initial_set.displacements(problem));
        let ranked = solvers.ranked(n, m * m <= DENSE * problem.stiffness().lower_entries());
        let Some(&best) = ranked.first() else { return Ok(Choice::named(LinearAlgebra::default())) };
        let needs = |linear, stiffness| factors(problem, initial_set, linear, stiffness);
        let mut linear = best;
        let mut memory = String::new();
        if let Some(available) = solvers.available
            && needs(best, most_entries(problem)) > available as f64
        {
            let stiffness = factor_of(problem)?;
            let needs = |linear: &LinearAlgebra| needs(*linear, stiffness);
            let fits = |linear: &&LinearAlgebra| needs(linear) <= available as f64;
            let least = || ranked.iter().min_by(|a, b| needs(a).total_cmp(&needs(b)));
            linear = ranked.iter().find(fits).or_else(least).copied().unwrap_or(best);
            if linear != best {
                memory = format!(
                    "; {best} would take {} of the {} left",
                    in_words(needs(&best) as u64),
                    in_words(available)
                );
            }
        }
        let processes = if solvers.ranks > 1 { format!("{} processes, ", solvers.ranks) } else { String::new() };
        let reason = format!("{linear}: {processes}{m} contact displacements of {n}{memory}");
        Ok(Choice { linear, reason: Some(reason) })
    }
}
