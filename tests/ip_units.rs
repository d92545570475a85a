//! The default interior point method in other units: the same counts, the same states.
#![allow(clippy::unwrap_used)]

mod common;

use common::Keep;
use stickslip::history::{self, HistorySettings, Status};
use stickslip::linear::{Direct, Umfpack};
use stickslip::loading::Loading;
use stickslip::model::Model;
use stickslip::problem::ContactProblem;
use stickslip::scene::Scene;
use stickslip::units::Scaling;

/// Iterations and statuses of every increment, and p_n, p_t, u of the last.
fn run(problem: &ContactProblem, loading: &Loading, times: &[f64], scaling: Scaling) -> (Vec<String>, [Vec<f64>; 3]) {
    let settings = HistorySettings::ip(problem, scaling, 100, 1e-10);
    let mut linear = Direct::new(Box::new(Umfpack::default()));
    let mut keep = Keep::default();
    let outcome = history::run(problem, loading, times, &settings, &mut linear, &mut keep).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    let counts = outcome.records.iter().map(|record| format!("{} {:?}", record.iterations, record.contact));
    (counts.collect(), [outcome.state.p_n, outcome.state.p_t, outcome.state.u])
}

/// The problem with forces and lengths in units of `force` (N) and `length` (m).
fn expressed(model: &Model, force: f64, length: f64) -> (ContactProblem, Loading) {
    let (mut problem, mut loading) = (model.problem.clone(), model.loading.clone());
    problem.stiffness.scale(length / force);
    problem.weight.iter_mut().for_each(|l| *l /= length);
    loading.gap.iter_mut().for_each(|gap| *gap /= length);
    for approach in &mut loading.approaches {
        approach.history.iter_mut().for_each(|point| point[1] /= length);
    }
    for case in &mut loading.cases {
        case.force.iter_mut().for_each(|f| *f /= force);
    }
    (problem, loading)
}

fn assert_close(name: &str, found: &[f64], expected: &[f64], unit: f64) {
    let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (x, y) in found.iter().zip(expected) {
        assert!((x * unit - y).abs() <= 1e-9 * largest, "{name}: {} {y}", x * unit);
    }
}

fn cases() -> Vec<(Model, Vec<f64>)> {
    let blocks = [(5, 0.1, 10), (10, 0.8, 10), (20, 0.4, 10), (20, 0.8, 2)].map(|(n, mu, increments)| {
        let overrides = [
            format!("mesh.elements=[{n},{n}]"),
            format!("contact.friction={mu}"),
            format!("time.increments={increments}"),
        ];
        common::block(&overrides.each_ref().map(String::as_str))
    });
    let punches = [1, 5].map(|increments| {
        let overrides = [format!("time.increments={increments}").parse().unwrap()];
        Scene::parse("punch.toml", include_str!("../data/scenes/punch.toml"), &overrides).unwrap()
    });
    blocks.into_iter().chain(punches).map(|scene| (Model::new(&scene).unwrap(), scene.time.all())).collect()
}

/// The numbers inside: SI, MN and 1e-5 m, N and mm.
#[test]
fn units_inside() {
    for (model, times) in cases() {
        let (counts, state) = run(&model.problem, &model.loading, &times, model.scaling());
        for scaling in [Scaling::SI, Scaling { force: 1e6, length: 1e-5 }, Scaling { force: 1.0, length: 1e-3 }] {
            let (other_counts, other) = run(&model.problem, &model.loading, &times, scaling);
            assert_eq!(counts, other_counts, "{scaling:?}");
            for (found, expected) in other.iter().zip(&state) {
                assert_close(&format!("{scaling:?}"), found, expected, 1.0);
            }
        }
    }
}

/// The numbers outside: the same problem written in MN and 1e-5 m, in N and mm, in odd units.
#[test]
fn units_outside() {
    for (model, times) in cases() {
        let (counts, [p_n, p_t, u]) = run(&model.problem, &model.loading, &times, model.scaling());
        for (force, length) in [(1e6, 1e-5), (1.0, 1e-3), (3.7e-4, 0.3048)] {
            let (problem, loading) = expressed(&model, force, length);
            let scaling = problem.scaling(loading.largest_force(), loading.largest_interference());
            let (other_counts, other) = run(&problem, &loading, &times, scaling);
            assert_eq!(counts, other_counts, "{force} N, {length} m");
            for ((found, expected), unit) in other.iter().zip([&p_n, &p_t, &u]).zip([force, force, length]) {
                assert_close(&format!("{force} N, {length} m"), found, expected, unit);
            }
        }
    }
}
