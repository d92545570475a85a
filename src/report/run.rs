//! The report of a whole run, as `--json` prints it.

use serde::Serialize;

use super::resultant::{ComponentSums, ForceRecord, Resultant};
use super::unknowns::{LeftOut, Unknowns};
use super::validity::LargestDisplacement;
use super::warnings::Warning;
use crate::auto::Choice;
use crate::contact::{Law, RangeLeft};
use crate::history::{HistoryOutcome, IncrementRecord, Status};
use crate::model::Model;
use crate::scene::{LinearBackend, MethodName, Scene, Setting};
use crate::uniqueness::CriticalFriction;

/// Everything about a run but the fields; SI units throughout.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunReport {
    /// The scene file.
    pub scene: String,
    /// The scene's title.
    pub title: String,
    /// The algorithm.
    pub method: MethodName,
    /// Its named setting.
    pub setting: Setting,
    /// The linear algebra.
    pub solver: LinearBackend,
    /// Why that, where it was left open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver_choice: Option<String>,
    /// The verdict.
    pub status: Status,
    /// Why the run ended early.
    #[serde(flatten)]
    pub explanation: Explanation,
    /// What may make the answer wrong although the laws hold.
    pub warnings: Vec<Warning>,
    /// The largest displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_displacement: Option<LargestDisplacement>,
    /// The node and time where the contact was furthest out of the range of its linearised gaps, if it left it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_left: Option<RangeLeft>,
    /// How many unknowns of each kind there were.
    pub unknowns: Unknowns,
    /// How many there were not, and why.
    pub left_out: Vec<LeftOut>,
    /// One record per increment.
    pub increments: Vec<IncrementRecord>,
    /// Sums over the run.
    pub totals: Totals,
    /// The components of all contact forces at the end of the last converged increment, added up.
    #[serde(rename = "final")]
    pub end: ComponentSums,
    /// The resultant of each boundary with contact then.
    pub boundaries: Vec<Resultant>,
    /// The resultants at the end of each increment.
    pub forces: Vec<ForceRecord>,
    /// The critical friction at the end of the last converged increment, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_friction: Option<CriticalFriction>,
}

/// Why a run ended early.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explanation {
    /// In words; empty if it did not.
    pub reason: String,
    /// Where the increment that failed violates the law most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst: Option<WorstNode>,
}

/// A node where a law is violated.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstNode {
    /// The law.
    pub law: Law,
    /// The error, relative as everywhere.
    pub error: f64,
    /// Its number in the mesh, from 0.
    pub node: usize,
    /// Its position, m: as many coordinates as there are dimensions.
    pub position: Vec<f64>,
}

/// Sums over a run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Totals {
    /// Linear systems solved by the method.
    pub iterations: usize,
    /// Numerical factorisations, that of the held body included.
    pub factorizations: usize,
    /// Symbolic analyses.
    pub symbolic_analyses: usize,
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time for mesh, assembly, patterns and symbolic analysis, s.
    pub setup_seconds: f64,
    /// Peak resident memory of the process, bytes.
    pub peak_rss_bytes: Option<u64>,
    /// Entries of the factors L and U; with faer a bound of them.
    pub nnz_factors: usize,
    /// The largest componentwise backward error of any solve.
    pub backward_error: f64,
}

/// What the caller measured around a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// CPU time of the process, s.
    pub cpu_seconds: f64,
    /// Wall time since the scene was read, s.
    pub wall_seconds: f64,
    /// Wall time of mesh and assembly, s.
    pub model_seconds: f64,
    /// Peak resident memory, bytes.
    pub peak_rss_bytes: Option<u64>,
}

impl RunReport {
    /// The report of a run of `scene`, read from the file `name` and discretised as `model`.
    pub fn new(
        name: &str,
        scene: &Scene,
        model: &Model,
        choice: &Choice,
        outcome: &HistoryOutcome,
        explanation: Explanation,
        measured: Measured,
    ) -> Self {
        RunReport {
            scene: name.to_string(),
            title: scene.title.clone(),
            method: scene.solver.method.name(),
            setting: scene.solver.method.setting(),
            solver: choice.backend,
            solver_choice: choice.reason(),
            status: outcome.status,
            explanation,
            warnings: Warning::of_model(model),
            largest_displacement: None,
            range_left: None,
            unknowns: Unknowns::new(&outcome.layout, scene.solver.method.name()),
            left_out: LeftOut::all(model, choice.backend),
            increments: outcome.records.clone(),
            totals: Totals {
                iterations: outcome.records.iter().map(|record| record.iterations).sum(),
                factorizations: outcome.linear.factorizations,
                symbolic_analyses: outcome.linear.analyses,
                cpu_seconds: measured.cpu_seconds,
                wall_seconds: measured.wall_seconds,
                setup_seconds: measured.model_seconds + outcome.setup_seconds,
                peak_rss_bytes: measured.peak_rss_bytes,
                nnz_factors: outcome.linear.factor.entries,
                backward_error: outcome.linear.worst_backward_error,
            },
            end: ComponentSums::of(model, &outcome.state, 0..model.contacts.len()),
            boundaries: Resultant::all(model, &outcome.state),
            forces: Vec::new(),
            critical_friction: None,
        }
    }

    /// As one JSON object. Numbers that are not finite become `null`.
    ///
    /// # Errors
    /// None that the types allow; serde's signature has one.
    pub fn to_json(&self) -> serde_json::Result<String> {
        serde_json::to_string_pretty(self)
    }
}
