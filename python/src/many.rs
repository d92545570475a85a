//! Many histories of one body, side by side.

use crate::error::of_run;
use crate::foreign::Raised;
use crate::loading::{History, Tables};
use crate::problem::{Options, Problem, exported};
use crate::recorder::{Keep, PATIENCE, Recorder};
use crate::solve::{Algebra, BUG, detached};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use stickslip::algebra::parallel_map;
use stickslip::run::{AvailableSolvers, Choice, RunError};
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

    fn system(&self, linear: LinearAlgebra) -> SystemSolver {
        match linear {
            LinearAlgebra::Condensed(cholesky) if cholesky == self.condensation.cholesky() => {
                SystemSolver::Condensed(self.condensation.clone())
            }
            linear => linear.into(),
        }
    }

    fn run(
        &self,
        solver: &SolverChoice,
        linear: LinearAlgebra,
        recorder: &mut Recorder,
    ) -> Result<HistoryOutcome, RunError> {
        let loading = self.loading()?;
        let settings = solver.settings(&self.problem, &loading)?;
        Ok(solver.solve(&self.problem, &loading, &self.history.times, &settings, self.system(linear), recorder)?)
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

/// The linear algebra for all samples: the cheapest for so many increments. A body that is to be condensed is so afterwards.
fn prepared(samples: &[Sample], solver: &SolverChoice) -> Result<LinearAlgebra, RunError> {
    let Some(first) = samples.first() else { return Ok(LinearAlgebra::default()) };
    let loading = first.loading()?;
    // What is wrong with the settings is wrong for all.
    solver.settings(&first.problem, &loading)?;
    let increments = samples.iter().map(|sample| sample.history.times.len()).sum();
    let linear = match solver.linear {
        Some(linear) => linear,
        None if first.condensation.is_for(&first.problem) => LinearAlgebra::Condensed(first.condensation.cholesky()),
        None => {
            let every = InitialWorkingSet::default();
            Choice::cheapest(&first.problem, &every, solver.method, increments, AvailableSolvers::of_process())?.linear
        }
    };
    if let SystemSolver::Condensed(condensation) = first.system(linear) {
        // Without success, each history says why.
        let _ = Condensed::new(&first.problem, &loading, condensation);
    }
    Ok(linear)
}

/// Something was raised in Python, such as `KeyboardInterrupt`.
struct Ended;

/// Looks at signals, and tells `progress` how many more are done, until nobody sends any more.
fn attend(done: &Receiver<()>, progress: Option<&Py<PyAny>>, raised: &Raised) {
    loop {
        let more = match done.recv_timeout(PATIENCE) {
            Ok(()) => 1 + done.try_iter().count(),
            Err(RecvTimeoutError::Timeout) => 0,
            Err(RecvTimeoutError::Disconnected) => return,
        };
        let told = Python::attach(|py| {
            py.check_signals()?;
            match progress {
                Some(progress) if more > 0 => progress.call1(py, (more,)).map(drop),
                _ => Ok(()),
            }
        });
        if let Err(error) = told {
            raised.set(error);
        }
    }
}

/// Solves histories, `threads` at a time. Each is a dictionary as that of `Problem.run`; one that failed has its `reason`.
#[pyfunction]
#[pyo3(signature = (samples, options, linear, keep, threads, progress))]
pub(crate) fn solve_many<'py>(
    py: Python<'py>,
    samples: Vec<(PyRef<'py, Problem>, Tables<'py>)>,
    options: Options,
    linear: Option<&Bound<'py, PyAny>>,
    keep: Keep,
    threads: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let raised = Raised::default();
    let (linear, _) = Algebra::new(linear, &raised)?.split(None);
    let solver = options.solver(linear)?;
    let mut posed: Vec<Sample> = Vec::new();
    for (problem, tables) in &samples {
        let last = posed.len().checked_sub(1).map(|k| (&samples[k].1, &posed[k].history));
        let history = tables.history(&problem.0, last)?;
        posed.push(Sample { problem: Arc::clone(&problem.0), condensation: problem.1.clone(), history });
    }
    let solved = detached(py, || {
        let linear = prepared(&posed, &solver)?;
        let (sender, receiver) = channel();
        let (solver, keep, all) = (&solver, &keep, &posed);
        // The only sender goes with the work, so that the end of it is seen.
        let raised = raised.clone();
        let told = raised.clone();
        let one = move |sample: &Sample| {
            if told.is_set() {
                return Err(Ended);
            }
            let found = sample.solved(solver, linear, Recorder::new(keep.clone(), None, told.clone()));
            // Nobody listens any more only after a panic.
            let _ = sender.send(());
            Ok(found)
        };
        thread::scope(|scope| {
            // What was raised is told in place of results.
            let work = scope.spawn(move || parallel_map(all, threads, one).unwrap_or_default());
            attend(&receiver, progress.as_ref(), &raised);
            Ok(work.join().unwrap_or_else(|_| all.iter().map(|_| Err(BUG.to_string())).collect()))
        })
    });
    let solved: Vec<Solved> = solved.map_err(of_run)?;
    if let Some(error) = raised.take() {
        return Err(error);
    }
    let dictionary = |found: Solved| match found {
        Ok((outcome, recorder)) => exported(py, &outcome, recorder),
        Err(reason) => {
            let result = PyDict::new(py);
            for (name, value) in [("status", "failed"), ("reason", &reason), ("records", "[]")] {
                result.set_item(name, value)?;
            }
            result.set_item("free_motion", py.None())?;
            Recorder::new(Keep::All(false), None, Raised::default()).write(&result)?;
            Ok(result)
        }
    };
    solved.into_iter().map(dictionary).collect()
}
