//! Whole histories, condensed and not: the same statuses, the same counts, the same states.

use crate::common::prelude::*;

struct History {
    name: String,
    model: Model,
    times: Vec<f64>,
}

fn history(name: &str, scene: &Scene) -> History {
    History { name: name.to_string(), model: discretise(scene).unwrap(), times: scene.time.all() }
}

fn histories() -> Vec<History> {
    let block = |mu: f64| {
        let scene = common::block(&["mesh.elements=[20,20]", "time.increments=20", &format!("contact.friction={mu}")]);
        history(&format!("block, mu = {mu}"), &scene)
    };
    let punch = parsed_with(PUNCH, &["time.increments=5"]);
    // Slender: held at one end, so the load is small and the gap large.
    let strip = common::block(&[
        "mesh.size=[10.0,0.2]",
        "mesh.elements=[200,4]",
        "time.increments=10",
        "contact.obstacle.gap=1e-4",
        "load[0].traction=[0.0,-1e6]",
        "load[1].traction=[-1e6,0.0]",
    ]);
    [0.0, 0.4, 0.8].map(block).into_iter().chain([history("punch", &punch), history("strip", &strip)]).collect()
}

fn run(history: &History, settings: &HistorySettings, backend: LinearAlgebra) -> (HistoryOutcome, Keep) {
    let History { model, times, .. } = history;
    let (linear, mut keep) = (SystemSolver::from(backend), Keep::default());
    let outcome = history::run(&model.problem, &model.loading, times, settings, linear, &mut keep).unwrap();
    (outcome, keep)
}

fn backends_agree(settings: fn(&Model) -> HistorySettings) {
    for history in histories() {
        let by_both = |settings: &HistorySettings| both().map(|backend| run(&history, settings, backend));
        let name = &history.name;
        // The strip with its nodes kept open, to find a first touch, is a beam: rounding tells its iterations.
        let [whole, condensed] = by_both(&settings(&history.model));
        let found = difference(&whole.1.states, &condensed.1.states);
        assert!(found <= 1e-10, "{name}, divided at touches: {found:e}");
        let [whole, condensed] = by_both(&HistorySettings { halvings: 0, ..settings(&history.model) });
        // Which nodes stick is not compared: in the strip some have next to no friction force and next
        // to no slip, and rounding tells which of the two is the larger.
        let counts = |outcome: &HistoryOutcome| {
            outcome.records.iter().map(|r| (r.status, r.iterations, r.backtracks, r.contact.open)).collect::<Vec<_>>()
        };
        assert_eq!(whole.0.status, Status::Converged, "{name}");
        assert_eq!((whole.0.status, counts(&whole.0)), (condensed.0.status, counts(&condensed.0)), "{name}");
        let found = difference(&whole.1.states, &condensed.1.states);
        assert!(found <= 1e-10, "{name}: {found:e}");
        let error = condensed.0.linear.worst_backward_error;
        assert!(error <= 1e-14, "{name}: {error:e}");
    }
}

#[test]
fn with_bn_as_in_the_paper() {
    backends_agree(|model| {
        HistorySettings::new(&model.problem, &model.loading, Method::PaperBn).unwrap().until(200, 1e-8)
    });
}

#[test]
fn with_bn() {
    backends_agree(|model| HistorySettings::new(&model.problem, &model.loading, Method::BN).unwrap().until(200, 1e-10));
}

#[test]
fn with_ip() {
    backends_agree(|model| HistorySettings::new(&model.problem, &model.loading, Method::Ip).unwrap().until(200, 1e-10));
}
