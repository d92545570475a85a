//! The linear algebra that is chosen where a scene leaves it open.

use crate::common::block;
use crate::common::prelude::*;
use stickslip::run::{AvailableSolvers, Choice, MemoryEstimate, Unsuited, unsuited};
use stickslip::solver::InitialWorkingSet;

const STRIP: [&str; 2] = ["mesh.size=[1000,4]", "mesh.elements=[1000,4]"];

fn by_size(model: &Model, available: Option<u64>) -> Choice {
    let means = AvailableSolvers { available, multigrid: false, ranks: 1 };
    Choice::by_size(&model.problem, &InitialWorkingSet::default(), means).unwrap()
}

fn choice(overrides: &[&str], available: Option<u64>) -> Choice {
    by_size(&discretise(&block(overrides)).unwrap(), available)
}

#[test]
fn squares_are_condensed_and_strips_are_not() {
    let square = choice(&["mesh.elements=[60,60]"], None);
    assert_eq!(square.linear, LinearAlgebra::condensed(), "{:?}", square.reason);
    let strip = choice(&STRIP, None);
    assert_eq!(strip.linear, LinearAlgebra::default(), "{:?}", strip.reason);
}

#[test]
fn cubes_are_condensed_and_the_thinnest_plate_is_not() {
    let text = CUBE;
    for (elements, size, expected) in
        [("[8,8,8]", "[1,1,1]", true), ("[16,16,4]", "[1,1,0.25]", true), ("[32,32,2]", "[1,1,0.0625]", false)]
    {
        let overrides = [format!("mesh.elements={elements}"), format!("mesh.size={size}")];
        let overrides = overrides.each_ref().map(String::as_str);
        let choice = by_size(&discretise(&parsed_with(text, &overrides)).unwrap(), None);
        assert_eq!(choice.linear.condenses(), expected, "{elements}: {:?}", choice.reason);
    }
}

/// Whoever names no solver has it chosen: a scene, and Rust.
#[test]
fn the_reason_is_told() {
    let condensed = LinearAlgebra::condensed();
    let reason = choice(&["mesh.elements=[40,40]"], None).reason.unwrap();
    assert_eq!(reason, "condensed: 80 contact displacements of 3280");
    for overrides in [&["mesh.elements=[40,40]"][..], &["mesh.elements=[40,40]", "solver.linear=\"auto\""]] {
        let scene = block(overrides);
        assert_eq!(Run::new(&scene).unwrap().choice(), &Choice { linear: condensed, reason: Some(reason.clone()) });
    }
    let model = discretise(&block(&["mesh.elements=[40,40]"])).unwrap();
    let run = Run::of(&model, model.times().to_vec(), SolverChoice::default()).unwrap();
    assert_eq!(run.choice().reason.as_ref(), Some(&reason));
    let named = block(&["mesh.elements=[5,5]", "solver.linear=\"condensed\""]);
    assert_eq!(Run::new(&named).unwrap().choice(), &Choice { linear: condensed, reason: None });
}

#[test]
fn what_memory_does_not_hold_is_not_chosen() {
    let needs = |overrides: &[&str], linear| {
        MemoryEstimate::of(&discretise(&block(overrides)).unwrap(), linear, 0).unwrap().factors as u64
    };
    let (whole, condensed) = (LinearAlgebra::default(), LinearAlgebra::condensed());
    // The better one of those that have room, and where none has, that with the least.
    let square = ["mesh.elements=[40,40]"];
    let (more, less) = (needs(&square, whole), needs(&square, condensed));
    assert!(less < more, "{less} {more}");
    for available in [more + 1, less + 1, less / 2] {
        let choice = choice(&square, Some(available));
        assert_eq!((choice.linear, choice.reason.unwrap().contains("left")), (condensed, false));
    }
    let (less, more) = (needs(&STRIP, whole), needs(&STRIP, condensed));
    assert!(less < more, "{less} {more}");
    for available in [more + 1, less + 1, less / 2] {
        assert_eq!(choice(&STRIP, Some(available)).linear, whole);
    }
    // A contact that is small enough to condense it may need more memory than the whole system.
    let wide = ["mesh.elements=[300,10]", "mesh.size=[300,10]"];
    let (less, more) = (needs(&wide, whole), needs(&wide, condensed));
    assert_eq!(choice(&wide, Some(more + 1)).linear, condensed);
    let Choice { linear, reason } = choice(&wide, Some(less + 1));
    let reason = reason.unwrap();
    assert_eq!(linear, whole);
    assert!(reason.contains("; condensed would take ") && reason.ends_with(" left"), "{reason}");
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
    let plane = discretise(&block(&["mesh.elements=[3,3]"])).unwrap();
    assert_eq!(unsuited(&plane, Method::BN.into()), Some(Unsuited::Plane));
}

#[test]
fn without_contact_any_choice_solves() {
    let text = BLOCK;
    let (contact, load) = (text.find("[[contact]]").unwrap(), text.find("[[load]]").unwrap());
    let scene = parsed_with(&[&text[..contact], &text[load..]].concat(), &["mesh.elements=[4,4]"]);
    let model = discretise(&scene).unwrap();
    assert_eq!(run(&scene, &model, by_size(&model, None).linear).0.status, Status::Converged);
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
        let scene = block(&[overrides, &["time.increments=2"]].concat());
        let model = discretise(&scene).unwrap();
        assert_eq!(by_size(&model, None).linear.condenses(), expected);
        let [(whole, whole_states), (condensed, condensed_states)] = both().map(|backend| run(&scene, &model, backend));
        assert_eq!((whole.status, condensed.status), (Status::Converged, Status::Converged));
        for (a, b) in whole_states.iter().zip(&condensed_states) {
            assert!(apart(&b.p_n, &a.p_n) <= 1e-9, "{overrides:?}: {:e}", apart(&b.p_n, &a.p_n));
        }
    }
}
