//! Many histories of one body, side by side.

use crate::error::of_run;
use crate::foreign::Raised;
use crate::loading::{History, Tables};
use crate::problem::{Options, Problem, exported, system};
use crate::recorder::{Keep, PATIENCE, Recorder};
use crate::solve::{Algebra, BUG, by_size, detached};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use stickslip::algebra::parallel_map;
use stickslip::run::RunError;
use stickslip::solver::history::{self, HistoryOutcome, LinearAlgebra, SolverChoice, SystemSolver};
use stickslip::solver::{Condensation, Condensed, ContactProblem, InitialWorkingSet, Loading};

/// One of the histories.
struct Sample {
    problem: Arc<ContactProblem>,
    condensation: Condensation,
    history: History,
}

/// What came of it, or why nothing did.
type Solved = Result<(HistoryOutcome, Recorder), String>;

impl Sample {
    fn loading(&self) -> Result<Loading, RunError> {
        Ok(self.history.loading().map_err(history::Error::from)?)
    }

    fn run(
        &self,
        solver: &SolverChoice,
        linear: LinearAlgebra,
        recorder: &mut Recorder,
    ) -> Result<HistoryOutcome, RunError> {
        let loading = self.loading()?;
        let settings = solver.settings(&self.problem, &loading)?;
        let system = system(&self.condensation, linear);
        Ok(solver.solve(&self.problem, &loading, &self.history.times, &settings, system, recorder)?)
    }

    /// A failure of one history, a panic included, is no failure of the others.
    fn solved(&self, solver: &SolverChoice, linear: LinearAlgebra, mut recorder: Recorder) -> Solved {
        match catch_unwind(AssertUnwindSafe(|| self.run(solver, linear, &mut recorder))) {
            Ok(Ok(outcome)) => Ok((outcome, recorder)),
            Ok(Err(error)) => Err(error.to_string()),
            Err(_) => Err(BUG.to_string()),
        }
    }
}

/// The linear algebra for all samples. A body that is to be condensed is so afterwards.
fn prepared(samples: &[Sample], solver: &SolverChoice) -> Result<LinearAlgebra, RunError> {
    let Some(first) = samples.first() else { return Ok(LinearAlgebra::default()) };
    let loading = first.loading()?;
    // What is wrong with the settings is wrong for all.
    solver.settings(&first.problem, &loading)?;
    let linear = match solver.linear {
        Some(linear) => linear,
        None if first.condensation.is_for(&first.problem) => LinearAlgebra::Condensed(first.condensation.cholesky()),
        None => by_size(&first.problem, &InitialWorkingSet::default())?,
    };
    if let SystemSolver::Condensed(condensation) = system(&first.condensation, linear) {
        // Without success, each history says why.
        let _ = Condensed::new(&first.problem, &loading, condensation);
    }
    Ok(linear)
}

/// Something was raised in Python, such as `KeyboardInterrupt`.
struct Ended;

/// A history as a dictionary like that of `Problem.run`; one that failed has its `reason`.
fn dictionary(py: Python<'_>, found: Solved) -> PyResult<Bound<'_, PyDict>> {
    let reason = match found {
        Ok((outcome, recorder)) => return exported(py, &outcome, recorder),
        Err(reason) => reason,
    };
    let result = PyDict::new(py);
    for (name, value) in [("status", "failed"), ("reason", &reason), ("records", "[]")] {
        result.set_item(name, value)?;
    }
    result.set_item("free_motion", py.None())?;
    Recorder::new(Keep::All(false), None, Raised::default()).write(&result)?;
    Ok(result)
}

/// Looks at signals, and hands `take` the number of each history that is done and what came of it, until nobody sends any more.
fn attend(done: &Receiver<(usize, Solved)>, take: &Py<PyAny>, raised: &Raised) {
    loop {
        let found = match done.recv_timeout(PATIENCE) {
            Ok(found) => Some(found),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => return,
        };
        if raised.is_set() {
            // Nobody waits with what is done meanwhile.
            continue;
        }
        let taken = Python::attach(|py| {
            py.check_signals()?;
            let Some((number, found)) = found else { return Ok(()) };
            take.call1(py, (number, dictionary(py, found)?)).map(drop)
        });
        if let Err(error) = taken {
            raised.set(error);
        }
    }
}

/// Solves histories, `threads` at a time, and hands each to `take` once it is done, so that none is kept here.
#[pyfunction]
pub(crate) fn solve_many<'py>(
    py: Python<'py>,
    samples: Vec<(PyRef<'py, Problem>, Tables<'py>)>,
    options: Options,
    linear: Option<&Bound<'py, PyAny>>,
    keep: Keep,
    threads: usize,
    take: Py<PyAny>,
) -> PyResult<()> {
    let raised = Raised::default();
    let (linear, _) = Algebra::new(linear, &raised)?.split(None);
    let solver = options.solver(linear)?;
    let mut posed: Vec<Sample> = Vec::new();
    for (problem, tables) in &samples {
        let last = posed.len().checked_sub(1).map(|k| (&samples[k].1, &posed[k].history));
        let history = tables.history(&problem.0, last)?;
        posed.push(Sample { problem: Arc::clone(&problem.0), condensation: problem.1.clone(), history });
    }
    let is_whole = detached(py, || {
        let linear = prepared(&posed, &solver)?;
        // Whoever is ahead of Python waits.
        let (sender, receiver) = sync_channel(threads);
        let tasks: Vec<_> = posed.iter().enumerate().collect();
        // The only sender goes with the work, so that the end of it is seen.
        let (solver, keep, ended) = (&solver, &keep, raised.clone());
        let one = move |(number, sample): &(usize, &Sample)| {
            if ended.is_set() {
                return Err(Ended);
            }
            let found = sample.solved(solver, linear, Recorder::new(keep.clone(), None, ended.clone()));
            // Nobody listens any more only after a panic.
            let _ = sender.send((*number, found));
            Ok(())
        };
        Ok(thread::scope(|scope| {
            let work = scope.spawn(move || drop(parallel_map(&tasks, threads, one)));
            attend(&receiver, &take, &raised);
            work.join().is_ok()
        }))
    });
    let is_whole = is_whole.map_err(of_run)?;
    match raised.take() {
        Some(error) => Err(error),
        None if is_whole => Ok(()),
        None => Err(PyRuntimeError::new_err(BUG)),
    }
}
