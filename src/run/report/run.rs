//! The report of a whole run, as `--json` prints it.

use serde::Serialize;

use super::balance::BalanceRecord;
use super::cycle::CycleReport;
use super::estimates::Estimates;
use super::explain::Explanation;
use super::friction_use::FrictionUse;
use super::history_curves::HistoryCurves;
use super::key_results::{FrictionResult, HoldingForce, LargestForce};
use super::pairs::PairRecord;
use super::peak::LargestPressure;
use super::pretension_force::PretensionForce;
use super::quantities::{self, UnitNames};
use super::resultant::{ComponentSums, ForceRecord, Resultant};
use super::unknowns::{EliminatedUnknown, Unknowns};
use super::usage::{RankRecord, cpu_seconds, peak_rss_bytes};
use super::warnings::Warning;
use crate::algebra::linear::process::blas::Blas;
use crate::base::units::UnitSystem;
use crate::body::estimate::StickZone;
use crate::body::model::{Model, RangeLeft};
use crate::run::refinement::CoarserMesh;
use crate::solver::events::PathEnd;
use crate::solver::history::{HistoryOutcome, IncrementRecord, Status, WorkingSet};
use crate::solver::laws::KktErrors;
use crate::solver::uniqueness::CriticalFriction;
use std::time::Instant;

/// The version of the keys of a report. New keys do not change it; removed keys or changed meanings do.
pub const SCHEMA_VERSION: u32 = 1;

/// All results of a run except the fields. All numbers are SI, and serde writes them so; [`RunReport::to_json`]
/// converts them to the units of the model.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct RunReport {
    /// The version of these keys, 1.
    pub schema_version: u32,
    /// The version of stickslip.
    pub program_version: &'static str,
    /// The scene file; none if the model was made without one.
    pub scene: Option<String>,
    /// The text of the scene that was run, including overrides.
    pub scene_text: Option<String>,
    /// The scene's title; empty without a scene.
    pub title: String,
    /// The units of the report.
    #[serde(skip)]
    pub units: UnitSystem,
    /// The solution method.
    pub method: &'static str,
    /// The named setting of the method.
    pub setting: &'static str,
    /// The linear solver: `umfpack`, `faer` or `condensed`, or the name of an external solver.
    pub solver: String,
    /// The reason for the choice of the linear solver, if the scene leaves it open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_choice: Option<String>,
    /// The BLAS used by the factorisations, in a build that has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blas: Option<Blas>,
    /// The verdict.
    pub status: Status,
    /// The reason why the run ended early.
    #[serde(flatten)]
    pub explanation: Explanation,
    /// The largest contact pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_pressure: Option<LargestPressure>,
    /// The largest contact force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_force: Option<LargestForce>,
    /// The largest tangential force of a contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holding_force: Option<HoldingForce>,
    /// The use of the friction of each contact that has some.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub friction_use: Vec<FrictionUse>,
    /// The force of each pretension.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pretension_forces: Vec<PretensionForce>,
    /// The friction work, if anything slipped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionResult>,
    /// The stick zone when the tangential forces were largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stick_zone: Option<StickZone>,
    /// The load cycle that was asked for, if the history has reached its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cycle: Option<CycleReport>,
    /// The bodies, if there are several, in the order of the field `body`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyRecord>,
    /// Reasons why the result may be inaccurate although the laws hold.
    pub warnings: Vec<Warning>,
    /// The largest displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacement: Option<LargestDisplacement>,
    /// The node and time of the largest departure from the range of linearised gaps, if there was any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_left: Option<RangeLeft>,
    /// The error estimates.
    pub estimates: Estimates,
    /// The number of unknowns of each kind.
    pub unknowns: Unknowns,
    /// The eliminated unknowns, and the reasons.
    pub left_out: Vec<EliminatedUnknown>,
    /// The working set of condensed equations, if it did not contain all contact nodes at first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub working_set: Option<WorkingSet>,
    /// The meshes on which the history was solved before, if the mesh refined itself.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub coarser_meshes: Vec<CoarserMesh>,
    /// Additional ends of increments, s: kinks of histories that do not coincide with ends of equal increments.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub kinks: Vec<f64>,
    /// One record per increment; empty if the records are written elsewhere during the run, see
    /// [`Run::solve_to`](crate::run::Run::solve_to).
    pub increments: Vec<IncrementRecord>,
    /// The course of the exact path, if it was followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact_path: Option<ExactPath>,
    /// Sums over the run.
    pub totals: Totals,
    /// The sums of the components of all contact forces at the end of the last converged increment.
    #[serde(rename = "final")]
    pub end: ComponentSums,
    /// The pairs of opposing boundaries at the end of the last converged increment.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairRecord>,
    /// The resultant of each boundary with contact at the end of the last converged increment.
    pub boundaries: Vec<Resultant>,
    /// The resultants at the end of each increment.
    pub forces: Vec<ForceRecord>,
    /// The other forces on the body at the end of each increment: loads, reactions of supports, springs; and the
    /// balance.
    pub reactions: Vec<BalanceRecord>,
    /// The critical friction at the end of the last converged increment, if it was requested, or if an exact path ended
    /// early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_friction: Option<CriticalFriction>,
    /// The other forces on the body at the end of the last converged increment.
    #[serde(skip)]
    pub last_reactions: Option<BalanceRecord>,
    /// The curves for the charts of the history.
    #[serde(skip)]
    pub curves: HistoryCurves,
}

/// The course of an exact path.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct ExactPath {
    /// The number of changes of contact status.
    pub events: usize,
    /// The end of the quasi-static motion, if it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost: Option<PathEnd>,
}

impl ExactPath {
    pub(in crate::run) fn of(outcome: &HistoryOutcome) -> Self {
        ExactPath { events: outcome.event_count, lost: outcome.lost }
    }
}

/// One of several bodies.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct BodyRecord {
    /// The name of the body.
    pub name: String,
    /// The number of its nodes.
    pub nodes: usize,
    /// The number of its cells.
    pub cells: usize,
}

impl BodyRecord {
    /// Returns the bodies of `model`; empty if there is only one.
    pub(in crate::run) fn all(model: &Model) -> Vec<Self> {
        let bodies = model.mesh.bodies();
        let record = |(k, name): (usize, &String)| BodyRecord {
            name: name.clone(),
            nodes: bodies.nodes(k).count(),
            cells: bodies.cells(k).count(),
        };
        if bodies.are_several() { bodies.names().iter().enumerate().map(record).collect() } else { Vec::new() }
    }
}

/// The largest displacement of a history.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct LargestDisplacement {
    /// The length of the displacement, m.
    pub length: f64,
    /// The node's position, m.
    pub position: [f64; 3],
    /// The time, s.
    pub time: f64,
}

/// Sums over a run.
#[derive(Debug, Clone, PartialEq, Serialize, schemars::JsonSchema)]
#[non_exhaustive]
pub struct Totals {
    /// The number of increments that converged.
    pub converged: usize,
    /// The largest error of each law in any increment.
    pub kkt: KktErrors,
    /// The number of linear systems solved by the method.
    pub iterations: usize,
    /// The number of numerical factorisations, including the one of the clamped body.
    pub factorizations: usize,
    /// The number of symbolic analyses.
    pub symbolic_analyses: usize,
    /// The number of iterations of the linear solver, with multigrid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub krylov_iterations: Option<usize>,
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time for mesh, assembly, patterns and symbolic analysis, s.
    pub setup_seconds: f64,
    /// The number of threads.
    pub threads: usize,
    /// Peak resident memory of the process, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// The time and memory of each process, including this one, if MPI has started several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ranks: Vec<RankRecord>,
    /// The number of entries of the factors L and U; with faer an upper bound.
    pub nnz_factors: usize,
    /// The largest componentwise backward error of any solve.
    pub backward_error: f64,
}

impl Totals {
    /// Returns the sums over a run whose model took `model_seconds`, and whose history began at `start`.
    pub(in crate::run) fn new(outcome: &HistoryOutcome, model_seconds: f64, start: Instant) -> Self {
        let (tally, linear) = (&outcome.tally, &outcome.linear);
        Totals {
            converged: tally.converged,
            kkt: tally.kkt,
            iterations: tally.iterations,
            factorizations: linear.factorizations,
            symbolic_analyses: linear.analyses,
            krylov_iterations: Some(linear.krylov_iterations).filter(|iterations| *iterations > 0),
            cpu_seconds: cpu_seconds(),
            wall_seconds: model_seconds + start.elapsed().as_secs_f64(),
            setup_seconds: model_seconds + outcome.setup_seconds,
            threads: rayon::current_num_threads(),
            peak_rss_bytes: peak_rss_bytes(),
            ranks: RankRecord::all(),
            nnz_factors: linear.factor.entries,
            backward_error: linear.worst_backward_error,
        }
    }
}

impl RunReport {
    /// Formats the report as one JSON object, in its [`RunReport::units`], which it names unless they are SI. Numbers
    /// that are not finite become `null`.
    ///
    /// # Errors
    /// Never with these types; serde's signature has an error.
    pub fn to_json(&self) -> serde_json::Result<String> {
        if self.units.is_si() {
            serde_json::to_string_pretty(self)
        } else {
            serde_json::to_string_pretty(&self.to_value()?)
        }
    }

    /// Converts the report to a JSON value, in the units of the report.
    ///
    /// # Errors
    /// Never, unless a number has no representation in JSON.
    pub fn to_value(&self) -> serde_json::Result<serde_json::Value> {
        let mut report = serde_json::to_value(self)?;
        if self.units.is_si() {
            return Ok(report);
        }
        quantities::in_units(&mut report, &self.units);
        if let Some(keys) = report.as_object_mut() {
            keys.insert("units".to_string(), serde_json::to_value(UnitNames::of(&self.units))?);
        }
        Ok(report)
    }
}
