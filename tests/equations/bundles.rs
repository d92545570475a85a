//! Increments that are solved ahead on the contact displacements and judged together: nothing of it shows in what is told.
#![allow(clippy::unwrap_used)]

use crate::common::around::around;
use crate::common::difference;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::rc::Rc;
use stickslip::algebra::linear::LinearError;
use stickslip::body::Model;
use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip::solver::history::{
    self, Algorithm, Error, HistoryOutcome, HistorySettings, IncrementRecord, IncrementSolver, IncrementView,
    LinearAlgebra, Method, Observer, Status,
};
use stickslip::solver::{ContactProblem, IterationRecord, Loading, State};

const BLOCK: &str = include_str!("../../data/scenes/block.toml");

/// Waits for some increments, and stops at one, or in one.
struct Watched {
    waits: fn(usize) -> bool,
    stops_after: usize,
    stops_in: usize,
    states: Vec<State>,
    /// For each increment the last one of which an iteration was told before.
    ahead: Vec<usize>,
    iterating: usize,
}

impl Watched {
    fn new(waits: fn(usize) -> bool) -> Self {
        let (stops_after, stops_in) = (usize::MAX, usize::MAX);
        Watched { waits, stops_after, stops_in, states: Vec::new(), ahead: Vec::new(), iterating: 0 }
    }
}

impl Observer for Watched {
    fn waits_for(&mut self, index: usize) -> bool {
        (self.waits)(index)
    }

    fn iteration(&mut self, index: usize, _record: &IterationRecord) -> ControlFlow<()> {
        self.iterating = index;
        if index == self.stops_in { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        assert_eq!(step.record.index, self.states.len() + 1);
        self.states.push(step.state.clone());
        self.ahead.push(self.iterating);
        if step.record.index == self.stops_after { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn scene(text: &str, overrides: &[&str]) -> (Scene, Model) {
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::parse("scene.toml", text, &overrides).unwrap();
    let model = discretise(&scene).unwrap();
    (scene, model)
}

fn run((scene, model): &(Scene, Model), method: Method, watched: &mut Watched) -> HistoryOutcome {
    let (problem, loading) = (&model.problem, &model.loading);
    let settings = HistorySettings::new(problem, loading, method).unwrap();
    let system = LinearAlgebra::condensed().into();
    history::run(problem, loading, &scene.time.all(), &settings, system, watched).unwrap()
}

fn counts(records: &[IncrementRecord]) -> Vec<(usize, Status, usize, usize, Vec<f64>)> {
    let of = |r: &IncrementRecord| (r.index, r.status, r.iterations, r.contact.slip, r.part_ends.clone());
    records.iter().map(of).collect()
}

#[test]
fn together_they_are_what_each_is_alone() {
    let cube = include_str!("../../data/scenes/cube.toml");
    let cycles = include_str!("../../data/scenes/cycles.toml");
    let second = ["mesh.elements=[6,5]", "mesh.cells='triangle6'", "time.increments=30", "solver.setting='default'"];
    for (name, scene) in [
        ("block", scene(BLOCK, &["mesh.elements=[10,10]", "solver.setting='default'"])),
        ("second order", scene(BLOCK, &second)),
        ("cube", scene(cube, &["mesh.elements=[4,4,4]", "time.increments=12"])),
        ("cycles", scene(cycles, &["mesh.elements=[8,4]"])),
    ] {
        for method in [Method::BN, Method::IP] {
            let (mut alone, mut together) = (Watched::new(|_| true), Watched::new(|_| false));
            let [a, b] = [&mut alone, &mut together].map(|watched| run(&scene, method, watched));
            assert_eq!((a.status, b.status), (Status::Converged, Status::Converged), "{name}");
            assert_eq!(counts(&a.records), counts(&b.records), "{name}");
            let apart = difference(&alone.states, &together.states);
            assert!(apart < 1e-11, "{name}, {method}: {apart:e}");
            // One that is taken back starts without the factors of those after it, and ends with other rounding.
            for (a, b) in [(a.scales.force, b.scales.force), (a.scales.length, b.scales.length)] {
                assert!((a - b).abs() <= 1e-11 * a, "{name}: {a} {b}");
            }
            assert!(b.records.iter().all(|record| record.kkt.worst().1 <= 1e-10), "{name}");
            // Alone, nothing is solved before the increment is told; together, up to sixteen are.
            assert!(alone.ahead.iter().enumerate().all(|(k, ahead)| *ahead == k + 1), "{name}");
            let most = together.ahead.iter().enumerate().map(|(k, ahead)| ahead - k).max().unwrap();
            assert!((3..=16).contains(&most), "{name}: {most}");
            // The work is that of each: nothing is counted twice or left out.
            let sum = |outcome: &HistoryOutcome| outcome.records.iter().map(|record| record.friction_work).sum::<f64>();
            assert!((sum(&a) - sum(&b)).abs() <= 1e-10 * sum(&a).abs(), "{name}");
        }
    }
}

#[test]
fn what_is_waited_for_is_told_before_the_next() {
    let scene = scene(BLOCK, &["mesh.elements=[8,8]", "solver.setting='default'"]);
    let mut watched = Watched::new(|index| index % 7 == 0 || index == 20);
    assert_eq!(run(&scene, Method::BN, &mut watched).status, Status::Converged);
    for index in [7, 14, 20, 21, 28, 35] {
        assert_eq!(watched.ahead[index - 1], index);
    }
    assert!(watched.ahead.iter().enumerate().any(|(k, ahead)| *ahead > k + 2), "{:?}", watched.ahead);
}

/// In slender bodies each state is refined, and the next starts from there.
#[test]
fn bodies_that_need_refinement_go_one_by_one() {
    let strip = [
        "mesh.size=[10.0,0.1]",
        "mesh.elements=[200,2]",
        "time.increments=10",
        "contact.obstacle.gap=0.1",
        "solver.setting='default'",
    ];
    let strip = scene(BLOCK, &[&strip[..], &["load[0].traction=[0,-2e4]", "load[1].traction=[-1e5,0]"]].concat());
    let (mut alone, mut together) = (Watched::new(|_| true), Watched::new(|_| false));
    let [a, b] = [&mut alone, &mut together].map(|watched| run(&strip, Method::BN, watched));
    assert_eq!(a.status, b.status);
    assert_eq!(counts(&a.records), counts(&b.records));
    assert!(b.linear.worst_backward_error <= 1e-13, "{:e}", b.linear.worst_backward_error);
    assert!(difference(&alone.states, &together.states) < 1e-9);
}

/// A load that nothing balances comes in the middle of a bundle: what was before it stays.
#[test]
fn a_failure_ends_where_it_would_alone() {
    let histories = ["load[0].history=[[0,0],[1,1],[1.3,-50]]", "load[1].history=[[0,0],[1,1],[2,0]]"];
    let limit = ["mesh.elements=[8,8]", "solver.setting='default'"];
    let sound = scene(BLOCK, &[&limit[..], &histories[..]].concat());
    let few = |watched: &mut Watched| {
        let (problem, loading) = (&sound.1.problem, &sound.1.loading);
        // Two iterations are enough for most increments, and not for all.
        let settings = HistorySettings::new(problem, loading, Method::Bn { r_factor: 1.0, rescue: false }).unwrap();
        let settings = HistorySettings { halvings: 1, ..settings.until(2, 1e-10) };
        let times: Vec<f64> = (1..=60).map(|k| f64::from(k) / 60.0).collect();
        history::run(problem, loading, &times, &settings, LinearAlgebra::condensed().into(), watched).unwrap()
    };
    let (mut alone, mut together) = (Watched::new(|_| true), Watched::new(|_| false));
    let [a, b] = [&mut alone, &mut together].map(few);
    assert_eq!((a.status, a.reached), (b.status, b.reached));
    assert_eq!(counts(&a.records), counts(&b.records));
    assert_eq!(alone.states.len(), together.states.len());
}

#[test]
fn interruptions_keep_what_is_solved() {
    let scene = scene(BLOCK, &["mesh.elements=[8,8]", "solver.setting='default'"]);
    let mut watched = Watched { stops_in: 13, ..Watched::new(|_| false) };
    let outcome = run(&scene, Method::BN, &mut watched);
    assert_eq!((outcome.status, outcome.records.len()), (Status::Interrupted, 13));
    assert!(outcome.records[..12].iter().all(|record| record.status == Status::Converged));
    assert_eq!(outcome.reached, outcome.records[11].time);
    let mut watched = Watched { stops_after: 13, ..Watched::new(|_| false) };
    let outcome = run(&scene, Method::BN, &mut watched);
    assert_eq!((outcome.status, outcome.records.len()), (Status::Interrupted, 13));
    assert_eq!((outcome.reached, watched.states.len()), (outcome.records[12].time, 13));
}

/// BN whose linear algebra cannot go on in one increment, the first time that it is solved.
struct Failing {
    settings: HistorySettings,
    /// Increments still to be solved before that.
    left: Rc<Cell<usize>>,
    error: LinearError,
}

impl Algorithm for Failing {
    fn start(&self, problem: &ContactProblem, loading: &Loading) -> Box<dyn IncrementSolver> {
        let (left, error) = (Rc::clone(&self.left), self.error.clone());
        around(self.settings.start(problem, loading), move |inner, task, linear, observe| {
            let fails = left.get() == 0;
            left.set(left.get().wrapping_sub(1));
            if fails { Err(error.clone()) } else { inner.solve(task, linear, observe) }
        })
    }
}

/// An error of the linear solver in the middle of a batch is reported after the increments before it are judged, as if each were solved
/// alone. The failed increment is not repeated until it happens to succeed.
#[test]
fn an_error_ahead_is_told_after_what_is_before_it() {
    let (scene, model) = scene(BLOCK, &["mesh.elements=[8,8]", "solver.setting='default'"]);
    let (problem, loading, times) = (&model.problem, &model.loading, scene.time.all());
    let settings = HistorySettings::new(problem, loading, Method::BN).unwrap();
    let run = |before: usize, error: &LinearError, waits: fn(usize) -> bool| {
        let failing = Failing { settings: settings.clone(), left: Rc::new(Cell::new(before)), error: error.clone() };
        let (system, mut watched) = (LinearAlgebra::condensed().into(), Watched::new(waits));
        let outcome = history::run_with(problem, loading, &times, &failing, &settings, system, &mut watched);
        (outcome, watched.states.len())
    };
    let memory = LinearError::OutOfMemory { step: "the factorisation" };
    let other = LinearError::Backend { backend: "mine", step: "the factorisation", status: -1 };
    for before in [0, 1, 2, 4, 5, 8, 12] {
        for waits in [|_| true, |_| false] {
            let (outcome, told) = run(before, &memory, waits);
            let outcome = outcome.unwrap();
            assert_eq!((outcome.status, outcome.records.len(), told), (Status::OutOfMemory, before, before));
            let (outcome, told) = run(before, &other, waits);
            assert_eq!((outcome.unwrap_err(), told), (Error::Linear(other.clone()), before));
        }
    }
}
