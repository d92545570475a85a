//! The analysis of a problem before its solution: the conditions of Theorem 3 and the balance of a rigid body.
#![allow(clippy::unwrap_used)]

use crate::common;
use stickslip::body::Model;
use stickslip::body::constraints::RigidMotion;
use stickslip::run::discretise;
use stickslip::scene::Scene;
use stickslip::solver::{Conditions, rigid_equilibrium};

/// Returns a free block on a rigid floor, pressed down by 10 MN and pushed to the right by `push` MN, with more tables
/// and more contacts.
fn text(push: f64, contacts: &[&str], tables: &str) -> String {
    format!(
        r#"
        mesh = {{ kind = "block", size = [2.0, 1.0], elements = [4, 4] }}
        material = {{ young = 210e9, poisson = 0.3 }}
        contact = [{{ boundary = "bottom", friction = 0.4, obstacle = {{ kind = "plane" }} }}, {}]
        load = [
            {{ boundary = "top", traction = [0, -5e6], history = [[0, 1]] }},
            {{ boundary = "left", traction = [{push}e6, 0] }},
        ]
        time = {{ end = 1, increments = 10 }}
        {tables}
        "#,
        contacts.join(", ")
    )
}

fn on_the_floor(push: f64, contacts: &[&str], tables: &str) -> Scene {
    Scene::parse("floor.toml", &text(push, contacts, tables), &[]).unwrap()
}

const NOTHING: &[&str] = &[];
const LEFT: &str = r#"{ boundary = "left", friction = 0.4, obstacle = { kind = "plane" } }"#;
const RIGHT: &str = r#"{ boundary = "right", friction = 0.4, obstacle = { kind = "plane" } }"#;
const TOP: &str = r#"{ boundary = "top", friction = 0.4, obstacle = { kind = "plane" } }"#;
const SLANTED: &str = r#"{ boundary = "left", friction = 0.4, obstacle = { kind = "plane", normal = [-0.8, -0.6] } }"#;
/// Leaves only vertical displacements of the floor nodes.
const SLIDE: &str = r#"support = [{ boundary = "bottom", fix = ["x"] }]"#;

fn named(model: &Model, weights: &[f64]) -> String {
    RigidMotion::combination(&model.constraints.rigid_motions, weights).unwrap().to_string()
}

/// Returns the motion that violates (a), in words, and the positions of nodes that violate (b).
fn violations(scene: &Scene) -> (Option<String>, Vec<[f64; 2]>) {
    let model = discretise(scene).unwrap();
    let conditions = Conditions::of(&model.problem);
    assert_eq!(conditions.hold(), conditions.leaving.is_none() && conditions.dependent.is_empty());
    // The motion has the stated property.
    if let Some(weights) = &conditions.leaving {
        let motion = RigidMotion::combination(&model.constraints.rigid_motions, weights).unwrap();
        let w_n = model.problem.c_n().times(&motion.displacements(&model.mesh, &model.constraints.dofs)).unwrap();
        assert!(w_n.iter().all(|&w| w <= 1e-12), "{motion}: {w_n:?}");
    }
    let motion = conditions.leaving.map(|weights| named(&model, &weights));
    (
        motion,
        conditions
            .dependent
            .iter()
            .map(|&i| [model.contact.nodes[i].position[0], model.contact.nodes[i].position[1]])
            .collect(),
    )
}

/// Returns the motion driven by the final load, in words.
fn driven(scene: &Scene) -> Option<String> {
    let model = discretise(scene).unwrap();
    let force = model.loading.force_at(1.0, &model.problem).unwrap();
    let weights = rigid_equilibrium(&model.problem, &force).unwrap()?;
    let motion = RigidMotion::combination(&model.constraints.rigid_motions, &weights).unwrap();
    let u = motion.displacements(&model.mesh, &model.constraints.dofs);
    // The load does work, and no edge of a friction cone can work against it.
    assert!(u.iter().zip(&force).map(|(u, f)| u * f).sum::<f64>() > 0.0);
    let (w_n, w_t) = (model.problem.c_n().times(&u).unwrap(), model.problem.c_t().times(&u).unwrap());
    assert!(w_n.iter().zip(&w_t).zip(model.problem.mu()).all(|((n, t), mu)| n + mu * t.abs() <= 1e-12));
    Some(motion.to_string())
}

#[test]
fn the_block_meets_the_conditions() {
    assert_eq!(violations(&common::block(&["mesh.elements=[10,10]"])), (None, vec![]));
    assert_eq!(driven(&common::block(&["mesh.elements=[10,10]"])), None);
}

#[test]
fn a_body_that_only_contact_holds_may_leave() {
    let leaving = |contacts: &[&str], tables: &str| violations(&on_the_floor(0.0, contacts, tables)).0;
    assert_eq!(leaving(NOTHING, "").unwrap(), "a translation along (0, 1)");
    // Out of a corner; along two walls; none if all sides are constrained.
    assert!(leaving(&[RIGHT], "").unwrap().starts_with("a translation along (-0.7"));
    assert_eq!(leaving(&[TOP], "").unwrap().replace('-', ""), "a translation along (1, 0)");
    assert_eq!(leaving(&[TOP, LEFT, RIGHT], ""), None);
    // Guided at its left side it can still lift off, or turn about that side.
    let guided = |fix: &str| format!("support = [{{ boundary = \"left\", fix = [\"{fix}\"] }}]");
    assert_eq!(leaving(NOTHING, &guided("x")).unwrap(), "a translation along (0, 1)");
    assert!(leaving(NOTHING, &guided("y")).unwrap().starts_with("a rotation about (0, "));
    assert_eq!(leaving(&[TOP], &guided("x")), None);
}

/// Two obstacles at a node stop it in two directions. With friction that is two too many, without it one if a support stops one of
/// them.
#[test]
fn rows_of_a_corner_depend_if_it_is_held_in_one_direction() {
    let smooth = |contacts: &[&str], tables: &str| {
        let text = text(0.0, contacts, tables).replace("friction = 0.4", "friction = 0");
        violations(&Scene::parse("smooth.toml", &text, &[]).unwrap()).1
    };
    assert_eq!(violations(&on_the_floor(0.0, &[SLANTED], "")).1, [[0.0; 2]; 2]);
    assert_eq!((smooth(&[SLANTED], ""), smooth(&[SLANTED], SLIDE)), (vec![], vec![[0.0; 2]; 2]));
    assert_eq!(violations(&on_the_floor(0.0, &[LEFT], SLIDE)).1, [[0.0; 2]; 0]);
    assert_eq!(violations(&on_the_floor(0.0, &[SLANTED], SLIDE)).1, [[0.0; 2]; 2]);
}

/// A pull along the guide does no work for lifting off, in spite of the rounding of the motion along the guide.
#[test]
fn a_pull_along_a_guide_lifts_nothing() {
    let guided = "support = [{ boundary = \"left\", fix = [\"x\"] }]";
    for elements in ["[1,1]", "[2,2]", "[4,4]", "[8,4]", "[10,10]", "[20,10]"] {
        let scene = on_the_floor(0.0, NOTHING, guided);
        let pull = ["load[0].traction=[0,0]", "load[1].boundary=\"right\"", "load[1].traction=[1e4,0]"];
        let overrides = pull.into_iter().map(str::to_string).chain([format!("mesh.elements={elements}")]);
        let overrides: Vec<_> = overrides.map(|text| text.parse().unwrap()).collect();
        assert_eq!(driven(&scene.with(&overrides).unwrap()), None, "{elements}");
    }
}

#[test]
fn friction_resists_up_to_its_limit() {
    // 5 MN/m² on 2 m press; the push is in MN/m² on 1 m.
    for push in [0.0, 3.9, -3.9, 4.0] {
        assert_eq!(driven(&on_the_floor(push, NOTHING, "")), None, "{push}");
    }
    // It slides and lifts at the angle of friction, because friction would work against pure sliding.
    assert_eq!(driven(&on_the_floor(4.1, NOTHING, "")).unwrap(), "a translation along (0.928477, 0.371391)");
    assert_eq!(driven(&on_the_floor(-4.1, NOTHING, "")).unwrap(), "a translation along (-0.928477, 0.371391)");
    assert_eq!(driven(&on_the_floor(4.1, &[RIGHT], "")), None);
    let with_friction = |mu: &str, push: f64| {
        Scene::parse("floor.toml", &text(push, NOTHING, ""), &[format!("contact.friction={mu}").parse().unwrap()])
    };
    assert_eq!(driven(&with_friction("0", 1e-3).unwrap()).unwrap(), "a translation along (1, 0)");
    // A block that does not slide tips over: 10 MN at half the width, 1 m, against the push at half the height.
    assert_eq!(driven(&with_friction("10", 19.9).unwrap()), None);
    assert!(driven(&with_friction("10", 20.1).unwrap()).unwrap().starts_with("a rotation about "));
}

#[test]
fn check_tells_it() {
    let check = |name: &str, text: &str| {
        let path = std::env::temp_dir().join(format!("stickslip-solvability-{}-{name}.toml", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let output =
            std::process::Command::new(env!("CARGO_BIN_EXE_stickslip")).arg("check").arg(&path).output().unwrap();
        std::fs::remove_file(&path).unwrap();
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let free = check("free", &text(8.0, NOTHING, ""));
    assert!(free.contains("\ntheorem 3    (a) violated: a translation along (0, 1) moves no node towards"), "{free}");
    assert!(!free.contains("(b)") && !free.contains("holds:"), "{free}");
    // The limit is 0.5 of 8 MN; the next increment ends at 0.6.
    assert!(free.contains("\nNO BALANCE   first at t = 0.6 s: the loads drive a translation along (1, 0),"), "{free}");
    let weak = check("weak", &text(4.0, NOTHING, ""));
    assert!(weak.contains("(a) violated") && !weak.contains("NO BALANCE"), "{weak}");

    // With half of the friction at the end the limit falls from 4 MN to 2 MN, and the push reaches it at 2/3 s.
    let worn =
        text(4.0, NOTHING, "").replace("friction = 0.4", "friction_history = [[0, 1], [1, 0.5]], friction = 0.4");
    let worn = check("worn", &worn);
    assert!(worn.contains("\nNO BALANCE   first at t = 0.7 s: the loads drive a translation along"), "{worn}");

    let supported = check("held", &text(8.0, &[SLANTED, TOP, RIGHT], SLIDE));
    assert!(
        supported.contains("\ntheorem 3    (b) violated: the contact rows at (0, 0) m (and at 2 more) depend on"),
        "{supported}"
    );
    assert!(!supported.contains("(a)") && !supported.contains("NO BALANCE"), "{supported}");
}
