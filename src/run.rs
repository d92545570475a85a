//! The one door: a scene, or a model, solved over its history to a complete report. Nothing is printed, and no file
//! written.
//!
//! ```
//! use stickslip::solver::history::{Method, SolverChoice};
//! use stickslip::body::model::Model;
//! use stickslip::run::{Recording, Run};
//! use stickslip::scene::Scene;
//!
//! let scene = Scene::parse("block.toml", include_str!("../data/scenes/block.toml"), &["mesh.elements=[10,10]".parse()?])?;
//! let report = Run::new(&scene)?.solve(&mut ())?;
//! assert_eq!(report.status.to_string(), "converged");
//!
//! // Arrays of the increments that are wanted, here of all: an observer keeps them.
//! let mut recording = Recording::all();
//! Run::new(&scene)?.solve(&mut recording)?;
//! assert_eq!(recording.increments.len(), report.increments.len());
//!
//! // A model made in Rust goes through the same door.
//! let model = Model::build(&scene.description)?;
//! let again = Run::of(&model, model.times().to_vec(), SolverChoice::new(Method::PaperBn))?.solve(&mut ())?;
//! assert_eq!(again.forces, report.forces);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod auto;
mod companion;
mod discretise;
mod error;
#[cfg(feature = "petsc")]
mod grid;
mod increments;
mod leaps;
mod need;
mod recording;
pub mod report;
mod sharing;
mod start;
mod suited;
mod watch;

use std::borrow::Cow;
use std::time::Instant;

pub use discretise::discretise;
use discretise::{as_chosen, for_run};
pub use error::RunError;
#[cfg(feature = "petsc")]
pub use grid::grid;
pub use increments::increments_for;
pub use need::Need;
pub use recording::{RecordedIncrement, Recording};
pub use suited::{Unsuited, unsuited};

use crate::algebra::linear::RefinedSolver;
use crate::base::memory::Budget;
use crate::body::model::Model;
use crate::run::auto::{Choice, Done, Faster, factorizations};
use crate::run::report::{
    CompanionEstimate, Estimates, Facts, Leap, Measured, RankRecord, RunReport, Warning, cpu_seconds, peak_rss_bytes,
};
use crate::scene::Scene;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::formulation::Layout;
use crate::solver::history::{
    self, HistoryOutcome, HistorySettings, IncrementRecord, JumpSolver, LinearAlgebra, Observer, SolverChoice, Status,
    SystemSolver,
};
use crate::solver::initial_working_set::{self, InitialWorkingSet};
use crate::solver::laws::{ContactStatus, KktScales};
use crate::solver::problem::State;
use crate::solver::uniqueness::{self, CriticalFriction};
use companion::{Companion, Quiet};
use leaps::Leaps;
use suited::{gave_way, means};
pub use watch::Ledger;
use watch::{Audience, Watch};

/// So many factorisations are worth a better order.
const MANY: f64 = 10.0;

/// A model with the increments and the solver that it is to be run with. A run may be solved several times.
#[derive(Debug)]
pub struct Run<'a> {
    scene: Option<&'a Scene>,
    model: Cow<'a, Model>,
    /// The ends of the increments, s.
    times: Vec<f64>,
    solver: SolverChoice,
    choice: Choice,
    /// What the model has left of the memory.
    budget: Option<Budget>,
    /// What condensed equations begin with.
    reach: InitialWorkingSet,
    uniqueness: bool,
    companion: bool,
    /// From where it goes on, if it does not begin with the unloaded body.
    from: Option<Checkpoint>,
    /// Wall time of mesh, assembly and choice, s.
    model_seconds: f64,
}

impl<'a> Run<'a> {
    /// The run that `scene` describes: mesh, stiffness, contact, loads, and the linear algebra chosen where the scene
    /// leaves that open.
    ///
    /// # Errors
    /// As [`discretise`], and when memory is short for the choice.
    pub fn new(scene: &'a Scene) -> Result<Self, RunError> {
        Run::prepared(scene, |_| ())
    }

    /// The same; `prepare` sees the model before the first factorisation, to set how many threads that may take.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn prepared(scene: &'a Scene, prepare: impl FnOnce(&Model)) -> Result<Self, RunError> {
        let start = Instant::now();
        let model = Cow::Owned(for_run(scene)?);
        prepare(&model);
        Run::start(Some(scene), model, scene.time.all(), scene.solver, start)
    }

    /// The run of a `model` made in Rust, over increments that end at `times` (s).
    ///
    /// # Errors
    /// When the times do not increase from 0 or later, and when memory is short for the choice of the linear algebra.
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
        let budget = Budget::of_process();
        // Where factors of the body have no room, nobody asks them how far contact reaches.
        let has_room = || Need::check(&model, LinearAlgebra::condensed(), budget).is_ok();
        let may_condense =
            solver.linear.is_none_or(LinearAlgebra::condenses) && !solver.method.is_of_paper() && has_room();
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
        Need::check(&model, choice.linear, budget)?;
        let model_seconds = start.elapsed().as_secs_f64();
        let (uniqueness, companion, from) = (false, false, None);
        Ok(Run { scene, model, times, solver, choice, budget, reach, uniqueness, companion, from, model_seconds })
    }

    /// The same run, whose report also tells the critical friction at the end.
    ///
    /// # Errors
    /// [`RunError::SlidesInAPlane`] where that cannot be told.
    pub fn with_uniqueness(self) -> Result<Self, RunError> {
        let layout = Layout::new(&self.model.problem);
        if (0..layout.contacts()).any(|i| layout.slides_in_a_plane(i)) {
            return Err(RunError::SlidesInAPlane);
        }
        Ok(Run { uniqueness: true, ..self })
    }

    /// The same run, whose report also tells what its increments leave in the tangential forces, by a second run with a quarter of
    /// the increments, or with twice as many where there are few. Without friction nothing is left.
    #[must_use]
    pub fn with_companion(self) -> Self {
        Run { companion: true, ..self }
    }

    /// The same run from a `checkpoint` that an observer was offered in [`Observer::rest`], as if it had never stopped: the numbers
    /// are the same to the last bit, but for times and for counts of factorisations, on as many threads and with the same BLAS.
    /// The report has the records of the increments that are still to come; all else in it is of all of them.
    ///
    /// That the checkpoint is damaged, or of another scene, method or linear algebra, [`Run::solve`] tells.
    #[must_use]
    pub fn from(self, checkpoint: Checkpoint) -> Self {
        Run { from: Some(checkpoint), ..self }
    }

    /// What is solved.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The same, after the run.
    pub fn into_model(self) -> Model {
        self.model.into_owned()
    }

    /// The ends of the increments, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The linear algebra, and why.
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The contact nodes that condensed equations hold at first, ascending, if not all; others join when they are needed.
    pub fn working_set(&self) -> Option<&[usize]> {
        self.reach.nodes.as_deref()
    }

    /// The body before the first increment, as increment 0: undeformed and free of contact forces, with the gaps at t = 0.
    /// Loads and interferences that are there from the start come with the first increment.
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
    /// When the linear algebra cannot go on. Whether the history converged is the status of the report.
    pub fn solve(&self, observer: &mut dyn Observer) -> Result<RunReport, RunError> {
        self.solve_with(self.system(), observer)
    }

    /// The same with a `ledger` that takes the records of the increments, which then are not in the report: however many
    /// there are, they take no memory.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_to(&self, ledger: &mut dyn Ledger) -> Result<RunReport, RunError> {
        self.report(self.system(), Audience::Ledger(ledger))
    }

    /// The same with another linear system than the chosen one, as by a linear solver of one's own: `SystemSolver::from(solver)`.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_with(&self, system: SystemSolver, observer: &mut dyn Observer) -> Result<RunReport, RunError> {
        self.report(system, Audience::Observer(observer))
    }

    fn report(&self, system: SystemSolver, mut audience: Audience<'_>) -> Result<RunReport, RunError> {
        let start = Instant::now();
        let (linear, condensed) = (system.name(), system.condenses());
        let companion = self.companion();
        let numbers = companion.as_ref().map_or(&[][..], |companion| &companion.ends[0]);
        let leaps = Leaps::new(&self.model, self.solver.method);
        let mut watch = Watch::new(&self.model, self.uniqueness, numbers, leaps, &mut audience);
        if let Some(checkpoint) = &self.from {
            watch.go_on_from(checkpoint).map_err(history::Error::from)?;
        }
        let settings = HistorySettings {
            keeps_records: false,
            estimates_error: true,
            from: self.from.clone(),
            ..self.settings()?
        };
        let outcome = self.history_with(system, &self.times, &settings, &mut watch)?;
        let Watch { validity, estimates, balance, curves, increments, forces, reactions, last_reactions, .. } = watch;
        let (last, states, leaps) = (watch.last, watch.states, watch.leaps);
        let mut all_estimates = Estimates { increments: outcome.increment_error, ..estimates.estimates(&self.model) };
        // The history is solved. A failure of what was asked for beside it costs that result only.
        let mut missing = Vec::new();
        if let (Some(companion), Status::Converged) = (companion.as_ref(), outcome.status) {
            match self.compared(companion, &states, audience.observer()) {
                Ok(compared) => all_estimates.companion = Some(compared),
                Err(error) => missing.push(Warning::of_missing("the comparison with fewer increments", &error)),
            }
        }
        let leap = match self.leap(&leaps, &settings, outcome.scales, audience.observer()) {
            Ok(leap) => leap,
            Err(error) => {
                missing.push(Warning::of_missing("whether contact forces jump", &error));
                None
            }
        };
        let by_start = match outcome.status {
            Status::Converged => self.friction_by_start(audience.observer()),
            _ => Ok(None),
        };
        let start_error = match by_start {
            Ok(error) => error,
            Err(error) => {
                missing.push(Warning::of_missing("what the first increment does to friction", &error));
                None
            }
        };
        let critical_friction = match last.map(|last| self.critical_friction(&last, &outcome)).transpose() {
            Ok(critical) => critical.flatten(),
            Err(error) => {
                missing.push(Warning::of_missing("the critical friction", &error));
                None
            }
        };
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
        Ok(RunReport::new(Facts {
            scene: self.scene,
            model: &self.model,
            solver: &self.solver,
            condensed,
            working_set: self.working_set().filter(|_| condensed),
            faster: self.faster(&linear, &done),
            linear,
            choice: &self.choice,
            unsuited: gave_way(&outcome.linear, &self.model, self.solver.method),
            outcome: &outcome,
            validity: &validity,
            largest_pressure: estimates.largest_pressure(&self.model),
            estimates: all_estimates,
            increments,
            forces,
            reactions,
            last_reactions,
            leap,
            start: start_error,
            balance,
            curves,
            critical_friction,
            missing,
            measured,
        }))
    }

    /// Solves the history and hands back its bare outcome: the last state, records, scales of the error measure.
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

    /// The chosen linear system, in an order for as many factorisations as are to be expected.
    fn system(&self) -> SystemSolver {
        let expected = || factorizations(&Layout::new(&self.model.problem), self.solver.method, self.times.len());
        match self.choice.linear {
            LinearAlgebra::Whole(lu) => {
                SystemSolver::from(lu.solver_for(self.model.mesh.dimension == 2 && expected() >= MANY))
            }
            LinearAlgebra::Condensed(cholesky) => SystemSolver::condensed(cholesky, self.reach.factor.clone()),
            #[cfg(feature = "petsc")]
            LinearAlgebra::Multigrid => grid::system(&self.model, self.solver.method),
            #[cfg(not(feature = "petsc"))]
            LinearAlgebra::Multigrid => SystemSolver::from(LinearAlgebra::Multigrid),
        }
    }

    /// The increments of a second run to compare with, if that was asked for and there is friction.
    fn companion(&self) -> Option<Companion> {
        let layout = Layout::new(&self.model.problem);
        let has_friction = (0..layout.contacts()).any(|i| layout.has_friction(i));
        (self.companion && has_friction).then(|| Companion::of(&self.times, &self.model.loading.kinks()))
    }

    /// Solves the `companion` of a run with these `states` at the ends of its stretches, and compares.
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

    /// Where contact forces jump, if they do.
    fn leap(
        &self,
        leaps: &Leaps,
        settings: &HistorySettings,
        scales: KktScales,
        observer: &mut dyn Observer,
    ) -> Result<Option<Leap>, RunError> {
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
        Ok(history::run(problem, loading, times, settings, system, observer)?)
    }

    fn critical_friction(
        &self,
        last: &RecordedIncrement,
        outcome: &HistoryOutcome,
    ) -> Result<Option<CriticalFriction>, history::Error> {
        let (problem, scaling) = (&self.model.problem, self.model.scaling());
        let (data, state) = (last.data(), &last.state);
        let scales = outcome.scales.with_load(problem, &data).with_state(state);
        let critical = match last.record.status {
            Status::NoContinuation => uniqueness::critical_friction_where_lost,
            _ => uniqueness::critical_friction,
        };
        critical(problem, &data, state, &scales, scaling, &mut RefinedSolver::default())
    }

    /// A linear algebra that would have been much faster than the one that the scene names. `None` also where the estimate itself
    /// fails, as for want of memory: a solved history does not depend on advice.
    fn faster(&self, linear: &str, done: &Done) -> Option<Faster> {
        // A stiffness that processes share has no entries here to estimate from.
        if linear != self.choice.linear.to_string() || self.model.problem.stiffness().shared().is_some() {
            return None;
        }
        let means = means(&self.model, self.solver.method, self.budget);
        self.choice.faster(&self.model.problem, &self.reach, self.solver.method, means, done).ok()?
    }
}
