//! The report of a whole run, as `--json` prints it.

use serde::Serialize;

use super::balance::{BalanceRecord, BalanceWatch};
use super::companion::ChosenIncrements;
use super::cycle::CycleReport;
use super::estimates::Estimates;
use super::exact_path::{self, ExactPath};
use super::explain::Explanation;
use super::force_jump::ForceJump;
use super::history_curves::HistoryCurves;
use super::increment_warnings;
use super::key_results::{FrictionResult, HoldingForce, KeyWatch, LargestForce};
use super::pairs::PairRecord;
use super::peak::LargestPressure;
use super::quantities;
use super::resultant::{ComponentSums, ForceRecord, Resultant};
use super::unit_names::UnitNames;
use super::unknowns::{EliminatedUnknown, Unknowns};
use super::usage::RankRecord;
use super::validity::{LargestDisplacement, Validity};
use super::warnings::{Warning, WarningKind};
use crate::algebra::linear::process::blas::Blas;
use crate::base::units::UnitSystem;
use crate::body::contact::RangeLeft;
use crate::body::estimate::StickZone;
use crate::body::model::Model;
use crate::run::auto::{Choice, Faster};
use crate::scene::Scene;
use crate::solver::history::{HistoryOutcome, IncrementRecord, LinearAlgebra, SolverChoice, Status, WorkingSet};
use crate::solver::laws::KktErrors;
use crate::solver::uniqueness::CriticalFriction;

/// The version of the keys of a report. New keys do not change it; removed keys or changed meanings do.
pub const SCHEMA_VERSION: u32 = 1;

/// All results of a run except the fields. All numbers are SI, and serde writes them so; [`RunReport::to_json`]
/// converts them to the units of the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// A linear solver estimated to take much less time, if the run was long enough for an estimate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faster_solver: Option<Faster>,
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
    /// The friction work, if anything slipped.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub friction: Option<FrictionResult>,
    /// The stick zone, if some nodes stick and others slip, when the tangential forces were largest.
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
    /// The number of increments chosen by a first run, if it was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen_increments: Option<ChosenIncrements>,
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

/// One of several bodies.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    fn all(model: &Model) -> Vec<Self> {
        let bodies = model.mesh.bodies();
        let record = |(k, name): (usize, &String)| BodyRecord {
            name: name.clone(),
            nodes: bodies.nodes(k).count(),
            cells: bodies.cells(k).count(),
        };
        if bodies.are_several() { bodies.names().iter().enumerate().map(record).collect() } else { Vec::new() }
    }
}

/// Sums over a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// The time and memory measured for a run.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time of mesh and assembly, s.
    pub model_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// The time and memory of each of several processes.
    pub ranks: Vec<RankRecord>,
}

/// The data from which a report is made.
#[non_exhaustive]
pub struct ReportInput<'a> {
    /// The scene, if the model came from one.
    pub scene: Option<&'a Scene>,
    /// The model.
    pub model: &'a Model,
    /// The solver.
    pub solver: &'a SolverChoice,
    /// The name of the linear solver that was used.
    pub linear: String,
    /// `true` if the body was condensed.
    pub condensed: bool,
    /// The initial working set of condensed equations; `None` if it contains all contact nodes.
    pub working_set: Option<&'a [usize]>,
    /// The reason for the choice of the linear solver.
    pub choice: &'a Choice,
    /// The reason why multigrid fell back to another solver, if it did and the reason is known.
    pub unsuited: Option<String>,
    /// The outcome of the history.
    pub outcome: &'a HistoryOutcome,
    /// The checks of the assumptions of the equations.
    pub validity: &'a Validity,
    /// The largest contact pressure, if there was any.
    pub largest_pressure: Option<LargestPressure>,
    /// The largest force and the friction work.
    pub key: KeyWatch,
    /// The load cycle that was asked for.
    pub cycle: Option<CycleReport>,
    /// The error estimates.
    pub estimates: Estimates,
    /// The records of the increments, if they belong into the report.
    pub increments: Vec<IncrementRecord>,
    /// The resultants at the end of each increment.
    pub forces: Vec<ForceRecord>,
    /// The other forces on the body at the end of each increment.
    pub reactions: Vec<BalanceRecord>,
    /// The other forces on the body at the end of the last converged increment.
    pub last_reactions: Option<BalanceRecord>,
    /// The first jump of contact forces, if any.
    pub leap: Option<ForceJump>,
    /// The largest imbalance of forces.
    pub balance: BalanceWatch,
    /// The curves for the charts of the history.
    pub curves: HistoryCurves,
    /// The critical friction at the end, if it was requested.
    pub critical_friction: Option<CriticalFriction>,
    /// Warnings of requested additional results that could not be computed.
    pub missing: Vec<Warning>,
    /// A linear solver that would have been much faster.
    pub faster: Option<Faster>,
    /// Time and memory.
    pub measured: Measured,
}

impl RunReport {
    /// Creates the whole report.
    pub fn new(facts: ReportInput<'_>) -> Self {
        let ReportInput { scene, model, solver, choice, outcome, validity, measured, .. } = facts;
        let mut warnings = Warning::of_model(model);
        // The locking found in the solution replaces the expected one.
        warnings.retain(|warning| warning.kind != WarningKind::Locking || facts.estimates.locking.is_none());
        warnings.extend(validity.warnings(model));
        warnings.extend(facts.estimates.warnings(model, validity));
        let companion = facts.estimates.companion;
        let known = increment_warnings::Known {
            found: facts.estimates.increments.as_ref(),
            companion: companion.and_then(|companion| Some((companion.error?, companion.increments))),
            start: facts.estimates.start,
            is_loaded: model.loading.is_present_at_start(model.problem.displacements()),
            negligible_work: facts.estimates.negligible_work,
            increments: outcome.tally.increments,
        };
        warnings.extend(increment_warnings::warnings(&known, &model.units()));
        if solver.method.is_exact_path() {
            warnings.extend(exact_path::curved_gaps(model, outcome));
            warnings.extend(exact_path::jumps(&outcome.jumps));
        }
        warnings.extend(facts.leap.map(|leap| leap.warning()));
        warnings.extend(facts.balance.unbalanced(model, solver.tolerance));
        warnings.extend(facts.missing);
        let blas = Blas::loaded();
        warnings.extend(blas.as_ref().and_then(Warning::of_blas));
        warnings.extend(Warning::of_multigrid(
            &outcome.linear,
            choice.linear == LinearAlgebra::Multigrid,
            &facts.linear,
            facts.unsuited.as_deref(),
        ));
        warnings.extend(Warning::of_ranks(model, choice.linear, measured.ranks.len()));
        RunReport {
            schema_version: SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION"),
            scene: scene.map(|scene| scene.file().to_string()),
            scene_text: scene.map(|scene| scene.text().to_string()),
            title: scene.map_or(String::new(), |scene| scene.title.clone()),
            units: model.units(),
            method: solver.method.name(),
            setting: solver.method.setting(),
            solver: facts.linear,
            solver_choice: choice.reason(),
            faster_solver: facts.faster,
            blas,
            status: outcome.status,
            explanation: Explanation::new(solver, model, outcome),
            largest_pressure: facts.largest_pressure,
            largest_force: facts.key.largest_force(),
            holding_force: facts.key.holding_force(&facts.estimates),
            friction: facts.key.friction(&facts.estimates),
            stick_zone: facts.estimates.stick_zone().cloned(),
            cycle: facts.cycle,
            bodies: BodyRecord::all(model),
            warnings,
            largest_displacement: validity.largest,
            range_left: validity.range_left,
            estimates: facts.estimates,
            unknowns: Unknowns::new(&outcome.layout, solver.method.increments()),
            left_out: EliminatedUnknown::all(model, facts.condensed, facts.working_set),
            working_set: outcome.working_set,
            chosen_increments: None,
            kinks: scene.map(|scene| scene.time.kinks.clone()).unwrap_or_default(),
            increments: facts.increments,
            exact_path: solver.method.is_exact_path().then(|| ExactPath::of(outcome)),
            totals: Totals {
                converged: outcome.tally.converged,
                kkt: outcome.tally.kkt,
                iterations: outcome.tally.iterations,
                factorizations: outcome.linear.factorizations,
                symbolic_analyses: outcome.linear.analyses,
                krylov_iterations: Some(outcome.linear.krylov_iterations).filter(|iterations| *iterations > 0),
                cpu_seconds: measured.cpu_seconds,
                wall_seconds: measured.wall_seconds,
                setup_seconds: measured.model_seconds + outcome.setup_seconds,
                threads: rayon::current_num_threads(),
                peak_rss_bytes: measured.peak_rss_bytes,
                ranks: measured.ranks,
                nnz_factors: outcome.linear.factor.entries,
                backward_error: outcome.linear.worst_backward_error,
            },
            end: ComponentSums::of(model, &outcome.state, (0..model.contacts.len()).map(|i| (i, 1.0))),
            pairs: PairRecord::all_at(model, outcome.reached, &outcome.state),
            boundaries: Resultant::all(model, outcome.reached, &outcome.state),
            forces: facts.forces,
            reactions: facts.reactions,
            critical_friction: facts.critical_friction,
            last_reactions: facts.last_reactions,
            curves: facts.curves,
        }
    }

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
        quantities::tell(&mut report, &self.units);
        if let Some(keys) = report.as_object_mut() {
            keys.insert("units".to_string(), serde_json::to_value(UnitNames::of(&self.units))?);
        }
        Ok(report)
    }
}
