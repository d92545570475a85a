//! A chain of single increments is the history.

use crate::common::prelude::*;
use stickslip::algebra::linear::Statistics;
use stickslip::solver::history::{Error, Stepper};

fn model() -> (Model, Vec<f64>) {
    let scene = parsed_with(BLOCK, &["mesh.elements=[8,8]", "time.increments=8"]);
    (discretise(&scene).unwrap(), scene.time.all())
}

fn history(model: &Model, times: &[f64], settings: &HistorySettings, linear: LinearAlgebra) -> Recording {
    let mut all = Recording::all();
    let outcome = history_of(model, times, settings, linear, &mut all);
    assert_eq!(outcome.status, Status::Converged);
    all
}

/// The loads of an increment and no others: the force then and now, as a coupling would hand it over.
fn between(model: &Model, from: f64, to: f64) -> Loading {
    let ends = [(from, [[from, 1.0], [to, 0.0]]), (to, [[from, 0.0], [to, 1.0]])];
    let case = |(time, factor): (f64, [[f64; 2]; 2])| {
        LoadCase::new(model.loading.force_at(time, &model.problem).unwrap(), factor.to_vec()).unwrap()
    };
    Loading::new(ends.map(case).to_vec(), model.loading.gaps_at(0.0)).unwrap()
}

fn built_in() -> impl Iterator<Item = LinearAlgebra> {
    LinearAlgebra::WORDS.into_iter().map(|(_, linear)| linear).filter(|linear| linear.is_built_in())
}

/// The largest difference of displacements, or of normal forces.
fn distance(a: &State, b: &State) -> f64 {
    apart(&a.u, &b.u).max(apart(&a.p_n, &b.p_n))
}

/// Passes with the model, its times and the settings of each method, with every linear algebra of this build.
fn with_all(methods: &[Method], test: impl Fn(&Model, &[f64], &HistorySettings, LinearAlgebra)) {
    let (model, times) = model();
    for method in methods {
        let settings = settings_of(&model, *method);
        built_in().for_each(|linear| test(&model, &times, &settings, linear));
    }
}

#[test]
fn under_the_loads_of_the_history_single_increments_are_those_of_the_history_to_the_last_bit() {
    with_all(&[Method::BN, Method::PaperBn, Method::Ip], |model, times, settings, linear| {
        let whole = history(model, times, settings, linear);
        let mut stepper = Stepper::new(&model.problem, settings.clone(), linear.into()).unwrap();
        for (time, expected) in times.iter().zip(&whole.increments) {
            let mut one = Recording::all();
            let outcome = stepper.step(&model.loading, *time, &mut one).unwrap();
            let [one] = &one.increments[..] else { panic!("{} increments", one.increments.len()) };
            assert_eq!(one.state, expected.state, "{} {linear} at {time}", settings.method);
            assert_eq!(one.record.kkt, expected.record.kkt);
            assert_eq!((one.record.index, one.record.iterations), (expected.record.index, expected.record.iterations));
            assert_eq!((outcome.reached, outcome.tally.increments), (*time, expected.record.index));
        }
    });
}

#[test]
fn an_increment_needs_the_loads_of_its_two_ends_only() {
    with_all(&[Method::BN], |model, times, settings, linear| {
        let whole = history(model, times, settings, linear);
        let mut stepper = Stepper::new(&model.problem, settings.clone(), linear.into()).unwrap();
        for (time, expected) in times.iter().zip(&whole.increments) {
            let state = stepper.step(&between(model, stepper.time(), *time), *time, &mut ()).unwrap().state;
            let error = distance(&state, &expected.state);
            assert!(error < 1e-12, "{linear} at {time}: {error:e}");
        }
    });
}

/// A step needs the factorisations of an increment of a history and no others, with the loads of the history and with new nodal forces
/// in each step.
#[test]
fn a_step_costs_what_an_increment_of_a_history_costs() {
    let (model, times) = model();
    // Each increment as it stands.
    let settings = HistorySettings { halvings: 0, ..settings_of(&model, Method::BN) };
    for linear in built_in() {
        let (problem, loading) = (&model.problem, &model.loading);
        let whole = history::run(problem, loading, &times, &settings, linear.into(), &mut ()).unwrap().linear;
        for own_loads in [false, true] {
            let mut stepper = Stepper::new(problem, settings.clone(), linear.into()).unwrap();
            let step = |time: &f64| {
                let loads = if own_loads { between(&model, stepper.time(), *time) } else { loading.clone() };
                stepper.step(&loads, *time, &mut ()).unwrap().linear
            };
            let steps = times.iter().map(step).last().unwrap();
            let counts = |done: Statistics| [done.analyses, done.factorizations, done.solves];
            let [expected, found] = [counts(whole), counts(steps)];
            // The first step has the response to one more load.
            let solves = expected[2]..=expected[2] + usize::from(own_loads);
            assert!(
                found[..2] == expected[..2] && solves.contains(&found[2]),
                "{linear} {own_loads}: {found:?} {expected:?}"
            );
        }
    }
}

#[test]
fn the_pattern_is_analysed_once() {
    let (model, times) = model();
    let settings = settings_of(&model, Method::BN);
    let mut stepper = Stepper::new(&model.problem, settings, LinearAlgebra::default().into()).unwrap();
    let outcomes: Vec<_> = times.iter().map(|t| stepper.step(&model.loading, *t, &mut ()).unwrap()).collect();
    assert_eq!(outcomes.last().map(|outcome| outcome.linear.analyses), Some(1));
}

#[test]
fn an_increment_that_failed_is_tried_again_from_where_the_last_one_ended() {
    let (model, times) = model();
    let settings = settings_of(&model, Method::BN);
    let short = HistorySettings { halvings: 0, ..settings.clone() };
    for linear in built_in() {
        let expected = history(&model, &times[..2], &short, linear);
        let mut stepper = Stepper::new(&model.problem, short.clone(), linear.into()).unwrap();
        assert_eq!(stepper.step(&model.loading, times[0], &mut ()).unwrap().status, Status::Converged);
        // Forces beyond all numbers leave nothing to go on from.
        let torn = Loading::new(
            vec![LoadCase::new(vec![1e308; model.problem.displacements()], vec![]).unwrap()],
            model.loading.gaps_at(0.0),
        )
        .unwrap();
        let failed = stepper.step(&torn, times[1], &mut ());
        assert!(failed.is_ok_and(|outcome| outcome.status != Status::Converged));
        assert_eq!(stepper.time(), times[0]);
        assert!(matches!(stepper.step(&model.loading, times[0], &mut ()), Err(Error::Problem(_))));
        let again = stepper.step(&model.loading, times[1], &mut ()).unwrap();
        assert_eq!(again.state, expected.increments[1].state, "{linear}");
    }
}

/// Also from the undeformed body, and after several increments that are taken back.
#[test]
fn increments_that_were_taken_back_leave_nothing_behind() {
    with_all(&[Method::BN, Method::PaperBn, Method::Ip], |model, times, settings, linear| {
        let whole = history(model, times, settings, linear);
        let mut stepper = Stepper::new(&model.problem, settings.clone(), linear.into()).unwrap();
        for (time, expected) in times.iter().zip(&whole.increments) {
            let (before, begun) = (stepper.save(), stepper.time());
            for _ in 0..2 {
                // Other loads, and two increments of them.
                stepper.step(&between(model, begun, time + 0.5), time + 0.5, &mut ()).unwrap();
                stepper.step(&model.loading, time + 1.0, &mut ()).unwrap();
                stepper.restore(&before).unwrap();
                assert_eq!(stepper.time().to_bits(), begun.to_bits());
            }
            let mut one = Recording::all();
            let outcome = stepper.step(&model.loading, *time, &mut one).unwrap();
            assert_eq!(outcome.tally.increments, expected.record.index);
            let error = distance(&one.increments[0].state, &expected.state);
            assert!(error < 1e-10, "{} {linear} at {time}: {error:e}", settings.method);
        }
    });
}
