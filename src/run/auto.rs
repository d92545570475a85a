//! Which linear algebra a problem is solved with, where that is left open: what is estimated to take the
//! least time, as far as memory allows.
//!
//! One symbolic analysis of `K` serves all estimates, see [`crate::algebra::linear::cost`]. It takes about as long as
//! ordering once.

use serde::Serialize;

use crate::algebra::linear::built_in::ranks;
use crate::algebra::linear::cost::{self, Cost, Sizes, Work};
use crate::algebra::linear::{Cholesky, FactorInfo, LinearError, SparseLu};
use crate::base::memory::{Budget, in_words};
use crate::solver::formulation::Layout;
use crate::solver::history::{LinearAlgebra, Method};
use crate::solver::initial_working_set::InitialWorkingSet;
use crate::solver::problem::ContactProblem;

/// BN keeps its factors while no contact status changes, so its factorisations grow as the root of the number
/// of increments, this many times it: 5, 7.5, 11 and 14 on the paper's block with 25, 50, 100 and 200 contact nodes (2 to
/// 100 increments), 3 to 11 on strips.
const BN_FACTORIZATIONS: f64 = 8.0;

/// Where nodes slide in a plane, the direction of their slip turns and the matrix with it: so many factorisations in an
/// increment. 6 to 10 with 2 increments, 5 to 7 with 10 and 4 to 5 with 40 on cubes and plates of 8 to 32 elements along
/// the contact.
const BN_FACTORIZATIONS_IN_A_PLANE: f64 = 5.0;

/// An interior point method changes its matrix in each iteration: 5 to 8 in an increment in the tables of the paper.
const IP_FACTORIZATIONS: f64 = 6.0;

/// The same for the exact cone, where nodes slide in a plane: 13.8 and 14.4 on a plate of 24 × 24 × 6 elements with 5 and 10
/// increments.
const IP_FACTORIZATIONS_IN_A_PLANE: f64 = 14.0;

const MUMPS: LinearAlgebra = LinearAlgebra::Whole(SparseLu::Mumps);

/// A choice, with its reason if it was left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// What solves.
    pub linear: LinearAlgebra,
    why: Why,
}

#[derive(Debug, Clone, PartialEq)]
enum Why {
    Named,
    /// The least time of all these that have room.
    Estimated {
        paths: Vec<Path>,
        means: AvailableSolvers,
    },
}

/// A way to solve, and what it is estimated to take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// The linear algebra.
    pub linear: LinearAlgebra,
    /// What it takes for all increments.
    pub cost: Cost,
}

/// What may be chosen from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AvailableSolvers {
    /// Free memory, bytes, if it is known.
    pub available: Option<u64>,
    /// Whether multigrid suits the problem, see [`crate::run::unsuited`].
    pub multigrid: bool,
    /// How many processes of MPI there are. With several only what they share is chosen from.
    pub ranks: usize,
}

/// A linear algebra that is estimated to take much less time than the one of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Faster {
    /// The other one, by the word that scenes have for it.
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub solver: LinearAlgebra,
    /// What its linear algebra is estimated to take, s.
    pub seconds: f64,
    /// What that of the run is, by the same estimate, s.
    pub here_seconds: f64,
}

/// Rates of an exact path for each contact node: 1.7 to 2.8 on the paper's block.
const EVENT_RATES: f64 = 2.5;

/// Estimates are good to a factor of two or so: less than this between two of them is not worth a word.
const MUCH: f64 = 3.0;

/// An estimate takes less than an ordering of the unknowns. A run that took so many of them can afford it, and a gain of
/// fewer is none.
const ORDERINGS: f64 = 10.0;

/// What a run has done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Done {
    /// How many increments.
    pub increments: usize,
    /// With so many factorisations.
    pub factorizations: usize,
    /// Its wall time, s.
    pub seconds: f64,
}

impl Choice {
    /// The one that was asked for.
    pub fn named(linear: LinearAlgebra) -> Self {
        Choice { linear, why: Why::Named }
    }

    /// The fastest way that has room to solve `increments` increments of `problem` with `method`, where condensed equations hold the
    /// contact nodes `reach` or all; the one that takes least memory where none has room.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn cheapest(
        problem: &ContactProblem,
        reach: &InitialWorkingSet,
        method: Method,
        increments: usize,
        means: AvailableSolvers,
    ) -> Result<Self, LinearError> {
        let factorizations = factorizations(&Layout::new(problem), method, increments);
        let work = [increments as f64, factorizations];
        let sizes = Estimates::new(problem, reach, method, work, Cholesky::predict(problem.stiffness())?);
        let paths = sizes.paths(means);
        let by = |measure: fn(&Path) -> f64| move |a: &&Path, b: &&Path| measure(a).total_cmp(&measure(b));
        let fastest = paths.iter().filter(|path| means.have_room(path)).min_by(by(|path| path.cost.seconds));
        let chosen = fastest.or_else(|| paths.iter().min_by(by(|path| path.cost.bytes)));
        let linear = chosen.map_or_else(LinearAlgebra::default, |path| path.linear);
        Ok(Choice { linear, why: Why::Estimated { paths, means } })
    }

    /// What there was to choose from, each with its estimate; nothing where there was nothing to choose.
    pub fn paths(&self) -> &[Path] {
        match &self.why {
            Why::Estimated { paths, .. } => paths,
            Why::Named => &[],
        }
    }

    /// What would have been much faster than this choice, which somebody made, for what it has done. Nothing, if
    /// there is no such way, or if the run was so short that the question would make it longer.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn faster(
        &self,
        problem: &ContactProblem,
        reach: &InitialWorkingSet,
        method: Method,
        means: AvailableSolvers,
        done: &Done,
    ) -> Result<Option<Faster>, LinearError> {
        let unknowns = Layout::new(problem).unknowns();
        let long = ORDERINGS * cost::order(unknowns);
        if matches!(self.why, Why::Estimated { .. }) || done.seconds < long {
            return Ok(None);
        }
        let work = [done.increments, done.factorizations].map(|count| count as f64);
        let estimates = |stiffness| Estimates::new(problem, reach, method, work, stiffness);
        let fastest = |estimates: &Estimates| {
            let others = estimates.paths(means).into_iter().filter(|path| !self.is_like(path.linear));
            let with_room = others.filter(|path| means.have_room(path));
            with_room.min_by(|a, b| a.cost.seconds.total_cmp(&b.cost.seconds))
        };
        // No factor has fewer entries than the matrix.
        let least = FactorInfo { entries: problem.stiffness().lower().values().len(), ..FactorInfo::default() };
        if fastest(&estimates(least)).is_none_or(|other| MUCH * other.cost.seconds > done.seconds) {
            return Ok(None);
        }
        let estimates = estimates(Cholesky::predict(problem.stiffness())?);
        let here_seconds = estimates.cost(self.linear).shared_by(means.ranks).seconds;
        let worth_a_word = |other: &Path| here_seconds > MUCH * other.cost.seconds && here_seconds > long;
        let faster = |other: Path| Faster { solver: other.linear, seconds: other.cost.seconds, here_seconds };
        Ok(fastest(&estimates).filter(worth_a_word).map(faster))
    }

    /// Whether this is the same way but for the library.
    fn is_like(&self, other: LinearAlgebra) -> bool {
        std::mem::discriminant(&self.linear) == std::mem::discriminant(&other)
    }

    /// The choice and its reason in a line, if there was anything to choose.
    pub fn reason(&self) -> Option<String> {
        let linear = self.linear;
        match &self.why {
            Why::Named => None,
            Why::Estimated { paths, means } => {
                let own = paths.iter().find(|path| path.linear == linear)?;
                let (mut with_room, without): (Vec<&Path>, Vec<&Path>) =
                    paths.iter().partition(|path| means.have_room(path));
                with_room.retain(|path| path.linear != linear);
                let seconds = |path: &&Path| format!("{:.2} s for {}", path.cost.seconds, path.linear);
                let mut reason = format!("estimated {:.2} s", own.cost.seconds);
                if !with_room.is_empty() {
                    let with_room: Vec<String> = with_room.iter().map(seconds).collect();
                    reason = format!("{reason} against {}", with_room.join(" and "));
                }
                let needs = |path: &&Path| format!("{} {}", path.linear, in_words(path.cost.bytes as u64));
                let without: Vec<String> = without.iter().map(needs).collect();
                if let (Some(available), false) = (means.available, without.is_empty()) {
                    let without = without.join(" and ");
                    reason =
                        format!("{reason}; {without} would take more memory than the {} left", in_words(available));
                }
                if means.ranks > 1 {
                    reason = format!("{} processes share its work; {reason}", means.ranks);
                }
                Some(format!("{linear} ({reason})"))
            }
        }
    }
}

impl AvailableSolvers {
    /// What is left for this process, for a problem of which nobody knows where its unknowns are, as multigrid has to.
    pub fn of_process() -> Self {
        let available = Budget::of_process().map(|budget| budget.bytes);
        AvailableSolvers { available, multigrid: false, ranks: ranks() }
    }

    fn have_room(&self, path: &Path) -> bool {
        self.available.is_none_or(|available| path.cost.bytes <= available as f64)
    }
}

/// How many factorisations BN or an interior point method needs for `increments` increments, as an estimate.
pub(crate) fn factorizations(layout: &Layout, method: Method, increments: usize) -> f64 {
    match method {
        // Without contact the problem is linear: one matrix.
        _ if layout.contacts() == 0 => 1.0,
        // One for each rate, whatever the increments.
        Method::Events { .. } => EVENT_RATES * layout.contacts() as f64,
        method if method.is_interior() && layout.has_second_tangent() => {
            IP_FACTORIZATIONS_IN_A_PLANE * increments as f64
        }
        method if method.is_interior() => IP_FACTORIZATIONS * increments as f64,
        _ if layout.has_second_tangent() => BN_FACTORIZATIONS_IN_A_PLANE * increments as f64,
        _ => BN_FACTORIZATIONS * (increments as f64).sqrt(),
    }
}

/// What estimates are made of.
struct Estimates {
    displacements: usize,
    sizes: Sizes,
    work: Work,
}

impl Estimates {
    fn new(
        problem: &ContactProblem,
        reach: &InitialWorkingSet,
        method: Method,
        [increments, factorizations]: [f64; 2],
        stiffness: FactorInfo,
    ) -> Self {
        let layout = Layout::new(problem);
        let held = match &reach.nodes {
            Some(nodes) => problem.contact_displacements_of(nodes.iter().copied()),
            None => problem.contact_displacements(),
        };
        let sizes = Sizes { unknowns: layout.unknowns(), contact_displacements: held.len(), stiffness };
        // In a part of the contact nodes those that are open prevail.
        let all_free = method.is_interior() || reach.nodes.is_some();
        let work = Work { increments, factorizations, all_free };
        Estimates { displacements: layout.displacements(), sizes, work }
    }

    fn cost(&self, linear: LinearAlgebra) -> Cost {
        match linear {
            LinearAlgebra::Whole(lu) => cost::sparse(&self.sizes, &self.work, lu),
            LinearAlgebra::Condensed(_) => cost::condensed(&self.sizes, &self.work),
            LinearAlgebra::Multigrid => cost::multigrid(self.displacements, &self.work),
        }
    }

    /// All ways that this build has; of sparse LU the default one, and MUMPS. With several processes, those that share their work.
    fn paths(&self, means: AvailableSolvers) -> Vec<Path> {
        let whole = LinearAlgebra::default();
        let mut all = vec![whole];
        all.extend((whole != MUMPS).then_some(MUMPS));
        all.push(LinearAlgebra::condensed());
        all.extend(means.multigrid.then_some(LinearAlgebra::Multigrid));
        all.retain(|linear| linear.is_built_in());
        let shared: Vec<LinearAlgebra> = all.iter().copied().filter(|linear| linear.is_shared()).collect();
        let (of, ranks) = if means.ranks > 1 && !shared.is_empty() { (shared, means.ranks) } else { (all, 1) };
        of.into_iter().map(|linear| Path { linear, cost: self.cost(linear).shared_by(ranks) }).collect()
    }
}

impl std::fmt::Display for Faster {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Faster { solver, seconds, here_seconds } = self;
        write!(
            f,
            "the linear algebra is estimated to take {here_seconds:.1} s, with {solver} {seconds:.1} s: \
             solver.linear = \"auto\" chooses the faster"
        )
    }
}
