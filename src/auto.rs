//! Which linear algebra a problem is solved with, where that is left open: what is estimated to take the
//! least time, as far as memory allows.
//!
//! One symbolic analysis of `K` serves both estimates, see [`crate::linear::cost`]. It takes about as long as
//! ordering once.

use serde::Serialize;

use crate::formulation::Layout;
use crate::history::{LinearAlgebra, Method};
use crate::linear::cost::{self, Cost, Sizes, Work};
use crate::linear::{Cholesky, FactorInfo, LinearError, SparseLu};
use crate::problem::ContactProblem;
use crate::reach::Reach;

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

/// A choice, with its reason if it was left open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// What solves.
    pub linear: LinearAlgebra,
    estimates: Option<Estimates>,
    /// Free memory, bytes, if it was too little for the condensed system.
    short_of: Option<u64>,
}

/// What both ways are estimated to take.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Estimates {
    sparse: Cost,
    condensed: Cost,
}

/// A linear algebra that is estimated to take much less time than the one of a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
pub struct Faster {
    /// The other one, by the word that scenes have for it.
    #[cfg_attr(feature = "cli", schemars(with = "String"))]
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
        Choice { linear, estimates: None, short_of: None }
    }

    /// The cheapest way to solve `increments` increments of `problem` with `method`, where condensed equations hold the contact
    /// nodes `reach` or all; `available` is the free memory in bytes, if it is known.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn cheapest(
        problem: &ContactProblem,
        reach: &Reach,
        method: Method,
        increments: usize,
        available: Option<u64>,
    ) -> Result<Self, LinearError> {
        let factorizations = factorizations(&Layout::new(problem), method, increments);
        let estimates = Estimates::new(
            problem,
            reach,
            method,
            [increments as f64, factorizations],
            Cholesky::predict(problem.stiffness())?,
        );
        let Estimates { sparse, condensed } = estimates;
        let short_of = available.filter(|&available| condensed.bytes > available as f64);
        let condense = condensed.seconds < sparse.seconds && short_of.is_none();
        let linear = if condense { LinearAlgebra::condensed() } else { LinearAlgebra::default() };
        Ok(Choice { linear, estimates: Some(estimates), short_of })
    }

    /// What would have been much faster than this choice, which somebody made, for what it has done. Nothing, if
    /// there is no such way, or if the run was so short that the question would make it longer.
    ///
    /// # Errors
    /// When memory is short for the symbolic analysis.
    pub fn faster(
        &self,
        problem: &ContactProblem,
        reach: &Reach,
        method: Method,
        done: &Done,
    ) -> Result<Option<Faster>, LinearError> {
        let unknowns = Layout::new(problem).unknowns();
        let long = ORDERINGS * cost::order(unknowns);
        if self.estimates.is_some() || done.seconds < long {
            return Ok(None);
        }
        let work = [done.increments, done.factorizations].map(|count| count as f64);
        let estimates = |stiffness| Estimates::new(problem, reach, method, work, stiffness);
        // No factor has fewer entries than the matrix.
        let least = FactorInfo { entries: problem.stiffness().lower().values().len(), ..FactorInfo::default() };
        let other = |Estimates { sparse, condensed }| if self.linear.condenses() { sparse } else { condensed };
        if MUCH * other(estimates(least)).seconds > done.seconds {
            return Ok(None);
        }
        let Estimates { sparse, condensed } = estimates(Cholesky::predict(problem.stiffness())?);
        let (here, other, solver) = match self.linear {
            LinearAlgebra::Condensed(_) => (condensed, sparse, LinearAlgebra::default()),
            LinearAlgebra::Whole(_) | LinearAlgebra::Multigrid => (sparse, condensed, LinearAlgebra::condensed()),
        };
        let faster = Faster { solver, seconds: other.seconds, here_seconds: here.seconds };
        let worth_a_word = here.seconds > MUCH * other.seconds && here.seconds > long;
        Ok((worth_a_word && solver.is_built_in()).then_some(faster))
    }

    /// The choice and its reason in a line, if there was anything to choose.
    pub fn reason(&self) -> Option<String> {
        let Estimates { sparse, condensed } = self.estimates?;
        if let Some(available) = self.short_of {
            let gigabytes = |bytes: f64| bytes * 1e-9;
            let (needed, free) = (gigabytes(condensed.bytes), gigabytes(available as f64));
            return Some(format!(
                "{} (condensed would take {needed:.1} GB of memory, {free:.1} GB are free)",
                self.linear
            ));
        }
        let (taken, other, name) = match self.linear {
            LinearAlgebra::Condensed(_) => (condensed, sparse, LinearAlgebra::default()),
            LinearAlgebra::Whole(_) | LinearAlgebra::Multigrid => (sparse, condensed, LinearAlgebra::condensed()),
        };
        Some(format!(
            "{} (estimated {:.2} s against {:.2} s for {name}; {:.1e} flops an iteration against {:.1e})",
            self.linear, taken.seconds, other.seconds, taken.flops, other.flops
        ))
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

impl Estimates {
    fn new(
        problem: &ContactProblem,
        reach: &Reach,
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
        Estimates {
            sparse: cost::sparse(&sizes, &work, SparseLu::default() == SparseLu::Faer),
            condensed: cost::condensed(&sizes, &work),
        }
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
