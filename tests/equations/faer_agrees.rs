//! faer's LU in the place of UMFPACK changes neither a status nor a count, and states by rounding only.

#![cfg(all(feature = "umfpack", feature = "faer"))]

use crate::common::prelude::*;

type Settings = fn(&Model) -> HistorySettings;

fn paper_bn(model: &Model) -> HistorySettings {
    settings_of(model, Method::PaperBn).until(200, 1e-10)
}

fn bn(model: &Model) -> HistorySettings {
    settings_of(model, Method::BN).until(200, 1e-10)
}

fn ip(model: &Model) -> HistorySettings {
    settings_of(model, Method::Ip).until(100, 1e-10)
}

fn run(scene: &Scene, settings: Settings, backend: LinearAlgebra) -> (Vec<State>, HistoryOutcome) {
    let model = discretise(scene).unwrap();
    let (outcome, keep) = recorded(&model, &scene.time.all(), &settings(&model), backend);
    (keep.states, outcome)
}

fn assert_agree(scene: &Scene, name: &str) {
    for (method, settings) in [("bn paper", paper_bn as Settings), ("bn", bn), ("ip", ip)] {
        let [(a, umfpack), (b, faer)] = [LinearAlgebra::Whole(SparseLu::Umfpack), LinearAlgebra::Whole(SparseLu::Faer)]
            .map(|backend| run(scene, settings, backend));
        let counts = |outcome: &HistoryOutcome| -> Vec<_> {
            outcome.records.iter().map(|record| (record.status, record.iterations)).collect()
        };
        assert_eq!((umfpack.status, faer.status), (Status::Converged, Status::Converged), "{name}, {method}");
        assert_eq!(counts(&umfpack), counts(&faer), "{name}, {method}");
        let found = difference(&a, &b);
        assert!(found <= 1e-10, "{name}, {method}: {found:e}");
        let error = faer.linear.worst_backward_error;
        assert!(error <= 1e-14, "{name}, {method}: backward error {error:e}");
        assert_eq!((faer.linear.analyses, faer.linear.solves), (umfpack.linear.analyses, umfpack.linear.solves));
    }
}

#[test]
fn on_the_block() {
    for mu in [0.0, 0.4, 0.8] {
        let friction = format!("contact.friction={mu}");
        let scene = common::block(&["mesh.elements=[20,20]", "time.increments=10", &friction]);
        assert_agree(&scene, &format!("block, mu = {mu}"));
    }
}

#[test]
fn on_the_punch() {
    let overrides = ["time.increments=5".parse().unwrap()];
    let scene = Scene::parse("punch.toml", PUNCH, &overrides).unwrap();
    assert_agree(&scene, "punch");
}
