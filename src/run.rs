//! Solves a scene, or a model, over its history and reports on it. Prints nothing and writes no files.
//!
//! ```
//! use stickslip::solver::history::{Method, SolverChoice};
//! use stickslip::body::Model;
//! use stickslip::run::{Recording, Run};
//! use stickslip::scene::Scene;
//!
//! let scene = Scene::parse("block.toml", include_str!("../data/scenes/block.toml"), &["mesh.elements=[10,10]".parse()?])?;
//! let report = Run::new(&scene)?.solve(&mut ())?;
//! assert_eq!(report.status.to_string(), "converged");
//!
//! // Arrays of selected increments, here of all, are kept by an observer.
//! let mut recording = Recording::all();
//! Run::new(&scene)?.solve(&mut recording)?;
//! assert_eq!(recording.increments.len(), report.increments.len());
//!
//! // A model made in Rust is solved in the same way.
//! let model = Model::build(&scene.description)?;
//! let again = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::PaperBn))?.solve(&mut ())?;
//! assert_eq!(again.forces, report.forces);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod applicable;
pub(crate) mod auto;
mod companion;
mod discretise;
mod error;
mod force_jumps;
#[cfg(feature = "petsc")]
mod grid;
mod increments;
mod lock;
mod need;
mod recording;
pub mod report;
mod sharing;
mod start;
mod watch;

use std::borrow::Cow;
use std::time::Instant;

pub use applicable::{Unsuited, unsuited};
use discretise::{as_chosen, for_run};
pub use discretise::{discretise, expect_exact_path, tightening};
pub use error::RunError;
#[cfg(feature = "petsc")]
pub use grid::grid;
pub use increments::increments_for;
pub use need::MemoryEstimate;
pub use recording::{RecordedIncrement, Recording};

use crate::algebra::linear::{LinearError, RefinedSolver};
use crate::base::memory::Budget;
use crate::body::description::CycleRequest;
use crate::body::estimate::error_of_force;
use crate::body::model::Model;
use crate::run::report::{
    CompanionEstimate, CycleWatch, EstimateWatch, Estimates, ForceJump, Measured, Moment, RankRecord, ReportInput,
    RunReport, Warning, cpu_seconds, peak_rss_bytes,
};
use crate::scene::Scene;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::formulation::Layout;
use crate::solver::history::{
    self, HistoryOutcome, HistorySettings, IncrementRecord, JumpSolver, LinearAlgebra, Observer, SolverChoice, Status,
    SystemSolver,
};
use crate::solver::influence::influence;
use crate::solver::initial_working_set::{self, InitialWorkingSet};
use crate::solver::laws::{ContactStatus, KktScales};
use crate::solver::problem::State;
use crate::solver::uniqueness::{self, CriticalFriction};
use applicable::{fell_back, means};
use auto::factorizations;
pub use auto::{AvailableSolvers, Choice, Done, Faster, SolverEstimate};
use companion::{Companion, Quiet};
use force_jumps::JumpDetector;
use watch::ReportCollector;
pub use watch::{RecordWriter, Sink};

/// The number of factorisations from which on a better ordering is worth its time.
const MANY: f64 = 10.0;

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

/// A model with its increments and its solver. A run may be solved several times.
#[derive(Debug)]
pub struct Run<'a> {
    scene: Option<&'a Scene>,
    model: Cow<'a, Model>,
    /// The ends of the increments, s.
    times: Vec<f64>,
    solver: SolverChoice,
    choice: Choice,
    /// The memory that the model leaves free.
    budget: Option<Budget>,
    /// The initial working set of condensed equations.
    reach: InitialWorkingSet,
    uniqueness: bool,
    companion: bool,
    cycle: Option<CycleRequest>,
    /// The checkpoint from which the run resumes; `None` to begin with the unloaded body.
    from: Option<Checkpoint>,
    /// Wall time of mesh, assembly and choice of the linear solver, s.
    model_seconds: f64,
}

impl<'a> Run<'a> {
    /// Prepares the run described by `scene`: mesh, stiffness, contact, loads, and the linear solver, chosen here if
    /// the scene does not name one.
    ///
    /// # Errors
    /// As [`discretise`], and when memory is short for the choice.
    pub fn new(scene: &'a Scene) -> Result<Self, RunError> {
        Run::prepared(scene, |_| ())
    }

    /// Prepares the run described by `scene`. `prepare` sees the model before the first factorisation, e.g. to set the
    /// number of threads.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn prepared(scene: &'a Scene, prepare: impl FnOnce(&Model)) -> Result<Self, RunError> {
        let start = Instant::now();
        let model = Cow::Owned(for_run(scene)?);
        prepare(&model);
        Run::start(Some(scene), model, scene.time.all(), scene.solver, start)
    }

    /// Prepares the run of a `model` made in Rust, over increments that end at `times` (s).
    ///
    /// # Errors
    /// When the times do not increase from 0 or later, and when memory is short for the choice of the linear solver.
    pub fn of(model: &'a Model, times: Vec<f64>, solver: SolverChoice) -> Result<Self, RunError> {
        Run::start(None, Cow::Borrowed(model), times, solver, Instant::now())
    }

    fn start(
        scene: Option<&'a Scene>,
        model: Cow<'a, Model>,
        times: Vec<f64>,
        solver: SolverChoice,
        start: Instant,
    ) -> Result<Self, RunError> {
        history::check_times(&times).map_err(history::Error::from)?;
        if let Some(name) = lock::unlocked(&model) {
            return Err(RunError::Unlocked(name.to_string()));
        }
        let budget = Budget::of_process();
        // If the factors of the body do not fit into memory, the extent of contact is not estimated with them.
        let none = InitialWorkingSet { nodes: Some(Vec::new()), ..InitialWorkingSet::default() };
        let has_room = || MemoryEstimate::check(&model, &none, LinearAlgebra::condensed(), budget).is_ok();
        let may_condense = solver.linear.is_none_or(LinearAlgebra::condenses)
            && !solver.method.increments().is_of_paper()
            && has_room();
        let condensing = match solver.linear {
            Some(LinearAlgebra::Condensed(cholesky)) => Some(cholesky),
            _ => None,
        };
        let reach = if may_condense {
            initial_working_set::working_set(
                &model.problem,
                &model.loading,
                &times,
                initial_working_set::AFFORDABLE,
                condensing,
            )?
        } else {
            InitialWorkingSet::default()
        };
        let choice = if let Some(linear) = solver.linear {
            Choice::named(linear)
        } else {
            let means = means(&model, solver.method, budget);
            Choice::cheapest(&model.problem, &reach, solver.method, times.len(), means)?
        };
        let model = as_chosen(scene, model, solver, choice.linear)?;
        MemoryEstimate::check(&model, &reach, choice.linear, budget)?;
        let model_seconds = start.elapsed().as_secs_f64();
        let cycle = scene.and_then(|scene| scene.output.cycle);
        let (uniqueness, companion, from) = (false, false, None);
        Ok(Run {
            scene,
            model,
            times,
            solver,
            choice,
            budget,
            reach,
            uniqueness,
            companion,
            cycle,
            from,
            model_seconds,
        })
    }

    /// Requests the critical friction at the end.
    ///
    /// # Errors
    /// [`RunError::SlidesInAPlane`] if it cannot be computed.
    pub fn with_uniqueness(self) -> Result<Self, RunError> {
        let layout = Layout::new(&self.model.problem);
        if (0..layout.contacts()).any(|i| layout.slides_in_a_plane(i)) {
            return Err(RunError::SlidesInAPlane);
        }
        Ok(Run { uniqueness: true, ..self })
    }

    /// Requests an estimate of the time-step error of the tangential forces, by a second run with a quarter of the
    /// increments, or with twice as many if there are few. Without friction there is no second run.
    #[must_use]
    pub fn with_companion(self) -> Self {
        Run { companion: true, ..self }
    }

    /// Requests the results of a load cycle, at whose beginning and end increments must end. A scene with `output.cycle`
    /// requests it itself.
    #[must_use]
    pub fn with_cycle(self, cycle: CycleRequest) -> Self {
        Run { cycle: Some(cycle), ..self }
    }

    /// Resumes from a `checkpoint` that an observer was offered in [`Observer::rest`]. Except for times and numbers of
    /// factorisations, the results agree with those of an uninterrupted run to the last bit, for the same number of
    /// threads and the same BLAS. The report has the records of the remaining increments only; everything else in it
    /// covers all increments.
    ///
    /// [`Run::solve`] returns an error if the checkpoint is damaged, or belongs to another scene, method or linear
    /// solver.
    #[must_use]
    pub fn from(self, checkpoint: Checkpoint) -> Self {
        Run { from: Some(checkpoint), ..self }
    }

    /// Returns the model to solve.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the model and ends the run.
    pub fn into_model(self) -> Model {
        self.model.into_owned()
    }

    /// Returns the ends of the increments, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Returns the linear solver and the reason for its choice.
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// Returns the initial working set of condensed equations, ascending; `None` if it contains all contact nodes.
    /// Other nodes are added when needed.
    pub fn working_set(&self) -> Option<&[usize]> {
        self.reach.nodes.as_deref()
    }

    /// Returns the body before the first increment, as increment 0: undeformed and free of contact forces, with the
    /// gaps at t = 0. Loads and interferences that exist at t = 0 are applied in the first increment.
    pub fn undeformed(&self) -> RecordedIncrement {
        let Model { problem, loading, .. } = &*self.model;
        let contacts = problem.contacts();
        RecordedIncrement {
            record: IncrementRecord::undeformed(contacts),
            state: State::zero(problem),
            statuses: vec![ContactStatus::Open; contacts],
            force: vec![0.0; problem.displacements()],
            gap: loading.gaps_at(0.0),
            mu: loading.friction().map_or_else(|| problem.mu().to_vec(), |friction| friction.at(0.0)),
            w_t_last: vec![0.0; contacts],
            w_o_last: vec![0.0; contacts],
        }
    }

    /// Solves the history and reports on it. `observer` sees every iteration and increment, and may stop the run.
    ///
    /// # Errors
    /// When the linear algebra cannot go on. A history that does not converge is no error; see the status of the
    /// report.
    pub fn solve(&self, observer: &mut dyn Observer) -> Result<RunReport, RunError> {
        self.report(self.system(), Sink::Observer(observer))
    }

    /// Solves the history with a `ledger` that takes the records of the increments. They are then missing in the
    /// report, and take no memory however many there are.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_to(&self, ledger: &mut dyn RecordWriter) -> Result<RunReport, RunError> {
        self.report(self.system(), Sink::RecordWriter(ledger))
    }

    /// Solves the history with another linear system than the chosen one, e.g. with a linear solver of your own:
    /// `SystemSolver::from(solver)`. `sink` takes what comes out.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_with(&self, system: SystemSolver, sink: Sink<'_>) -> Result<RunReport, RunError> {
        self.report(system, sink)
    }

    fn report(&self, system: SystemSolver, mut audience: Sink<'_>) -> Result<RunReport, RunError> {
        let start = Instant::now();
        let (linear, condensed) = (system.name(), system.condenses());
        let companion = self.companion();
        let numbers = companion.as_ref().map_or(&[][..], |companion| &companion.ends[0]);
        let leaps = JumpDetector::new(&self.model, self.solver.method);
        let cycle = self
            .cycle
            .as_ref()
            .and_then(|cycle| CycleWatch::new(&self.model, &self.times, cycle, self.solver.method.is_exact_path()));
        let mut watch = ReportCollector::new(&self.model, self.uniqueness, numbers, cycle, leaps, &mut audience);
        if let Some(checkpoint) = &self.from {
            watch.continue_from(checkpoint).map_err(history::Error::from)?;
        }
        let settings = HistorySettings {
            keeps_records: false,
            estimates_error: true,
            from: self.from.clone(),
            ..self.settings()?
        };
        let outcome = self.history_with(system, &self.times, &settings, &mut watch)?;
        let ReportCollector {
            validity,
            estimates,
            balance,
            curves,
            mut key,
            cycle,
            increments,
            forces,
            reactions,
            last_reactions,
            ..
        } = watch;
        let (last, states, leaps) = (watch.last, watch.states, watch.leaps);
        let mut all_estimates = Estimates { increments: outcome.increment_error, ..estimates.estimates(&self.model) };
        // The history is solved. From here on, a failure of an additional result loses that result only.
        let mut missing = Vec::new();
        if let (Some(companion), Status::Converged) = (companion.as_ref(), outcome.status) {
            let compared = self.compared(companion, &states, audience.observer()).map(Some);
            all_estimates.companion = or_missing(&mut missing, "the estimate by a companion run", compared);
        }
        if self.cycle.is_some() && cycle.is_none() {
            missing.push(Warning::of_missing("the load cycle", &NoCycle));
        }
        let of_mesh = key.moments().map(|moment| {
            let error = moment.map_or(Ok(None), |moment| self.force_error(moment, &estimates));
            or_missing(&mut missing, "the error of a contact force by the mesh", error)
        });
        all_estimates.tangential = key.learn(of_mesh);
        let leap = self.leap(&leaps, &settings, &outcome.scales, audience.observer());
        let leap = or_missing(&mut missing, "the check for jumps of contact forces", leap);
        if outcome.status == Status::Converged {
            let by_start = self.friction_by_start(leaps.largest(), audience.observer());
            all_estimates.start = or_missing(&mut missing, "what the first increment does to friction", by_start);
        }
        let critical = last.map(|last| self.critical_friction(&last)).transpose().map(Option::flatten);
        let critical_friction = or_missing(&mut missing, "the critical friction", critical);
        let measured = Measured {
            cpu_seconds: cpu_seconds(),
            wall_seconds: self.model_seconds + start.elapsed().as_secs_f64(),
            model_seconds: self.model_seconds,
            peak_rss_bytes: peak_rss_bytes(),
            ranks: RankRecord::all(),
        };
        let done = Done {
            increments: outcome.tally.increments,
            factorizations: outcome.linear.factorizations,
            seconds: measured.wall_seconds,
        };
        Ok(RunReport::new(ReportInput {
            scene: self.scene,
            model: &self.model,
            solver: &self.solver,
            condensed,
            working_set: self.working_set().filter(|_| condensed),
            faster: self.faster(&linear, &done),
            linear,
            choice: &self.choice,
            unsuited: fell_back(&outcome.linear, &self.model, self.solver.method),
            outcome: &outcome,
            validity: &validity,
            largest_pressure: estimates.largest_pressure(&self.model, &all_estimates),
            key,
            cycle: cycle.and_then(|cycle| cycle.report(&self.model)),
            estimates: all_estimates,
            increments,
            forces,
            reactions,
            last_reactions,
            leap,
            balance,
            curves,
            critical_friction,
            missing,
            measured,
        }))
    }

    /// Solves the history and returns the outcome without a report: the last state, records, scales of the error
    /// measure.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn history(&self, observer: &mut dyn Observer) -> Result<HistoryOutcome, RunError> {
        let settings = HistorySettings { from: self.from.clone(), ..self.settings()? };
        self.history_with(self.system(), &self.times, &settings, observer)
    }

    fn settings(&self) -> Result<HistorySettings, RunError> {
        let settings = self.solver.settings(&self.model.problem, &self.model.loading)?;
        Ok(HistorySettings { working_set: self.reach.nodes.clone(), ..settings })
    }

    /// Returns the chosen linear system, with an ordering for the expected number of factorisations.
    fn system(&self) -> SystemSolver {
        let expected = || factorizations(&Layout::new(&self.model.problem), self.solver.method, self.times.len());
        match self.choice.linear {
            LinearAlgebra::Whole(lu) => {
                SystemSolver::from(lu.solver_for(self.model.mesh.dimension == 2 && expected() >= MANY))
            }
            LinearAlgebra::Condensed(cholesky) => SystemSolver::condensed(cholesky, self.reach.factor.clone()),
            #[cfg(feature = "petsc")]
            LinearAlgebra::Multigrid => grid::system(&self.model, self.solver.method.increments()),
            #[cfg(not(feature = "petsc"))]
            LinearAlgebra::Multigrid => SystemSolver::from(LinearAlgebra::Multigrid),
        }
    }

    /// Returns the increments of a companion run, if it was requested and there is friction.
    fn companion(&self) -> Option<Companion> {
        let layout = Layout::new(&self.model.problem);
        let has_friction = (0..layout.contacts()).any(|i| layout.has_friction(i));
        (self.companion && has_friction).then(|| Companion::of(&self.times, &self.model.loading.kinks()))
    }

    /// Solves the `companion` of a run with these `states` at the ends of its load segments, and compares.
    fn compared(
        &self,
        companion: &Companion,
        states: &[State],
        observer: &mut dyn Observer,
    ) -> Result<CompanionEstimate, RunError> {
        let mut quiet = Quiet { observer, numbers: &companion.ends[1], states: Vec::new() };
        let settings = HistorySettings { keeps_records: false, ..self.settings()? };
        let status = self.history_with(self.system(), &companion.times, &settings, &mut quiet)?.status;
        let both = [states, &quiet.states[..]];
        Ok(CompanionEstimate::new(&self.model, companion.times.len(), status, both, companion.share))
    }

    /// Returns the error of a force by the mesh at the `moment` of its largest value, N; `None` if it is unknown, as in
    /// contact zones of a few nodes, whose width depends on the mesh.
    fn force_error(&self, moment: &Moment, watch: &EstimateWatch) -> Result<Option<f64>, LinearError> {
        let Model { problem, .. } = &*self.model;
        if self.choice.linear.is_shared() || problem.stiffness().distributed().is_some() {
            return Ok(None);
        }
        let Some(nodes) = moment.weights(&self.model) else { return Ok(None) };
        let z = influence(problem, self.model.scaling(), &nodes, self.system())?;
        let error = z.and_then(|z| error_of_force(&self.model, moment.time, &moment.state.u, &z));
        Ok(error.filter(|error| *error == 0.0 || !watch.is_narrow(&self.model, &moment.state)))
    }

    /// Finds the first increment in which contact forces jump.
    fn leap(
        &self,
        leaps: &JumpDetector,
        settings: &HistorySettings,
        scales: &KktScales,
        observer: &mut dyn Observer,
    ) -> Result<Option<ForceJump>, RunError> {
        if !leaps.are_suspected() {
            return Ok(None);
        }
        let leap = match self.system() {
            SystemSolver::Whole(mut linear) => {
                leaps.first(&self.model, settings, scales, &mut JumpSolver::Whole(&mut linear), observer)
            }
            SystemSolver::Condensed(condensation) => {
                leaps.first(&self.model, settings, scales, &mut JumpSolver::Condensed(&condensation), observer)
            }
        };
        Ok(leap?)
    }

    fn history_with(
        &self,
        system: SystemSolver,
        times: &[f64],
        settings: &HistorySettings,
        observer: &mut dyn Observer,
    ) -> Result<HistoryOutcome, RunError> {
        let Model { problem, loading, .. } = &*self.model;
        Ok(self.solver.solve(problem, loading, times, settings, system, observer)?)
    }

    fn critical_friction(&self, last: &RecordedIncrement) -> Result<Option<CriticalFriction>, history::Error> {
        let scaling = self.model.scaling();
        let (data, state) = (last.data(), &last.state);
        // The exact path has no friction at nodes in two contacts.
        let problem = &self.model.problem.with_friction(data.mu.to_vec())?;
        let critical = match last.record.status {
            Status::NoContinuation => uniqueness::critical_friction_where_lost,
            _ => uniqueness::critical_friction,
        };
        critical(problem, &data, state, scaling, &mut RefinedSolver::default())
    }

    /// Returns a linear solver that would have been much faster than the one named by the scene. Returns `None` also if
    /// the estimate fails, e.g. for lack of memory, because the solved history does not depend on it.
    fn faster(&self, linear: &str, done: &Done) -> Option<Faster> {
        // A distributed stiffness has no local entries for the estimate.
        if linear != self.choice.linear.to_string() || self.model.problem.stiffness().distributed().is_some() {
            return None;
        }
        let means = means(&self.model, self.solver.method, self.budget);
        self.choice.faster(&self.model.problem, &self.reach, self.solver.method, means, done).ok()?
    }
}
