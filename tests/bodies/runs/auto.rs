//! The linear algebra that is chosen where a scene leaves it open.

use crate::common::block;
use crate::common::prelude::*;
use stickslip::run::{AvailableSolvers, Choice, Done, Unsuited, unsuited};
use stickslip::solver::InitialWorkingSet;

const STRIP: [&str; 2] = ["mesh.size=[1000,4]", "mesh.elements=[1000,4]"];

fn scene(overrides: &[&str]) -> (Scene, Model) {
    let scene = block(&[overrides, &["solver.linear=\"auto\""]].concat());
    let model = discretise(&scene).unwrap();
    (scene, model)
}

fn cheapest(scene: &Scene, model: &Model, available: Option<u64>) -> Choice {
    let means = AvailableSolvers { available, multigrid: false, ranks: 1 };
    Choice::cheapest(&model.problem, &InitialWorkingSet::default(), scene.solver.method, scene.time.increments, means)
        .unwrap()
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
        assert!(!strip.linear.condenses(), "{:?}", strip.reason());
    }
}

#[test]
fn cubes_are_condensed_and_the_thinnest_plate_is_not() {
    let text = CUBE;
    for (elements, size, expected) in
        [("[8,8,8]", "[1,1,1]", true), ("[16,16,4]", "[1,1,0.25]", true), ("[32,32,2]", "[1,1,0.0625]", false)]
    {
        let overrides = [format!("mesh.elements={elements}"), format!("mesh.size={size}")];
        let overrides = overrides.iter().map(String::as_str).chain(["solver.linear=\"auto\""]);
        let overrides: Vec<_> = overrides.map(|text| text.parse().unwrap()).collect();
        let scene = Scene::parse("cube.toml", text, &overrides).unwrap();
        let choice = cheapest(&scene, &discretise(&scene).unwrap(), None);
        assert_eq!(choice.linear.condenses(), expected, "{elements}: {:?}", choice.reason());
    }
}

#[test]
fn the_reason_is_told() {
    let reason = choice(&["mesh.elements=[40,40]"], None).reason().unwrap();
    let other = format!("for {}", LinearAlgebra::default());
    for part in ["condensed (estimated ", " s against ", &other] {
        assert!(reason.contains(part), "{part}: {reason}");
    }
    let named = block(&["mesh.elements=[5,5]", "solver.linear=\"condensed\""]);
    let run = Run::new(&named).unwrap();
    let choice = run.choice();
    assert_eq!((choice.linear, choice.reason()), (LinearAlgebra::condensed(), None));
}

/// A run that took long is told which linear algebra is much faster, unless the program chose. A short run is not worth the estimate.
#[test]
fn a_much_faster_linear_algebra_is_named() {
    let (_, model) = scene(&["mesh.elements=[60,60]"]);
    let faster = |choice: &Choice, seconds: f64| {
        let done = Done { increments: 40, factorizations: 250, seconds };
        let means = AvailableSolvers { available: None, multigrid: false, ranks: 1 };
        choice.faster(&model.problem, &InitialWorkingSet::default(), Method::default().into(), means, &done).unwrap()
    };
    let whole = Choice::named(LinearAlgebra::default());
    let condensed = faster(&whole, 1e3).unwrap();
    assert_eq!(condensed.solver, LinearAlgebra::condensed());
    assert!(condensed.here_seconds > 3.0 * condensed.seconds, "{condensed}");
    assert!(condensed.to_string().contains("solver.linear = \"auto\" chooses the faster"), "{condensed}");
    assert_eq!(faster(&whole, 1e-3), None);
    assert_eq!(faster(&Choice::named(LinearAlgebra::condensed()), 1e3), None);
    assert_eq!(faster(&choice(&["mesh.elements=[60,60]"], None), 1e3), None);
}

#[test]
fn what_memory_does_not_hold_is_not_chosen() {
    let whole = choice(&["mesh.elements=[40,40]"], None);
    let takes = |linear| whole.paths().iter().find(|path| path.linear == linear).unwrap().cost.bytes;
    let (more, less) = (takes(LinearAlgebra::default()), takes(LinearAlgebra::condensed()));
    assert!(more > less);
    // The faster one of those that have room, and where none has, the least.
    for (available, room) in [(more, 2), (less, 1), (0.9 * less, 0)] {
        let choice = choice(&["mesh.elements=[40,40]"], Some(available.ceil() as u64));
        assert_eq!(choice.linear, LinearAlgebra::condensed());
        let reason = choice.reason().unwrap();
        assert_eq!(reason.contains(" would take more memory than the "), room < 2, "{reason}");
        assert_eq!(reason.contains("; condensed ") || reason.contains(" and condensed "), room == 0, "{reason}");
    }
    let strip = choice(&[&STRIP[..], &["time.increments=2"]].concat(), Some(1000));
    let (least, others) = strip.paths().split_first().unwrap();
    let least = others.iter().fold(least, |least, path| if path.cost.bytes < least.cost.bytes { path } else { least });
    assert_eq!(strip.linear, least.linear);
}

/// Multigrid is told where it belongs, whatever this build has.
#[test]
fn who_multigrid_is_for() {
    let built_in = LinearAlgebra::Multigrid.is_built_in();
    let of = |overrides: &[&str], method: Method| {
        let text = CUBE;
        unsuited(&discretise(&parsed_with(text, overrides)).unwrap(), method.into())
    };
    let small = "mesh.elements=[3,3,3]";
    assert_eq!(of(&[small], Method::BN), (!built_in).then_some(Unsuited::NotBuiltIn));
    assert_eq!(of(&[small], Method::Ip), Some(Unsuited::Method));
    assert_eq!(of(&[small, "material.poisson=0.46"], Method::BN), Some(Unsuited::NearlyIncompressible(0.46)));
    let reason = of(&[small, "mesh.size=[1,1,0.03]"], Method::BN).unwrap().to_string();
    assert_eq!(reason, "the longest distance between corners of an element is 47 times the shortest");
    assert_eq!(unsuited(&scene(&["mesh.elements=[3,3]"]).1, Method::BN.into()), Some(Unsuited::Plane));
}

#[test]
fn without_contact_any_choice_solves() {
    let text = BLOCK;
    let (contact, load) = (text.find("[[contact]]").unwrap(), text.find("[[load]]").unwrap());
    let scene =
        parsed_with(&[&text[..contact], &text[load..]].concat(), &["mesh.elements=[4,4]", "solver.linear=\"auto\""]);
    let model = discretise(&scene).unwrap();
    let choice = cheapest(&scene, &model, None);
    assert_eq!(run(&scene, &model, choice.linear).0.status, Status::Converged);
}

fn run(scene: &Scene, model: &Model, backend: LinearAlgebra) -> (HistoryOutcome, Vec<State>) {
    let settings = settings_of(model, Method::BN).until(100, 1e-10);
    let (outcome, keep) = recorded(model, &scene.time.all(), &settings, backend);
    (outcome, keep.states)
}

/// Whatever is chosen, the other way has the same solution.
#[test]
fn both_ways_have_the_same_result() {
    for (overrides, expected) in
        [(&["mesh.elements=[30,30]"][..], true), (&["mesh.elements=[300,2]", "mesh.size=[300,2]"], false)]
    {
        let (scene, model) = scene(&[overrides, &["time.increments=2"]].concat());
        assert_eq!(cheapest(&scene, &model, None).linear.condenses(), expected);
        let [(whole, whole_states), (condensed, condensed_states)] = both().map(|backend| run(&scene, &model, backend));
        assert_eq!((whole.status, condensed.status), (Status::Converged, Status::Converged));
        for (a, b) in whole_states.iter().zip(&condensed_states) {
            assert!(apart(&b.p_n, &a.p_n) <= 1e-9, "{overrides:?}: {:e}", apart(&b.p_n, &a.p_n));
        }
    }
}
