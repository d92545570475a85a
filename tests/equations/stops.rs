//! Histories that end early: by request, or because the linear solver fails. The increments before stay.

use crate::common::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use stickslip::solver::IterationRecord;
use stickslip::solver::history::Error;

/// An observer that stops the history after an increment, or in one.
struct Watched {
    stops_after: usize,
    stops_in: usize,
    states: Vec<State>,
}

impl Watched {
    fn new() -> Self {
        Watched { stops_after: usize::MAX, stops_in: usize::MAX, states: Vec::new() }
    }
}

impl Observer for Watched {
    fn iteration(&mut self, index: usize, _record: &IterationRecord) -> ControlFlow<()> {
        if index == self.stops_in { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        assert_eq!(step.record.index, self.states.len() + 1);
        self.states.push(step.state.clone());
        if step.record.index == self.stops_after { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn block() -> (Scene, Model) {
    let scene = parsed_with(BLOCK, &["mesh.elements=[8,8]", "solver.setting='default'"]);
    let model = discretise(&scene).unwrap();
    (scene, model)
}

fn systems() -> [SystemSolver; 2] {
    [LinearAlgebra::default().into(), LinearAlgebra::condensed().into()]
}

#[test]
fn an_interruption_keeps_what_is_solved() {
    let (scene, model) = block();
    let (problem, loading, times) = (&model.problem, &model.loading, scene.time.all());
    let settings = HistorySettings::new(problem, loading, Method::BN).unwrap();
    let run = |watched: &mut Watched, system: SystemSolver| -> HistoryOutcome {
        history::run(problem, loading, &times, &settings, system, watched).unwrap()
    };
    for system in systems() {
        let outcome = run(&mut Watched { stops_in: 13, ..Watched::new() }, system);
        assert_eq!((outcome.status, outcome.records.len()), (Status::Interrupted, 13));
        assert!(outcome.records[..12].iter().all(|record| record.status == Status::Converged));
        assert_eq!(outcome.reached, outcome.records[11].time);
    }
    for system in systems() {
        let mut watched = Watched { stops_after: 13, ..Watched::new() };
        let outcome = run(&mut watched, system);
        assert_eq!((outcome.status, outcome.records.len()), (Status::Interrupted, 13));
        assert_eq!((outcome.reached, watched.states.len()), (outcome.records[12].time, 13));
    }
}

/// BN whose linear algebra fails in one increment.
struct Failing {
    settings: HistorySettings,
    /// Increments still to be solved before that.
    left: Arc<AtomicUsize>,
    error: LinearError,
}

impl Algorithm for Failing {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        let (left, error) = (Arc::clone(&self.left), self.error.clone());
        around(self.settings.start(problem, loading), move |inner, task, linear, observe| {
            let fails = left.fetch_sub(1, Ordering::Relaxed) == 0;
            if fails { Err(error.clone()) } else { inner.solve(task, linear, observe) }
        })
    }
}

/// An error of the linear solver is reported after the increments before it. A lack of memory is a verdict.
#[test]
fn an_error_of_the_linear_solver_keeps_what_is_solved() {
    let (scene, model) = block();
    let (problem, loading, times) = (&model.problem, &model.loading, scene.time.all());
    let settings = HistorySettings { halvings: 0, ..HistorySettings::new(problem, loading, Method::BN).unwrap() };
    let run = |before: usize, error: &LinearError, system: SystemSolver| {
        let failing =
            Failing { settings: settings.clone(), left: Arc::new(AtomicUsize::new(before)), error: error.clone() };
        let mut watched = Watched::new();
        let outcome = history::run_with(problem, loading, &times, &failing, &settings, system, &mut watched);
        (outcome, watched.states.len())
    };
    let memory = LinearError::OutOfMemory { step: "the factorisation" };
    let other = LinearError::Backend { backend: "mine", step: "the factorisation", status: -1 };
    for before in [0, 1, 5] {
        for system in systems() {
            let (outcome, seen) = run(before, &memory, system);
            let outcome = outcome.unwrap();
            assert_eq!((outcome.status, outcome.records.len(), seen), (Status::OutOfMemory, before, before));
        }
        for system in systems() {
            let (outcome, seen) = run(before, &other, system);
            assert_eq!((outcome.unwrap_err(), seen), (Error::Linear(other.clone()), before));
        }
    }
}
