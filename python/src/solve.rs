//! A run from Python: its method and linear algebra, its signals, its exceptions.

use crate::error::of_run;
use crate::foreign::{Foreign, Raised};
use crate::recorder::Recorder;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process;
use std::sync::OnceLock;
use stickslip::algebra::keep_in_this_thread;
use stickslip::run::{AvailableSolvers, Choice, RunError};
use stickslip::solver::history::{HistoryMethod, LinearAlgebra, Method, Start, SystemSolver};
use stickslip::solver::{ContactProblem, InitialWorkingSet};

/// The linear algebra that was asked for.
pub(crate) enum Algebra {
    /// The solver of the scene, or else the one that suits the sizes.
    Unsaid,
    /// The solver that suits the sizes.
    Auto,
    Named(LinearAlgebra),
    Foreign(Box<Foreign>),
}

impl Algebra {
    pub fn new(linear: Option<&Bound<'_, PyAny>>, raised: &Raised) -> PyResult<Self> {
        let Some(linear) = linear else { return Ok(Algebra::Unsaid) };
        let Ok(word) = linear.cast::<PyString>() else {
            return Ok(Algebra::Foreign(Box::new(Foreign::new(linear.clone().unbind(), raised.clone()))));
        };
        if word == "auto" {
            return Ok(Algebra::Auto);
        }
        let word = word.to_string();
        let named: LinearAlgebra = word.parse().map_err(|_| {
            PyValueError::new_err(format!(
                "linear is {word:?}, expected auto, faer, partial, condensed, umfpack or an object"
            ))
        })?;
        if !named.is_built_in() {
            return Err(PyValueError::new_err(format!("linear: this build has no {word}, see stickslip.UMFPACK")));
        }
        Ok(Algebra::Named(named))
    }

    /// What a run is told of it, where a scene says `said`, and the system that takes the place of the chosen one.
    pub fn split(self, said: Option<LinearAlgebra>) -> (Option<LinearAlgebra>, Option<SystemSolver>) {
        match self {
            Algebra::Unsaid => (said, None),
            Algebra::Auto => (None, None),
            Algebra::Named(linear) => (Some(linear), None),
            Algebra::Foreign(solver) => (Some(LinearAlgebra::default()), Some(SystemSolver::from(solver as Box<_>))),
        }
    }
}

/// The linear algebra that suits the sizes.
pub(crate) fn by_size(problem: &ContactProblem, reach: &InitialWorkingSet) -> Result<LinearAlgebra, RunError> {
    Ok(Choice::by_size(problem, reach, AvailableSolvers::of_process())?.linear)
}

/// A method with its setting, as scenes call them.
pub(crate) fn method(name: &str, setting: &str, r_factor: f64) -> PyResult<HistoryMethod> {
    if !(r_factor > 0.0 && r_factor.is_finite()) {
        return Err(PyValueError::new_err(format!("r_factor is {r_factor}, but must be finite and above 0")));
    }
    let method = match (name, setting) {
        ("bn", "default") => Method::Bn { r_factor, rescue: true },
        ("bn", "paper") => Method::PaperBn,
        ("ip", "default") => Method::Ip,
        ("ip", "paper") => Method::paper_ip(Start::Safe),
        ("events", "default") => return Ok(HistoryMethod::ExactPath),
        _ => return Err(PyValueError::new_err(format!("method {name:?} has no setting {setting:?}"))),
    };
    Ok(method.into())
}

/// The process that the threads of this module belong to: the first that has computed.
static HOME: OnceLock<u32> = OnceLock::new();

thread_local! {
    /// Whether the calling thread has been told to work alone.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Does `work` without the lock of the interpreter. A forked child has none of its parent's threads and would wait for
/// them for ever, so each thread of a child works alone.
pub(crate) fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| {
        if *HOME.get_or_init(process::id) != process::id() && !ALONE.replace(true) {
            keep_in_this_thread();
        }
        work()
    })
}

/// What a panic says.
pub(crate) const BUG: &str = "a bug in stickslip: please report it with the arrays that led to it";

/// Runs without the lock of the interpreter. Whatever Python has raised meanwhile comes out, and a panic as an
/// exception.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    mut recorder: Recorder,
    run: impl FnOnce(&mut Recorder) -> Result<T, RunError> + Send,
) -> PyResult<(T, Recorder)> {
    let (outcome, recorder) = detached(py, move || {
        let outcome = catch_unwind(AssertUnwindSafe(|| run(&mut recorder)));
        (outcome, recorder)
    });
    if let Some(error) = recorder.raised.take() {
        return Err(error);
    }
    match outcome {
        Ok(done) => Ok((done.map_err(of_run)?, recorder)),
        Err(_) => Err(PyRuntimeError::new_err(BUG)),
    }
}
