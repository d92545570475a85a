//! Solves a scene, or a model, over its history and reports on it. Prints nothing and writes no files.
//!
//! ```
//! use stickslip::solver::history::{Method, SolverChoice};
//! use stickslip::body::Model;
//! use stickslip::run::{Recording, Run};
//! use stickslip::scene::Scene;
//!
//! let scene = Scene::parse("block.toml", include_str!("../data/scenes/block.toml"),
//! &["mesh.elements=[10,10]".parse()?])?; let report = Run::new(&scene)?.solve(&mut ())?;
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
mod auto;
mod checks;
mod discretise;
mod error;
mod force_jumps;
mod grid;
mod lock;
mod need;
mod recording;
mod refinement;
pub mod report;
mod results;
mod start;
mod watch;

use std::borrow::Cow;
use std::time::Instant;

pub use applicable::{Unsuited, unsuited};
use discretise::{as_chosen, for_run};
pub use discretise::{discretise, expect_exact_path, tightening};
pub use error::RunError;
pub use grid::grid;
pub use need::MemoryEstimate;
pub use recording::{RecordedIncrement, Recording};
pub use refinement::{CoarserMesh, Refinement};

use crate::base::memory::Budget;
use crate::body::description::CycleRequest;
use crate::body::model::Model;
use crate::run::report::RunReport;
use crate::scene::Scene;
use crate::solver::checkpoint::Checkpoint;
use crate::solver::formulation::Layout;
use crate::solver::history::{
    self, HistoryOutcome, HistorySettings, IncrementRecord, LinearAlgebra, Observer, SolverChoice, SystemSolver,
};
use crate::solver::initial_working_set::{self, InitialWorkingSet};
use crate::solver::laws::ContactStatus;
use crate::solver::problem::State;
use applicable::available_solvers;
pub use auto::{AvailableSolvers, Choice};
pub use watch::{RecordWriter, Sink};

/// A model with its increments and its solver. A run may be solved several times.
#[derive(Debug)]
pub struct Run<'a> {
    scene: Option<&'a Scene>,
    model: Cow<'a, Model>,
    /// The ends of the increments, s.
    times: Vec<f64>,
    solver: SolverChoice,
    choice: Choice,
    /// The initial working set of condensed equations.
    initial_set: InitialWorkingSet,
    uniqueness: bool,
    cycle: Option<CycleRequest>,
    /// The checkpoint from which the run resumes; `None` to begin with the unloaded body.
    from: Option<Checkpoint>,
    /// The meshes that were solved before, if the mesh refined itself.
    coarser_meshes: Vec<CoarserMesh>,
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
        Run::prepared(scene, &mut |_| (), &mut ())
    }

    /// Prepares the run described by `scene`. `prepare` sees the model before the first factorisation, e.g. to set the
    /// number of threads. If the mesh refines itself, it sees the coarser models, too, and `observer` sees the
    /// iterations on them.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn prepared(
        scene: &'a Scene,
        prepare: &mut dyn FnMut(&Model),
        observer: &mut dyn Observer,
    ) -> Result<Self, RunError> {
        let start = Instant::now();
        let (model, coarser_meshes) = for_run(scene, prepare, observer)?;
        prepare(&model);
        let run = Run::start(Some(scene), Cow::Owned(model), scene.time.all(), scene.solver, start)?;
        Ok(Run { coarser_meshes, ..run })
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
        let initial_set = if may_condense {
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
            let available = available_solvers(&model, solver.method, budget);
            Choice::by_size(&model.problem, &initial_set, available)?
        };
        let model = as_chosen(scene, model, solver, choice.linear)?;
        MemoryEstimate::check(&model, &initial_set, choice.linear, budget)?;
        let model_seconds = start.elapsed().as_secs_f64();
        let cycle = scene.and_then(|scene| scene.output.cycle);
        let (uniqueness, from, coarser_meshes) = (false, None, Vec::new());
        Ok(Run {
            scene,
            model,
            times,
            solver,
            choice,
            initial_set,
            uniqueness,
            cycle,
            from,
            coarser_meshes,
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

    /// Requests the results of a load cycle, at whose beginning and end increments must end. A scene with
    /// `output.cycle` requests it itself.
    #[must_use]
    pub fn with_cycle(self, cycle: CycleRequest) -> Self {
        Run { cycle: Some(cycle), ..self }
    }

    /// Resumes from a `checkpoint` that an observer was offered in [`Observer::checkpoint_offered`]. Except for times
    /// and numbers of factorisations, the results agree with those of an uninterrupted run to the last bit, for the
    /// same number of threads and the same BLAS. The report has the records of the remaining increments only;
    /// everything else in it covers all increments.
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

    /// Returns the meshes that were solved before, if the mesh refined itself.
    pub fn coarser_meshes(&self) -> &[CoarserMesh] {
        &self.coarser_meshes
    }

    /// Returns the linear solver and the reason for its choice.
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// Returns the initial working set of condensed equations, ascending; `None` if it contains all contact nodes.
    /// Other nodes are added when needed.
    pub fn working_set(&self) -> Option<&[usize]> {
        self.initial_set.nodes.as_deref()
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

    /// Solves the history with a `writer` that takes the records of the increments. They are then missing in the
    /// report, and take no memory however many there are.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_to(&self, writer: &mut dyn RecordWriter) -> Result<RunReport, RunError> {
        self.report(self.system(), Sink::RecordWriter(writer))
    }

    /// Solves the history with another linear system than the chosen one, e.g. with a linear solver of your own:
    /// `SystemSolver::from(solver)`. `sink` takes what comes out.
    ///
    /// # Errors
    /// As [`Run::solve`].
    pub fn solve_with(&self, system: SystemSolver, sink: Sink<'_>) -> Result<RunReport, RunError> {
        self.report(system, sink)
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
        Ok(HistorySettings { working_set: self.initial_set.nodes.clone(), ..settings })
    }

    /// Returns the chosen linear system. Where it is factored many times in the plane, a better ordering is worth its
    /// time.
    fn system(&self) -> SystemSolver {
        let many = self.times.len() > 1 || self.solver.method.is_exact_path();
        let touches = self.model.problem.contacts() > 0;
        match self.choice.linear {
            LinearAlgebra::Whole(lu) => {
                SystemSolver::from(lu.solver_for(self.model.mesh.dimension == 2 && touches && many))
            }
            LinearAlgebra::Condensed(cholesky) => SystemSolver::condensed(cholesky, self.initial_set.factor.clone()),
            LinearAlgebra::Multigrid => grid::system(&self.model, self.solver.method.increments(), None),
            LinearAlgebra::Petsc => {
                let options = self.scene.map_or("", |scene| &scene.petsc);
                grid::system(&self.model, self.solver.method.increments(), Some(options))
            }
        }
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
}
