//! The linear algebra that is chosen where a scene leaves it open.
#![allow(clippy::unwrap_used)]

use crate::common::{Keep, block};
use stickslip::auto::Choice;
use stickslip::history::{self, HistoryOutcome, HistorySettings, LinearAlgebra, Method, Status, System};
use stickslip::model::Model;
use stickslip::problem::State;
use stickslip::reach::Reach;
use stickslip::run::Run;
use stickslip::scene::Scene;

const STRIP: [&str; 2] = ["mesh.size=[1000,4]", "mesh.elements=[1000,4]"];

fn scene(overrides: &[&str]) -> (Scene, Model) {
    let scene = block(&[overrides, &["solver.linear=\"auto\""]].concat());
    let model = Model::new(&scene).unwrap();
    (scene, model)
}

fn cheapest(scene: &Scene, model: &Model, available: Option<u64>) -> Choice {
    Choice::cheapest(&model.problem, &Reach::default(), scene.solver.method, scene.time.increments, available).unwrap()
}

fn choice(overrides: &[&str], available: Option<u64>) -> Choice {
    let (scene, model) = scene(overrides);
    cheapest(&scene, &model, available)
}

#[test]
fn squares_are_condensed_and_strips_are_not() {
    for increments in ["time.increments=2", "time.increments=40"] {
        let square = choice(&["mesh.elements=[60,60]", increments], None);
        assert_eq!(square.linear, LinearAlgebra::condensed(), "{:?}", square.reason());
        let strip = choice(&[&STRIP[..], &[increments]].concat(), None);
        assert_eq!(strip.linear, LinearAlgebra::default(), "{:?}", strip.reason());
    }
}

#[test]
fn cubes_are_condensed_and_the_thinnest_plate_is_not() {
    let text = include_str!("../../data/scenes/cube.toml");
    for (elements, size, expected) in [
        ("[8,8,8]", "[1,1,1]", LinearAlgebra::condensed()),
        ("[16,16,4]", "[1,1,0.25]", LinearAlgebra::condensed()),
        ("[32,32,2]", "[1,1,0.0625]", LinearAlgebra::default()),
    ] {
        let overrides = [format!("mesh.elements={elements}"), format!("mesh.size={size}")];
        let overrides = overrides.iter().map(String::as_str).chain(["solver.linear=\"auto\""]);
        let overrides: Vec<_> = overrides.map(|text| text.parse().unwrap()).collect();
        let scene = Scene::parse("cube.toml", text, &overrides).unwrap();
        let choice = cheapest(&scene, &Model::new(&scene).unwrap(), None);
        assert_eq!(choice.linear, expected, "{elements}: {:?}", choice.reason());
    }
}

#[test]
fn the_reason_is_told() {
    let reason = choice(&["mesh.elements=[40,40]"], None).reason().unwrap();
    let other = format!("for {}", LinearAlgebra::default());
    for part in ["condensed (estimated ", " s against ", &other, " flops an iteration against "] {
        assert!(reason.contains(part), "{part}: {reason}");
    }
    let named = block(&["mesh.elements=[5,5]", "solver.linear=\"condensed\""]);
    let run = Run::new(&named).unwrap();
    let choice = run.choice();
    assert_eq!((choice.linear, choice.reason()), (LinearAlgebra::condensed(), None));
}

#[test]
fn what_memory_does_not_hold_is_not_chosen() {
    let short = choice(&["mesh.elements=[40,40]"], Some(1000));
    assert_eq!(short.linear, LinearAlgebra::default());
    assert!(short.reason().unwrap().contains("GB of memory"), "{:?}", short.reason());
}

#[test]
fn without_contact_any_choice_solves() {
    let text = include_str!("../../data/scenes/block.toml");
    let (contact, load) = (text.find("[[contact]]").unwrap(), text.find("[[load]]").unwrap());
    let overrides = ["mesh.elements=[4,4]", "solver.linear=\"auto\""].map(|text| text.parse().unwrap());
    let scene = Scene::parse("block.toml", &[&text[..contact], &text[load..]].concat(), &overrides).unwrap();
    let model = Model::new(&scene).unwrap();
    let choice = cheapest(&scene, &model, None);
    assert_eq!(run(&scene, &model, choice.linear).0.status, Status::Converged);
}

fn run(scene: &Scene, model: &Model, backend: LinearAlgebra) -> (HistoryOutcome, Vec<State>) {
    let settings = HistorySettings::new(&model.problem, &model.loading, Method::BN).unwrap().until(100, 1e-10);
    let (linear, mut keep) = (System::from(backend), Keep::default());
    let times = scene.time.all();
    let outcome = history::run(&model.problem, &model.loading, &times, &settings, linear, &mut keep).unwrap();
    (outcome, keep.states)
}

/// Whatever is chosen, the other way has the same solution.
#[test]
fn both_ways_have_the_same_result() {
    for (overrides, expected) in [
        (&["mesh.elements=[30,30]"][..], LinearAlgebra::condensed()),
        (&["mesh.elements=[300,2]", "mesh.size=[300,2]"], LinearAlgebra::default()),
    ] {
        let (scene, model) = scene(&[overrides, &["time.increments=2"]].concat());
        let chosen = cheapest(&scene, &model, None).linear;
        assert_eq!(chosen, expected);
        let [(whole, whole_states), (condensed, condensed_states)] =
            [LinearAlgebra::default(), LinearAlgebra::condensed()].map(|backend| run(&scene, &model, backend));
        assert_eq!((whole.status, condensed.status), (Status::Converged, Status::Converged));
        for (a, b) in whole_states.iter().zip(&condensed_states) {
            let largest = a.p_n.iter().fold(0.0_f64, |m, p| m.max(*p));
            let worst = a.p_n.iter().zip(&b.p_n).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            assert!(worst <= 1e-9 * largest, "{overrides:?}: {worst:e} against {largest:e}");
        }
    }
}
