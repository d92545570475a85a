//! What is recorded of an increment.

use crate::algebra::linear::{LinearError, Statistics};
use crate::solver::laws::{ContactStatus, KktErrors};
use crate::solver::newton::{MethodResult, Termination};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The verdict on an increment and on a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Every law holds within the tolerance, by the independent error measure.
    Converged,
    /// The solver's own stop test was met, but a law is violated by more than the tolerance.
    Inaccurate,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The limit of iterations was reached, going through the same sets of contact cases again and again.
    Cycling,
    /// The iteration left the range of numbers.
    Diverged,
    /// The iteration came to a halt away from the solution.
    Stalled,
    /// The linearised problem is singular, as when nothing holds the body.
    Singular,
    /// No equilibrium exists: no admissible contact forces balance the loads on the rigid body.
    NoEquilibrium,
    /// No rates obey the laws beyond this load: the quasi-static motion ends, and what follows is a jump.
    NoContinuation,
    /// Nothing balances the loads but friction across an edge between two obstacles, which the equations leave out.
    EdgeFriction,
    /// The linear algebra gave numbers that are not finite.
    NotFinite,
    /// There was not enough memory to go on.
    OutOfMemory,
    /// Stopped on request.
    Interrupted,
    /// The method does not know such a problem: the paper's interior point method, and the extended Newton
    /// system, have one tangent at every node.
    Unsupported,
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Status::Converged => "converged",
            Status::Inaccurate => "inaccurate",
            Status::MaxIterations => "max-iterations",
            Status::Cycling => "cycling",
            Status::Diverged => "diverged",
            Status::Stalled => "stalled",
            Status::Singular => "singular",
            Status::NoEquilibrium => "no-equilibrium",
            Status::NoContinuation => "no-continuation",
            Status::EdgeFriction => "edge-friction",
            Status::NotFinite => "not-finite",
            Status::OutOfMemory => "out-of-memory",
            Status::Interrupted => "interrupted",
            Status::Unsupported => "unsupported",
        })
    }
}

/// How many contact nodes are in each status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContactCounts {
    /// Apart from the obstacle.
    pub open: usize,
    /// In contact without slip.
    pub stick: usize,
    /// In contact and sliding.
    pub slip: usize,
}

/// Where the wall time of an increment went, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Seconds {
    /// Residuals, merits and Jacobian values.
    pub assembly: f64,
    /// Factorisations.
    pub factorization: f64,
    /// Solves with refinement and backward error.
    pub solve: f64,
    /// Everything else: loads, the error measure, records.
    pub rest: f64,
}

impl Seconds {
    /// Those of an increment that took `all` seconds, by what the linear algebra had done before and after it.
    pub(super) fn between(before: &Statistics, after: &Statistics, assembly: f64, all: f64) -> Self {
        let factorization = after.factor_seconds - before.factor_seconds;
        let solve = after.solve_seconds - before.solve_seconds;
        Seconds { assembly, factorization, solve, rest: all - assembly - factorization - solve }
    }
}

/// One increment, as reported.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct IncrementRecord {
    /// Its number, from 1.
    pub index: usize,
    /// The time at its end, s.
    pub time: f64,
    /// The verdict.
    pub status: Status,
    /// How many parts of it converged: 1 if it did not have to be halved.
    pub parts: usize,
    /// The ends of these parts, s; empty if it did not have to be halved.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub part_ends: Vec<f64>,
    /// How many contact nodes joined the condensed equations in it, where these do not hold all.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub joined: usize,
    /// How many jumps over the end of a quasi-static motion there are in it.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub jumps: usize,
    /// Whether another method solved it, or a part of it, in place of the one asked for.
    pub rescued: bool,
    /// Linear systems solved (nle), in failed attempts, too.
    pub iterations: usize,
    /// Steps shortened.
    pub backtracks: usize,
    /// The last `Theta` of the solver.
    pub theta: f64,
    /// The error measure.
    pub kkt: KktErrors,
    /// The largest componentwise backward error of the linear solves.
    pub backward_error: f64,
    /// Statuses of the contact nodes.
    pub contact: ContactCounts,
    /// The work that friction dissipated in it, in all parts that converged, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The strain energy `½ uᵀ K u` at its end, J; in two dimensions J per m of depth. A [run](crate::run::Run) tells that of the
    /// body, which differs where temperature strains it or supports move it.
    pub strain_energy: f64,
    /// Wall time.
    pub seconds: Seconds,
}

impl IncrementRecord {
    /// The record of increment 0: the body at t = 0 with so many contact nodes, before anything is solved.
    pub(crate) fn undeformed(contacts: usize) -> Self {
        IncrementRecord {
            index: 0,
            time: 0.0,
            status: Status::Converged,
            parts: 0,
            part_ends: Vec::new(),
            joined: 0,
            jumps: 0,
            rescued: false,
            iterations: 0,
            backtracks: 0,
            theta: 0.0,
            kkt: KktErrors::default(),
            backward_error: 0.0,
            contact: ContactCounts { open: contacts, ..ContactCounts::default() },
            friction_work: 0.0,
            strain_energy: 0.0,
            seconds: Seconds::default(),
        }
    }
}

/// What the increments of a history add up to.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// The increments that were reached, the one included that did not converge.
    pub increments: usize,
    /// Those that converged.
    pub converged: usize,
    /// Linear systems solved by the method.
    pub iterations: usize,
    /// The largest errors of all that were judged: one that was interrupted is not.
    pub kkt: KktErrors,
}

impl Tally {
    /// Takes an increment in.
    pub(super) fn add(&mut self, record: &IncrementRecord) {
        self.increments += 1;
        self.converged += usize::from(record.status == Status::Converged);
        self.iterations += record.iterations;
        if record.status != Status::Interrupted {
            self.kkt = self.kkt.max(&record.kkt);
        }
    }
}

/// For serde, which hands over a reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Converged is what the error measure says, whatever the solver thinks; how the solver ended only
/// tells why it did not. An increment that was interrupted is not judged.
pub(super) fn verdict(solved: &MethodResult, kkt: &KktErrors, tolerance: f64) -> Status {
    match solved.stop {
        Termination::Interrupted => Status::Interrupted,
        _ if kkt.worst().1 <= tolerance => Status::Converged,
        Termination::Converged => Status::Inaccurate,
        Termination::MaxIterations => Status::MaxIterations,
        Termination::Cycling => Status::Cycling,
        Termination::Diverged => Status::Diverged,
        Termination::Stalled => Status::Stalled,
        Termination::Singular(LinearError::NotFinite) => Status::NotFinite,
        Termination::Unconstrained(_) | Termination::Singular(_) => Status::Singular,
        Termination::NoEquilibrium(_) => Status::NoEquilibrium,
        Termination::EdgeFriction(_) => Status::EdgeFriction,
    }
}

impl ContactCounts {
    pub(super) fn of(statuses: &[ContactStatus]) -> Self {
        let mut counts = ContactCounts::default();
        for status in statuses {
            match status {
                ContactStatus::Open => counts.open += 1,
                ContactStatus::Stick => counts.stick += 1,
                ContactStatus::Slip => counts.slip += 1,
            }
        }
        counts
    }
}
