//! Chooses the linear solver of a problem: the one with the least estimated time that fits into memory.
//!
//! One symbolic analysis of `K` serves all estimates, see [`crate::algebra::linear::cost`]. It takes about as long as
//! one ordering.

use serde::Serialize;

use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::cost::{self, Cost, Sizes, Work};
use crate::algebra::linear::{Cholesky, FactorInfo, LinearError, SparseLu};
use crate::base::memory::{Budget, in_words};
use crate::solver::formulation::Layout;
use crate::solver::history::{HistoryMethod, LinearAlgebra};
use crate::solver::initial_working_set::InitialWorkingSet;
use crate::solver::problem::ContactProblem;

/// BN reuses its factors while no contact status changes, so the number of factorisations grows as the square root of
/// the number of increments, with this factor: 5, 7.5, 11 and 14 on the paper's block with 25, 50, 100 and 200 contact
/// nodes (2 to 100 increments), 3 to 11 on strips.
const BN_FACTORIZATIONS: f64 = 8.0;

/// Factorisations per increment if nodes slide in a plane, where the slip direction turns and changes the matrix: 6 to
/// 10 with 2 increments, 5 to 7 with 10 and 4 to 5 with 40 on cubes and plates of 8 to 32 elements along the contact.
const BN_FACTORIZATIONS_IN_A_PLANE: f64 = 5.0;

/// Factorisations per increment of an interior point method, whose matrix changes in each iteration: 5 to 8 in the
/// tables of the paper.
const IP_FACTORIZATIONS: f64 = 6.0;

/// Factorisations per increment with the exact cone, if nodes slide in a plane: 13.8 and 14.4 on a plate of 24 × 24 × 6
/// elements with 5 and 10 increments.
const IP_FACTORIZATIONS_IN_A_PLANE: f64 = 14.0;

const MUMPS: LinearAlgebra = LinearAlgebra::Whole(SparseLu::Mumps);

/// A linear solver and the reason for its choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// The linear solver.
    pub linear: LinearAlgebra,
    why: Why,
}

#[derive(Debug, Clone, PartialEq)]
enum Why {
    Named,
    /// The fastest of these that fit into memory.
    Estimated {
        paths: Vec<SolverEstimate>,
        solvers: AvailableSolvers,
    },
}

/// A linear solver with its estimated cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverEstimate {
    /// The linear algebra.
    pub linear: LinearAlgebra,
    /// The cost of all increments.
    pub cost: Cost,
    /// The number of factorisations that it contains, by experience.
    pub factorizations: f64,
}

/// The solvers to choose from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AvailableSolvers {
    /// Free memory, bytes, if known.
    pub available: Option<u64>,
    /// `true` if multigrid is suitable for the problem, see [`crate::run::unsuited`].
    pub multigrid: bool,
    /// The number of MPI processes. With several, only solvers that use all of them are considered.
    pub ranks: usize,
}

/// A linear solver estimated to take much less time than that of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
pub struct Faster {
    /// The faster solver, by its name in scenes.
    #[schemars(with = "String")]
    pub solver: LinearAlgebra,
    /// The estimated time of its linear algebra, s.
    pub seconds: f64,
    /// The time of the run's linear algebra by the same estimate, s.
    pub here_seconds: f64,
}

/// Rates of an exact path per contact node: 1.7 to 2.8 on the paper's block.
const EVENT_RATES: f64 = 2.5;

/// Estimates are accurate to a factor of about two, so smaller ratios than this are not reported.
const MUCH: f64 = 3.0;

/// Estimating costs less than one ordering. It is done only for runs longer than this number of orderings, and only if
/// the time saved is longer as well.
const ORDERINGS: f64 = 10.0;

/// The work done by a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Done {
    /// The number of increments.
    pub increments: usize,
    /// The number of factorisations.
    pub factorizations: usize,
    /// Its wall time, s.
    pub seconds: f64,
}

impl Choice {
    /// Returns the requested linear solver.
    pub fn named(linear: LinearAlgebra) -> Self {
        Choice { linear, why: Why::Named }
    }

    /// Returns the fastest solver that fits into memory for `increments` increments of `problem` with `method`, where
    /// condensed equations contain the contact nodes `initial_set` or all. If none fits, returns the one with the least
    /// memory.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn cheapest(
        problem: &ContactProblem,
        initial_set: &InitialWorkingSet,
        method: HistoryMethod,
        increments: usize,
        solvers: AvailableSolvers,
    ) -> Result<Self, LinearError> {
        let factorizations = factorizations(&Layout::new(problem), method, increments);
        let work = work(initial_set, method, [increments as f64, factorizations]);
        let sizes = Estimates::new(problem, initial_set, work, factor_of(problem)?);
        let paths = sizes.paths(solvers);
        let by = |measure: fn(&SolverEstimate) -> f64| {
            move |a: &&SolverEstimate, b: &&SolverEstimate| measure(a).total_cmp(&measure(b))
        };
        let fastest = paths.iter().filter(|path| solvers.have_room(path)).min_by(by(|path| path.cost.seconds));
        let chosen = fastest.or_else(|| paths.iter().min_by(by(|path| path.cost.bytes)));
        let linear = chosen.map_or_else(LinearAlgebra::default, |path| path.linear);
        Ok(Choice { linear, why: Why::Estimated { paths, solvers } })
    }

    /// Returns the compared solvers with their estimates; empty if there was no choice.
    pub fn paths(&self) -> &[SolverEstimate] {
        match &self.why {
            Why::Estimated { paths, .. } => paths,
            Why::Named => &[],
        }
    }

    /// Returns a solver that would have been much faster than the requested one for the work done. Returns `None` if
    /// there is no such solver, or if the run was so short that the estimate would prolong it.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn faster(
        &self,
        problem: &ContactProblem,
        initial_set: &InitialWorkingSet,
        method: HistoryMethod,
        solvers: AvailableSolvers,
        done: &Done,
    ) -> Result<Option<Faster>, LinearError> {
        let unknowns = Layout::new(problem).unknowns();
        let long = ORDERINGS * cost::order(unknowns);
        if matches!(self.why, Why::Estimated { .. }) || done.seconds < long {
            return Ok(None);
        }
        let work = work(initial_set, method, [done.increments, done.factorizations].map(|count| count as f64));
        let estimates = |stiffness| Estimates::new(problem, initial_set, work, stiffness);
        let fastest = |estimates: &Estimates| {
            let others = estimates.paths(solvers).into_iter().filter(|path| !self.is_like(path.linear));
            let with_room = others.filter(|path| solvers.have_room(path));
            with_room.min_by(|a, b| a.cost.seconds.total_cmp(&b.cost.seconds))
        };
        // A factor has at least as many entries as the matrix.
        let least = FactorInfo { entries: problem.stiffness().lower_entries(), ..FactorInfo::default() };
        if fastest(&estimates(least)).is_none_or(|other| MUCH * other.cost.seconds > done.seconds) {
            return Ok(None);
        }
        let estimates = estimates(factor_of(problem)?);
        let here_seconds = estimates.cost(self.linear).shared_by(solvers.ranks).seconds;
        let worth_a_word = |other: &SolverEstimate| here_seconds > MUCH * other.cost.seconds && here_seconds > long;
        let faster = |other: SolverEstimate| Faster { solver: other.linear, seconds: other.cost.seconds, here_seconds };
        Ok(fastest(&estimates).filter(worth_a_word).map(faster))
    }

    /// Returns `true` if both are the same kind of solver, possibly of different libraries.
    fn is_like(&self, other: LinearAlgebra) -> bool {
        std::mem::discriminant(&self.linear) == std::mem::discriminant(&other)
    }

    /// Describes the choice and its reason in a line, if there was a choice.
    pub fn reason(&self) -> Option<String> {
        let linear = self.linear;
        match &self.why {
            Why::Named => None,
            Why::Estimated { paths, solvers } => {
                let own = paths.iter().find(|path| path.linear == linear)?;
                let (mut with_room, without): (Vec<&SolverEstimate>, Vec<&SolverEstimate>) =
                    paths.iter().partition(|path| solvers.have_room(path));
                with_room.retain(|path| path.linear != linear);
                let seconds = |path: &&SolverEstimate| format!("{:.2} s for {}", path.cost.seconds, path.linear);
                let mut reason = format!("estimated {:.2} s", own.cost.seconds);
                if !with_room.is_empty() {
                    let with_room: Vec<String> = with_room.iter().map(seconds).collect();
                    reason = format!("{reason} against {}", with_room.join(" and "));
                }
                let needs = |path: &&SolverEstimate| format!("{} {}", path.linear, in_words(path.cost.bytes as u64));
                let without: Vec<String> = without.iter().map(needs).collect();
                if let (Some(available), false) = (solvers.available, without.is_empty()) {
                    let without = without.join(" and ");
                    reason =
                        format!("{reason}; {without} would take more memory than the {} left", in_words(available));
                }
                if solvers.ranks > 1 {
                    reason = format!("{} processes share its work; {reason}", solvers.ranks);
                }
                Some(format!("{linear} ({reason})"))
            }
        }
    }
}

impl AvailableSolvers {
    /// Returns the memory left for this process, without multigrid, for a problem whose node positions are unknown,
    /// which multigrid needs.
    pub fn of_process() -> Self {
        let available = Budget::of_process().map(|budget| budget.bytes);
        AvailableSolvers { available, multigrid: false, ranks: ranks() }
    }

    fn have_room(&self, path: &SolverEstimate) -> bool {
        self.available.is_none_or(|available| path.cost.bytes <= available as f64)
    }
}

/// Estimates the number of factorisations of `method` for `increments` increments.
pub(crate) fn factorizations(layout: &Layout, method: HistoryMethod, increments: usize) -> f64 {
    match method {
        // Without contact the problem is linear and has one matrix.
        _ if layout.contacts() == 0 => 1.0,
        // One for each rate, independent of the increments.
        HistoryMethod::ExactPath => EVENT_RATES * layout.contacts() as f64,
        HistoryMethod::Increments(method) if method.is_interior() && layout.has_second_tangent() => {
            IP_FACTORIZATIONS_IN_A_PLANE * increments as f64
        }
        HistoryMethod::Increments(method) if method.is_interior() => IP_FACTORIZATIONS * increments as f64,
        HistoryMethod::Increments(_) if layout.has_second_tangent() => BN_FACTORIZATIONS_IN_A_PLANE * increments as f64,
        HistoryMethod::Increments(_) => BN_FACTORIZATIONS * (increments as f64).sqrt(),
    }
}

/// Returns the properties of the Cholesky factor of the stiffness, by one symbolic analysis.
pub(super) fn factor_of(problem: &ContactProblem) -> Result<FactorInfo, LinearError> {
    Cholesky::predict(problem.stiffness().assembled()?.as_ref())
}

/// Returns the work of `method`. Most nodes of a partial working set are taken to be open.
fn work(initial_set: &InitialWorkingSet, method: HistoryMethod, [increments, factorizations]: [f64; 2]) -> Work {
    let all_free = method.increments().is_interior() || initial_set.nodes.is_some();
    Work { increments, factorizations, all_free }
}

/// The data for estimates.
pub(super) struct Estimates {
    displacements: usize,
    sizes: Sizes,
    work: Work,
}

impl Estimates {
    pub(super) fn new(
        problem: &ContactProblem,
        initial_set: &InitialWorkingSet,
        work: Work,
        stiffness: FactorInfo,
    ) -> Self {
        let layout = Layout::new(problem);
        let held = match &initial_set.nodes {
            Some(nodes) => problem.contact_displacements_of(nodes.iter().copied()),
            None => problem.contact_displacements(),
        };
        let sizes = Sizes { unknowns: layout.unknowns(), contact_displacements: held.len(), stiffness };
        Estimates { displacements: layout.displacements(), sizes, work }
    }

    /// Returns the cost with this linear solver.
    pub(super) fn cost(&self, linear: LinearAlgebra) -> Cost {
        match linear {
            LinearAlgebra::Whole(lu) => cost::sparse(&self.sizes, &self.work, lu),
            LinearAlgebra::Condensed(_) => cost::condensed(&self.sizes, &self.work),
            LinearAlgebra::Multigrid | LinearAlgebra::Petsc => cost::multigrid(self.displacements, &self.work),
        }
    }

    /// Returns all solvers of this build: the default sparse LU, MUMPS, condensation and multigrid. With several
    /// processes, only solvers that use all of them.
    fn paths(&self, solvers: AvailableSolvers) -> Vec<SolverEstimate> {
        let whole = LinearAlgebra::default();
        let mut all = vec![whole];
        all.extend((whole != MUMPS).then_some(MUMPS));
        all.push(LinearAlgebra::condensed());
        all.extend(solvers.multigrid.then_some(LinearAlgebra::Multigrid));
        all.retain(|linear| linear.is_built_in());
        let shared: Vec<LinearAlgebra> = all.iter().copied().filter(|linear| linear.is_shared()).collect();
        let (of, ranks) = if solvers.ranks > 1 && !shared.is_empty() { (shared, solvers.ranks) } else { (all, 1) };
        let factorizations = self.work.factorizations;
        let path = |linear| SolverEstimate { linear, cost: self.cost(linear).shared_by(ranks), factorizations };
        of.into_iter().map(path).collect()
    }
}

impl std::fmt::Display for Faster {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Faster { solver, seconds, here_seconds } = self;
        write!(
            f,
            "the linear algebra is estimated to take {here_seconds:.1} s, but with {solver} only {seconds:.1} s: \
             solver.linear = \"auto\" chooses the faster solver"
        )
    }
}
