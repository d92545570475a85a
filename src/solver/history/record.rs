//! The records and verdicts of increments.

use crate::algebra::linear::{LinearError, Statistics};
use crate::base::displayed_as_written;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::events::Event;
use crate::solver::laws::{ContactStatus, KktErrors};
use crate::solver::newton::{IterationRecord, LinearSystem, MethodResult, Termination};
use crate::solver::problem::{Increment, State};
use serde::{Deserialize, Serialize};
use std::ops::ControlFlow;

/// The verdict on an increment and on a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Every law holds within the tolerance, by the independent error measure.
    #[default]
    Converged,
    /// The method's own stopping test was met, but a law is violated by more than the tolerance.
    Inaccurate,
    /// The limit of iterations was reached.
    MaxIterations,
    /// The limit of iterations was reached while the same sets of contact cases repeated.
    Cycling,
    /// The iteration left the range of numbers.
    Diverged,
    /// The iteration stalled away from the solution.
    Stalled,
    /// The linearised problem is singular, for example because nothing holds the body.
    Singular,
    /// A joint slips as a whole: the loads overcome all friction that holds the body.
    Slips,
    /// No equilibrium exists: no admissible contact forces balance the loads on the rigid body, which lifts off or
    /// tips.
    NoEquilibrium,
    /// No rates obey the laws beyond this load: the quasi-static motion ends, and a jump follows.
    NoContinuation,
    /// The linear solver gave numbers that are not finite.
    NotFinite,
    /// There was not enough memory.
    OutOfMemory,
    /// The run was stopped on request. Nothing more was solved, so that errors of forces and jumps are not told.
    Interrupted,
    /// The method does not support the problem: the paper's interior point method, and the extended Newton system,
    /// have one tangent at every node.
    Unsupported,
}

displayed_as_written!(Status);

/// The number of contact nodes in each status.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct ContactCounts {
    /// The number of nodes apart from the obstacle.
    pub open: usize,
    /// The number of nodes in contact without slip.
    pub stick: usize,
    /// The number of nodes in contact and sliding.
    pub slip: usize,
}

/// The wall time of an increment by its parts, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Seconds {
    /// The time for residuals, merits and Jacobian values.
    pub assembly: f64,
    /// The time for factorisations.
    pub factorization: f64,
    /// The time for solves with refinement and backward error.
    pub solve: f64,
    /// The time for everything else: loads, the error measure, records.
    pub rest: f64,
}

impl Seconds {
    /// Computes the times of an increment that took `all` seconds, from the statistics of the linear solver before
    /// and after it.
    pub(super) fn between(before: &Statistics, after: &Statistics, assembly: f64, all: f64) -> Self {
        let factorization = after.factor_seconds - before.factor_seconds;
        let solve = after.solve_seconds - before.solve_seconds;
        Seconds { assembly, factorization, solve, rest: all - assembly - factorization - solve }
    }
}

/// The record of one increment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct IncrementRecord {
    /// The number of the increment, from 1.
    pub index: usize,
    /// The time at the end of the increment, s.
    pub time: f64,
    /// The verdict.
    pub status: Status,
    /// The number of substeps that converged; 1 if the increment was not halved.
    pub parts: usize,
    /// The ends of the converged substeps, s; empty if the increment was not halved.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub part_ends: Vec<f64>,
    /// The number of contact nodes that joined the working set of the condensed equations in this increment.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub joined: usize,
    /// The number of attempts at the increment and its substeps: equal to `parts` if the first was always enough, 0 on an
    /// exact path.
    #[serde(default)]
    pub attempts: usize,
    /// `true` if a fallback method solved the increment or a substep.
    pub rescued: bool,
    /// The number of linear systems solved (nle), including failed attempts.
    pub iterations: usize,
    /// The number of shortened steps.
    pub backtracks: usize,
    /// The last `Theta` of the method.
    pub theta: f64,
    /// The error measure.
    pub kkt: KktErrors,
    /// The largest componentwise backward error of the linear solves.
    pub backward_error: f64,
    /// The number of contact nodes in each status.
    pub contact: ContactCounts,
    /// The work that friction dissipated in all converged substeps, J; in two dimensions J per m of depth.
    pub friction_work: f64,
    /// The strain energy `½ uᵀ K u` at the end, J; in two dimensions J per m of depth. A [run](crate::run::Run)
    /// reports that of the body, which differs if there are temperature strains or if supports move.
    pub strain_energy: f64,
    /// The wall time.
    pub seconds: Seconds,
}

impl IncrementRecord {
    /// Creates the record of increment 0: the body at t = 0 with `contacts` contact nodes, before anything is solved.
    pub(crate) fn undeformed(contacts: usize) -> Self {
        let contact = ContactCounts { open: contacts, ..ContactCounts::default() };
        IncrementRecord { contact, ..IncrementRecord::default() }
    }
}

/// The totals over the increments of a history.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Tally {
    /// The number of increments, including one that did not converge.
    pub increments: usize,
    /// The number of increments that converged.
    pub converged: usize,
    /// The number of linear systems solved by the method.
    pub iterations: usize,
    /// The largest errors of all judged increments; one that was interrupted, or has no solution, is not judged.
    pub kkt: KktErrors,
}

impl Tally {
    /// Adds an increment to the totals.
    pub(super) fn add(&mut self, record: &IncrementRecord) {
        self.increments += 1;
        self.converged += usize::from(record.status == Status::Converged);
        self.iterations += record.iterations;
        if !matches!(record.status, Status::Interrupted | Status::Slips | Status::NoEquilibrium) {
            self.kkt = self.kkt.max(&record.kkt);
        }
    }
}

/// Returns `true` for 0; serde passes a reference.
#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Returns `true` if every error is at most the `tolerance`: the rule that makes an increment, and so a run, converged.
pub(super) fn is_solution(kkt: &KktErrors, tolerance: f64) -> bool {
    kkt.worst().1 <= tolerance
}

/// Returns the verdict. The error measure alone decides if an increment converged; the method's termination explains
/// why it did not. An interrupted increment is not judged.
pub(super) fn verdict(solved: &MethodResult, kkt: &KktErrors, tolerance: f64) -> Status {
    match solved.stop {
        Termination::Interrupted => Status::Interrupted,
        _ if is_solution(kkt, tolerance) => Status::Converged,
        Termination::Converged => Status::Inaccurate,
        Termination::MaxIterations => Status::MaxIterations,
        Termination::Cycling => Status::Cycling,
        Termination::Diverged => Status::Diverged,
        Termination::Stalled => Status::Stalled,
        Termination::Singular(LinearError::NotFinite) => Status::NotFinite,
        Termination::Unconstrained(_) | Termination::Singular(_) => Status::Singular,
        Termination::Slips(_) => Status::Slips,
        Termination::NoEquilibrium(_) => Status::NoEquilibrium,
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

/// An increment with its data and state, for an observer.
#[derive(Debug, Clone, Copy)]
pub struct IncrementView<'a> {
    /// The record of the increment.
    pub record: &'a IncrementRecord,
    /// The data of the increment.
    pub increment: &'a Increment<'a>,
    /// The state at the end of the increment.
    pub state: &'a State,
    /// The status of each contact node.
    pub statuses: &'a [ContactStatus],
}

/// An observer of a history: for progress, files and plots, or to stop it.
pub trait Observer {
    /// Called before the first increment, when the patterns are analysed and the first matrix is factored.
    fn ready(&mut self) {}
    /// Called at the start of the iteration of increment `index`, and after each of its steps.
    fn iteration(&mut self, _index: usize, _record: &IterationRecord) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    /// Called after each step of increment `index`, before [`Observer::iteration`], with the linearised equations of
    /// the step as they were solved. If the body is condensed, they are those of the contact displacements.
    fn linear_system(&mut self, _index: usize, _system: &LinearSystem<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called after a contact node has changed its status in increment `index` of an exact path.
    fn event(&mut self, _index: usize, _event: &Event) {}

    /// Called after each substep of a halved increment except the last. The record is that of the increment so far:
    /// its `time` is the end of the substep, its `parts` the number of the substep from 1.
    fn substep(&mut self, _part: &IncrementView<'_>) {}

    /// Called after each increment, including a failed one.
    fn increment(&mut self, _step: &IncrementView<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    /// Called between two increments and after the last, where the history can be resumed. `here` makes the
    /// checkpoint, which costs a copy of the state.
    fn checkpoint_offered(&mut self, _here: &dyn Fn() -> Checkpoint) {}
}

/// An observer that does nothing.
impl Observer for () {}
