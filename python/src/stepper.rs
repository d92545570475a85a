//! One increment after the other, for time loops in Python.

use crate::error::of_run;
use crate::foreign::Raised;
use crate::loading::Tables;
use crate::problem::{Options, Problem, exported};
use crate::recorder::{Keep, Recorder};
use crate::solve::{Algebra, by_size, watched};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, MutexGuard};
use stickslip::run::RunError;
use stickslip::solver::history::{self, SolverChoice, StepperState, SystemSolver};
use stickslip::solver::{ContactProblem, InitialWorkingSet, Loading};

type Steps = history::Stepper<Arc<ContactProblem>>;

/// What waits for the first increment, and then what goes on.
struct OnTheWay {
    own: Option<SystemSolver>,
    steps: Option<Steps>,
    /// Before the first increment.
    start: Option<StepperState>,
}

/// Where a stepper was; `None` before its first increment.
#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct SavedSteps(Option<StepperState>);

/// A history of which nobody knows the rest.
#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct Stepper {
    problem: Arc<ContactProblem>,
    solver: SolverChoice,
    raised: Raised,
    on_the_way: Mutex<OnTheWay>,
}

impl Stepper {
    fn idle(&self) -> PyResult<MutexGuard<'_, OnTheWay>> {
        self.on_the_way.try_lock().map_err(|_| {
            PyRuntimeError::new_err(
                "this stepper is in an increment: from its callback, or in another thread, it takes no other",
            )
        })
    }

    /// What the first increment begins: its load tells the units inside.
    fn begin(&self, loading: &Loading, own: &mut Option<SystemSolver>) -> Result<Steps, RunError> {
        let settings = self.solver.settings(&self.problem, loading)?;
        let system = match (own.take(), self.solver.linear) {
            (Some(own), _) => own,
            (None, Some(linear)) => linear.into(),
            (None, None) => by_size(&self.problem, &InitialWorkingSet::default())?.into(),
        };
        Ok(Steps::new(Arc::clone(&self.problem), settings, system)?)
    }
}

#[pymethods]
impl Stepper {
    #[new]
    #[pyo3(signature = (problem, options, linear))]
    fn new(problem: &Problem, options: Options, linear: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let raised = Raised::default();
        let (linear, own) = Algebra::new(linear, &raised)?.split(None);
        let solver = options.solver(linear)?;
        if solver.method.is_exact_path() {
            let message =
                "the method events (default) takes no single increments: it follows the whole path of the loads";
            return Err(PyValueError::new_err(message));
        }
        Ok(Stepper {
            problem: Arc::clone(&problem.0),
            solver,
            raised,
            on_the_way: Mutex::new(OnTheWay { own, steps: None, start: None }),
        })
    }

    /// The end of the last increment that converged, s.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        Ok(self.idle()?.steps.as_ref().map_or(0.0, Steps::time))
    }

    /// Where it is.
    fn save(&self) -> PyResult<SavedSteps> {
        Ok(SavedSteps(self.idle()?.steps.as_ref().map(Steps::save)))
    }

    /// Goes back to where it was.
    fn restore(&self, saved: &SavedSteps) -> PyResult<()> {
        let OnTheWay { steps, start, .. } = &mut *self.idle()?;
        if let (Some(steps), Some(state)) = (steps, saved.0.as_ref().or(start.as_ref())) {
            steps.restore(state).map_err(|error| of_run(RunError::from(error)))?;
        }
        Ok(())
    }

    /// Goes on to the last time of `tables`, which tell the loads of both ends.
    #[pyo3(signature = (tables, keep, callback))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        tables: Tables<'py>,
        keep: Keep,
        callback: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (loading, times) = tables.loading(&self.problem)?;
        let end = times.last().copied().unwrap_or(0.0);
        let OnTheWay { own, steps, start } = &mut *self.idle()?;
        let before = steps.as_ref().map(Steps::save);
        let watched = watched(py, Recorder::new(keep, callback, self.raised.clone()), |recorder| {
            let begun = match steps.take() {
                Some(begun) => begun,
                None => self.begin(&loading, own)?,
            };
            start.get_or_insert_with(|| begun.save());
            Ok(steps.insert(begun).step(&loading, end, recorder)?)
        });
        // Whoever gets no result has made no step, also where the increment converged before a callback raised.
        if let (Err(_), Some(steps), Some(before)) = (&watched, steps, before.as_ref().or(start.as_ref())) {
            steps.restore(before).map_err(|error| of_run(RunError::from(error)))?;
        }
        let (outcome, recorder) = watched?;
        exported(py, &outcome, recorder)
    }
}
