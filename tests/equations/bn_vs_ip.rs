//! BN and the interior point methods find the same states: independent algorithms on the same law.

use crate::common::prelude::*;

fn block(n: usize, mu: f64, increments: usize) -> (Model, Vec<f64>) {
    let overrides =
        [format!("mesh.elements=[{n},{n}]"), format!("contact.friction={mu}"), format!("time.increments={increments}")];
    let overrides: Vec<&str> = overrides.iter().map(String::as_str).collect();
    let scene = common::block(&overrides);
    (discretise(&scene).unwrap(), scene.time.all())
}

fn punch(increments: usize) -> (Model, Vec<f64>) {
    let overrides = [format!("time.increments={increments}").parse().unwrap()];
    let scene = Scene::parse("punch.toml", PUNCH, &overrides).unwrap();
    (discretise(&scene).unwrap(), scene.time.all())
}

/// The states at the end of all increments, which have to converge.
fn states((model, times): &(Model, Vec<f64>), settings: &HistorySettings) -> (Vec<State>, HistoryOutcome) {
    let mut keep = Keep::default();
    let linear = SystemSolver::from(LinearAlgebra::condensed());
    let outcome = history::run(&model.problem, &model.loading, times, settings, linear, &mut keep).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    (keep.states, outcome)
}

fn bn(model: &Model) -> HistorySettings {
    settings_of(model, Method::PaperBn).until(200, 1e-10)
}

fn ip(model: &Model) -> HistorySettings {
    let settings = settings_of(model, Method::Ip).until(100, 1e-10);
    // The setting of the paper divides no increment.
    HistorySettings { halvings: 0, ..settings }
}

#[test]
fn the_block() {
    for (n, increments) in [(5, 10), (10, 10), (20, 10), (50, 4), (100, 2)] {
        for mu in [0.1, 0.4, 0.8] {
            let case = block(n, mu, increments);
            let found = difference(&states(&case, &bn(&case.0)).0, &states(&case, &ip(&case.0)).0);
            assert!(found <= 1e-8, "n = {n}, mu = {mu}: {found:e}");
        }
    }
}

#[test]
fn the_punch() {
    for increments in [1, 5, 20] {
        let case = punch(increments);
        let found = difference(&states(&case, &bn(&case.0)).0, &states(&case, &ip(&case.0)).0);
        assert!(found <= 1e-8, "{increments} increments: {found:e}");
    }
}

/// The paper's IP ends at Theta ≤ 0.01, which leaves more.
#[test]
fn the_papers_ip_within_its_stop() {
    for case in [block(10, 0.4, 10), block(20, 0.8, 10), punch(2)] {
        let paper = HistorySettings::new(&case.0.problem, &case.0.loading, Method::paper_ip(Start::Safe))
            .unwrap()
            .until(200, 1e-6);
        let found = difference(&states(&case, &bn(&case.0)).0, &states(&case, &paper).0);
        assert!(found <= 1e-6, "{found:e}");
    }
}
