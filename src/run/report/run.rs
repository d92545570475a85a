//! The report of a whole run, as `--json` prints it.

use serde::Serialize;

use super::balance::{BalanceRecord, BalanceWatch};
use super::companion::ChosenIncrements;
use super::estimates::Estimates;
use super::exact_path::{self, ExactPath};
use super::explain::Explanation;
use super::history_curves::HistoryCurves;
use super::increment_warnings;
use super::leap::Leap;
use super::pairs::PairRecord;
use super::peak::LargestPressure;
use super::quantities;
use super::resultant::{ComponentSums, ForceRecord, Resultant};
use super::unit_names::UnitNames;
use super::unknowns::{LeftOut, Unknowns};
use super::usage::RankRecord;
use super::validity::{LargestDisplacement, Validity};
use super::warnings::{Warning, WarningKind};
use crate::algebra::linear::blas::Blas;
use crate::base::units::UnitSystem;
use crate::body::contact::RangeLeft;
use crate::body::model::Model;
use crate::run::auto::{Choice, Faster};
use crate::scene::Scene;
use crate::solver::history::{HistoryOutcome, IncrementRecord, LinearAlgebra, SolverChoice, Status, WorkingSet};
use crate::solver::laws::KktErrors;
use crate::solver::uniqueness::CriticalFriction;

/// The version of the keys of a report. A key that is new does not change it; one that goes or means something else does.
pub const SCHEMA_VERSION: u32 = 1;

/// Everything about a run but the fields. All numbers are SI, and serde writes them as they are;
/// [`RunReport::to_json`] tells them in the units of the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunReport {
    /// The version of these keys, 1.
    pub schema_version: u32,
    /// The version of stickslip.
    pub program_version: &'static str,
    /// The scene file; none if the model was made without one.
    pub scene: Option<String>,
    /// The text of the scene that ran, overrides included.
    pub scene_text: Option<String>,
    /// The scene's title; empty without a scene.
    pub title: String,
    /// The units in which the report is told.
    #[serde(skip)]
    pub units: UnitSystem,
    /// The algorithm.
    pub method: &'static str,
    /// Its named setting.
    pub setting: &'static str,
    /// The linear algebra: `umfpack`, `faer` or `condensed`, or the name of a solver from outside.
    pub solver: String,
    /// The reason for the linear algebra, where the scene leaves it open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_choice: Option<String>,
    /// A linear algebra that is estimated to take much less time, if the run was long enough to ask.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faster_solver: Option<Faster>,
    /// The BLAS behind the factorisations, in a build that has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub blas: Option<Blas>,
    /// The verdict.
    pub status: Status,
    /// Why the run ended early.
    #[serde(flatten)]
    pub explanation: Explanation,
    /// The bodies, where there are several, in the order of the field `body`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bodies: Vec<BodyRecord>,
    /// What may make the answer wrong although the laws hold.
    pub warnings: Vec<Warning>,
    /// The largest displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacement: Option<LargestDisplacement>,
    /// The largest contact pressure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_pressure: Option<LargestPressure>,
    /// The node and time where the contact was furthest out of the range of its linearised gaps, if it left it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_left: Option<RangeLeft>,
    /// What the mesh leaves open.
    pub estimates: Estimates,
    /// The number of unknowns of each kind.
    pub unknowns: Unknowns,
    /// The unknowns that the scene does without, and why.
    pub left_out: Vec<LeftOut>,
    /// The contact nodes that condensed equations held, if those were not all at first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub working_set: Option<WorkingSet>,
    /// How many increments a first run asked for, where nobody said it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen_increments: Option<ChosenIncrements>,
    /// Where increments end besides the equal ones, s: kinks of histories at which none of these ends.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub kinks: Vec<f64>,
    /// One record per increment; none where they go elsewhere as they are made, see [`Run::solve_to`](crate::run::Run::solve_to).
    pub increments: Vec<IncrementRecord>,
    /// What became of the exact path, where that was followed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact_path: Option<ExactPath>,
    /// Sums over the run.
    pub totals: Totals,
    /// The components of all contact forces at the end of the last converged increment, added up.
    #[serde(rename = "final")]
    pub end: ComponentSums,
    /// The boundaries in front of each other, at the end of the last converged increment.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pairs: Vec<PairRecord>,
    /// The resultant of each boundary with contact then.
    pub boundaries: Vec<Resultant>,
    /// The resultants at the end of each increment.
    pub forces: Vec<ForceRecord>,
    /// What else acts on the body at the end of each increment: loads, reactions of supports, springs; and the balance.
    pub reactions: Vec<BalanceRecord>,
    /// The critical friction at the end of the last converged increment, where it was asked for, or where an exact path is lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_friction: Option<CriticalFriction>,
    /// What else acts on the body at the end of the last converged increment.
    #[serde(skip)]
    pub last_reactions: Option<BalanceRecord>,
    /// The curves of the charts of a history.
    #[serde(skip)]
    pub curves: HistoryCurves,
}

/// A body of several.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BodyRecord {
    /// Its name.
    pub name: String,
    /// The number of its nodes.
    pub nodes: usize,
    /// The number of its cells.
    pub cells: usize,
}

impl BodyRecord {
    /// The bodies of `model`; none where there is only one.
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
pub struct Totals {
    /// Increments that converged.
    pub converged: usize,
    /// The largest error of each law in any increment.
    pub kkt: KktErrors,
    /// Linear systems solved by the method.
    pub iterations: usize,
    /// Numerical factorisations, that of the held body included.
    pub factorizations: usize,
    /// Symbolic analyses.
    pub symbolic_analyses: usize,
    /// Iterations within the linear solves, where multigrid does them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub krylov_iterations: Option<usize>,
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time for mesh, assembly, patterns and symbolic analysis, s.
    pub setup_seconds: f64,
    /// The threads that shared the work.
    pub threads: usize,
    /// Peak resident memory of the process, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// What each process took, this one among them, where MPI has started several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub ranks: Vec<RankRecord>,
    /// Entries of the factors L and U; with faer a bound of them.
    pub nnz_factors: usize,
    /// The largest componentwise backward error of any solve.
    pub backward_error: f64,
}

/// What was measured around a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time of mesh and assembly, s.
    pub model_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// What each of several processes took.
    pub ranks: Vec<RankRecord>,
}

/// All that a report is made from.
pub struct Facts<'a> {
    /// The scene, if the model came from one.
    pub scene: Option<&'a Scene>,
    /// What was solved.
    pub model: &'a Model,
    /// How.
    pub solver: &'a SolverChoice,
    /// The name of the linear algebra that solved it.
    pub linear: String,
    /// Whether it condensed the body.
    pub condensed: bool,
    /// The contact nodes that the condensed equations held at first, if not all.
    pub working_set: Option<&'a [usize]>,
    /// Why that was chosen.
    pub choice: &'a Choice,
    /// Why multigrid gave way, if it did and that is known.
    pub unsuited: Option<String>,
    /// What came of it.
    pub outcome: &'a HistoryOutcome,
    /// Whether the solution stays where its equations hold.
    pub validity: &'a Validity,
    /// The largest contact pressure, if anything was pressed.
    pub largest_pressure: Option<LargestPressure>,
    /// What the mesh leaves open.
    pub estimates: Estimates,
    /// The records of the increments, if they are to be in the report.
    pub increments: Vec<IncrementRecord>,
    /// The resultants at the end of each.
    pub forces: Vec<ForceRecord>,
    /// What else acts on the body then.
    pub reactions: Vec<BalanceRecord>,
    /// The same at the end of the last one that converged.
    pub last_reactions: Option<BalanceRecord>,
    /// Where contact forces jump, if they do.
    pub leap: Option<Leap>,
    /// The error of the friction forces by loads or interference at t = 0, as a share of the largest possible friction.
    pub start: Option<f64>,
    /// What is left of the balance.
    pub balance: BalanceWatch,
    /// The history as it is drawn.
    pub curves: HistoryCurves,
    /// The critical friction at the end, where it was asked for.
    pub critical_friction: Option<CriticalFriction>,
    /// Results that were asked for beside the history and could not be computed.
    pub missing: Vec<Warning>,
    /// What would have been much faster.
    pub faster: Option<Faster>,
    /// Time and memory.
    pub measured: Measured,
}

impl RunReport {
    /// The whole report.
    pub fn new(facts: Facts<'_>) -> Self {
        let Facts { scene, model, solver, choice, outcome, validity, measured, .. } = facts;
        let mut warnings = Warning::of_model(model);
        // What elements have done takes the place of what was expected of them.
        warnings.retain(|warning| warning.kind != WarningKind::Locking || facts.estimates.locking.is_none());
        warnings.extend(validity.warnings(model));
        warnings.extend(facts.estimates.warnings(model, validity));
        let companion = facts.estimates.companion;
        let known = increment_warnings::Known {
            found: facts.estimates.increments.as_ref(),
            companion: companion.and_then(|companion| Some((companion.error?, companion.increments))),
            start: facts.start,
            increments: outcome.tally.increments,
        };
        // Their estimates are of gaps that change in proportion within an increment.
        if validity.passage().is_none() {
            warnings.extend(increment_warnings::warnings(&known, &model.units()));
        }
        warnings.extend(exact_path::curved_gaps(solver.method, model, outcome));
        warnings.extend(exact_path::jumps(&outcome.jumps));
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
            bodies: BodyRecord::all(model),
            warnings,
            largest_displacement: validity.largest,
            largest_pressure: facts.largest_pressure,
            range_left: validity.range_left,
            estimates: facts.estimates,
            unknowns: Unknowns::new(&outcome.layout, solver.method),
            left_out: LeftOut::all(model, facts.condensed, facts.working_set),
            working_set: outcome.working_set,
            chosen_increments: None,
            kinks: scene.map(|scene| scene.time.kinks.clone()).unwrap_or_default(),
            increments: facts.increments,
            exact_path: ExactPath::of(solver.method, outcome),
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

    /// The report as one JSON object, told in its [`RunReport::units`], which it names unless they are SI. Numbers that are not
    /// finite become `null`.
    ///
    /// # Errors
    /// None that the types allow; serde's signature has one.
    pub fn to_json(&self) -> serde_json::Result<String> {
        if self.units.is_si() {
            serde_json::to_string_pretty(self)
        } else {
            serde_json::to_string_pretty(&self.to_value()?)
        }
    }

    /// The report as a JSON value, in the units of the report.
    ///
    /// # Errors
    /// Never, unless a number has no place in JSON.
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
