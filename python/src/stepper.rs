//! One increment after the other, for time loops in Python.

use crate::foreign::Raised;
use crate::loading::Tables;
use crate::problem::{Options, Problem, exported};
use crate::recorder::{Keep, Recorder};
use crate::solve::{Algebra, watched};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex};
use stickslip::run::{AvailableSolvers, Choice, RunError};
use stickslip::solver::history::{self, SolverChoice, SystemSolver};
use stickslip::solver::{ContactProblem, InitialWorkingSet, Loading};

/// So many increments are expected of somebody who goes step by step: enough for what is kept to be worth it.
const EXPECTED: usize = 100;

type Steps = history::Stepper<Arc<ContactProblem>>;

/// A history of which nobody knows the rest.
#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct Stepper {
    problem: Arc<ContactProblem>,
    solver: SolverChoice,
    raised: Raised,
    /// What waits for the first increment, and then what goes on.
    on_the_way: Mutex<(Option<SystemSolver>, Option<Steps>)>,
}

impl Stepper {
    /// What the first increment begins: its load tells the units inside.
    fn begin(&self, loading: &Loading, own: &mut Option<SystemSolver>) -> Result<Steps, RunError> {
        let settings = self.solver.settings(&self.problem, loading)?;
        let system = match (own.take(), self.solver.linear) {
            (Some(own), _) => own,
            (None, Some(linear)) => linear.into(),
            (None, None) => {
                let every = InitialWorkingSet::default();
                Choice::cheapest(&self.problem, &every, self.solver.method, EXPECTED, AvailableSolvers::of_process())?
                    .linear
                    .into()
            }
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
        Ok(Stepper { problem: Arc::clone(&problem.0), solver, raised, on_the_way: Mutex::new((own, None)) })
    }

    /// The end of the last increment that converged, s.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        let on_the_way = self.on_the_way.try_lock().map_err(|_| busy())?;
        Ok(on_the_way.1.as_ref().map_or(0.0, Steps::time))
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
        let (loading, times) = (tables.loading(&self.problem)?, tables.times());
        let end = times.last().copied().unwrap_or(0.0);
        let mut on_the_way = self.on_the_way.try_lock().map_err(|_| busy())?;
        let (own, steps) = &mut *on_the_way;
        let (outcome, recorder) = watched(py, Recorder::new(keep, callback, self.raised.clone()), |recorder| {
            let begun = match steps.take() {
                Some(begun) => begun,
                None => self.begin(&loading, own)?,
            };
            Ok(steps.insert(begun).step(&loading, end, recorder)?)
        })?;
        exported(py, &outcome, recorder)
    }
}

fn busy() -> PyErr {
    PyRuntimeError::new_err(
        "this stepper is in an increment: from its callback, or in another thread, it takes no other",
    )
}
