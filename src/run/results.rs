//! The results of a run: its history, additional solutions that judge it, and the report.

use std::time::Instant;

use super::applicable::fell_back;
use super::checks::Solved;
use super::force_jumps::{ForceJump, JumpDetector};
use super::watch::{ReportCollector, Watches};
use super::{RecordedIncrement, Run, RunError, Sink};
use crate::algebra::linear::process::blas::Blas;
use crate::algebra::linear::{Computed, RefinedSolver};
use crate::body::estimate::error_of_force;
use crate::body::model::Model;
use crate::run::report::{
    BodyRecord, ComponentSums, CycleWatch, EliminatedUnknown, EstimateWatch, Estimates, ExactPath, Explanation, Moment,
    PairRecord, Resultant, RunReport, SCHEMA_VERSION, Totals, Unknowns, Warning,
};
use crate::solver::history::{self, HistoryOutcome, HistorySettings, Observer, Status, SystemSolver};
use crate::solver::influence::influence;
use crate::solver::laws::KktScales;
use crate::solver::uniqueness::{self, CriticalFriction};

/// Returns an additional result; if it could not be computed, adds a warning to `missing`.
fn or_missing<T, E: std::error::Error>(
    missing: &mut Vec<Warning>,
    result: &str,
    computed: Result<Option<T>, E>,
) -> Option<T> {
    computed.unwrap_or_else(|error| {
        missing.push(Warning::of_missing(result, &error));
        None
    })
}

/// The reason why there are no results of a load cycle.
#[derive(Debug, thiserror::Error)]
#[error(
    "at no earlier increment did all loads have the values of the end, and change in the same direction; give the times \
     of the cycle, output.cycle = [1.0, 2.0]"
)]
struct NoCycle;

/// The results of additional solutions.
struct Additional {
    estimates: Estimates,
    /// The first jump of contact forces.
    jump: Option<ForceJump>,
    critical_friction: Option<CriticalFriction>,
    /// Warnings of results that could not be computed.
    missing: Vec<Warning>,
}

impl Run<'_> {
    pub(super) fn report(&self, system: SystemSolver, mut sink: Sink<'_>) -> Result<RunReport, RunError> {
        let start = Instant::now();
        let (linear, condensed) = (system.name(), system.condenses());
        let is_path = self.solver.method.is_exact_path();
        let cycle = self.cycle.as_ref().and_then(|cycle| CycleWatch::new(&self.model, &self.times, cycle, is_path));
        let watches = Watches::new(&self.model, cycle, JumpDetector::new(&self.model, self.solver.method));
        let (model, keeps_last, sink) = (&*self.model, self.uniqueness, &mut sink);
        let mut collector = ReportCollector { model, sink, watches, keeps_last };
        if let Some(checkpoint) = &self.from {
            collector.continue_from(checkpoint).map_err(history::Error::from)?;
        }
        let settings = HistorySettings {
            keeps_records: false,
            estimates_error: true,
            from: self.from.clone(),
            ..self.settings()?
        };
        let outcome = self.history_with(system, &self.times, &settings, &mut collector)?;
        let ReportCollector { sink, mut watches, .. } = collector;
        let more = self.additional(&settings, &outcome, &mut watches, sink.observer());
        let totals = Totals::new(&outcome, self.model_seconds, start);
        Ok(self.summary((linear, condensed), &outcome, watches, more, totals))
    }

    /// Solves for additional results. The history is solved, and a failure loses one result only.
    fn additional(
        &self,
        settings: &HistorySettings,
        outcome: &HistoryOutcome,
        watches: &mut Watches,
        observer: &mut dyn Observer,
    ) -> Additional {
        let mut missing = Vec::new();
        let found = watches.estimates.estimates(&self.model);
        let mut estimates = Estimates { increments: outcome.increment_error, ..found };
        // A run that was stopped solves nothing more.
        let (converged, goes_on) = (outcome.status == Status::Converged, outcome.status != Status::Interrupted);
        if self.cycle.is_some() && watches.cycle.is_none() {
            missing.push(Warning::of_missing("the load cycle", &NoCycle));
        }
        let of_mesh = watches.key.moments().map(|moment| {
            let error =
                moment.filter(|_| goes_on).map_or(Ok(None), |moment| self.force_error(moment, &watches.estimates));
            or_missing(&mut missing, "the error of a contact force by the mesh", error)
        });
        estimates.tangential = watches.key.learn(&self.model, of_mesh);
        let jumps = Some(&watches.jumps).filter(|_| goes_on);
        let jump = jumps.map_or(Ok(None), |jumps| self.force_jump(jumps, settings, &outcome.scales, observer));
        let jump = or_missing(&mut missing, "the check for jumps of contact forces", jump);
        if converged {
            let by_start = self.friction_by_start(watches.jumps.largest(), observer);
            estimates.start = or_missing(&mut missing, "the error of friction by the first increment", by_start);
        }
        let critical = watches.last.as_ref().filter(|_| goes_on).map_or(Ok(None), |last| self.critical_friction(last));
        let critical_friction = or_missing(&mut missing, "the critical friction", critical);
        Additional { estimates, jump, critical_friction, missing }
    }

    /// Returns the report of a history solved by the linear solver of the name `linear`, whose equations may be `condensed`.
    fn summary(
        &self,
        (linear, condensed): (String, bool),
        outcome: &HistoryOutcome,
        watches: Watches,
        more: Additional,
        totals: Totals,
    ) -> RunReport {
        let (scene, model, method) = (self.scene, &*self.model, self.solver.method);
        let (checks, key, estimates) = (&watches.checks, &watches.key, &more.estimates);
        let (balance, jump) = (&watches.balance, more.jump);
        let solved = Solved { model, solver: &self.solver, outcome, checks, balance, estimates, jump };
        let mut warnings = solved.warnings();
        warnings.extend(more.missing);
        let blas = Blas::loaded();
        warnings.extend(blas.as_ref().and_then(Warning::of_blas));
        let unsuited = fell_back(&outcome.linear, model, method);
        let asked = self.choice.linear.iterates();
        warnings.extend(Warning::of_multigrid(&outcome.linear, asked, &linear, unsuited.as_deref()));
        // Rank 0 alone refines a mesh.
        if self.coarser_meshes().is_empty() {
            warnings.extend(Warning::of_ranks(model, self.choice.linear, totals.ranks.len()));
        }
        RunReport {
            schema_version: SCHEMA_VERSION,
            program_version: env!("CARGO_PKG_VERSION"),
            scene: scene.map(|scene| scene.file().to_string()),
            scene_text: scene.map(|scene| scene.text().to_string()),
            title: scene.map_or(String::new(), |scene| scene.title.clone()),
            units: model.units(),
            method: method.name(),
            setting: method.setting(),
            solver_choice: self.choice.reason.clone(),
            solver: linear,
            blas,
            status: outcome.status,
            explanation: Explanation::new(&self.solver, model, outcome),
            largest_pressure: watches.estimates.largest_pressure(model, estimates),
            largest_force: key.largest_force(),
            holding_force: key.holding_force(estimates),
            friction_use: key.friction_use(model),
            pretension_forces: watches.pretensions,
            friction: key.friction(estimates),
            stick_zone: estimates.stick_zone().cloned(),
            cycle: watches.cycle.as_ref().and_then(|cycle| cycle.report(model)),
            bodies: BodyRecord::all(model),
            warnings,
            largest_displacement: checks.largest_displacement(),
            range_left: checks.range_left(),
            estimates: more.estimates,
            unknowns: Unknowns::new(&outcome.layout, method.increments()),
            left_out: EliminatedUnknown::all(model, condensed, self.working_set().filter(|_| condensed)),
            working_set: outcome.working_set,
            coarser_meshes: self.coarser_meshes.clone(),
            kinks: scene.map(|scene| scene.time.kinks.clone()).unwrap_or_default(),
            increments: watches.increments,
            exact_path: method.is_exact_path().then(|| ExactPath::of(outcome)),
            totals,
            end: ComponentSums::of(model, &outcome.state, (0..model.contact.nodes.len()).map(|i| (i, 1.0))),
            pairs: PairRecord::all_at(model, outcome.reached, &outcome.state),
            boundaries: Resultant::all(model, outcome.reached, &outcome.state),
            forces: watches.forces,
            reactions: watches.reactions,
            critical_friction: more.critical_friction,
            last_reactions: watches.last_reactions,
            curves: watches.curves,
        }
    }

    /// Returns the error of a force by the mesh at the `moment` of its largest value, N; `None` if it is unknown, as in
    /// contact zones of a few nodes, whose width depends on the mesh, or with a stiffness that several processes share.
    fn force_error(&self, moment: &Moment, watch: &EstimateWatch) -> Computed<Option<f64>> {
        let Model { problem, .. } = &*self.model;
        if problem.stiffness().distributed().is_some() {
            return Ok(None);
        }
        let Some(nodes) = moment.weights(&self.model) else { return Ok(None) };
        let z = influence(problem, self.model.scaling(), &nodes, self.system())?;
        let error = z.and_then(|z| error_of_force(&self.model, moment.time, &moment.state.u, &z));
        Ok(error.filter(|error| *error == 0.0 || !watch.is_narrow(&self.model, &moment.state)))
    }

    /// Finds the first increment in which contact forces jump.
    fn force_jump(
        &self,
        jumps: &JumpDetector,
        settings: &HistorySettings,
        scales: &KktScales,
        observer: &mut dyn Observer,
    ) -> Result<Option<ForceJump>, RunError> {
        if !jumps.are_suspected() {
            return Ok(None);
        }
        Ok(jumps.first(&self.model, settings, scales, &mut self.system(), observer)?)
    }

    fn critical_friction(&self, last: &RecordedIncrement) -> Result<Option<CriticalFriction>, history::Error> {
        let scaling = self.model.scaling();
        let (data, state) = (last.data(), &last.state);
        // The exact path has no friction at nodes in two contacts.
        let problem = &self.model.problem.with_friction(data.mu.to_vec())?;
        uniqueness::critical_friction(problem, &data, state, scaling, &mut RefinedSolver::default())
    }
}
