//! Rigid bodies under forces: closed forms, the limit of stiff bodies, verdicts and warnings, and methods against each other.

use crate::common::prelude::*;
use stickslip::run::report::PointRecord;

use super::{PUNCH, near, point, report};

/// Every method and every linear algebra has one answer for a rigid punch under a force, and the punch moved as the
/// force moved it has this force.
#[test]
fn a_rigid_body_under_a_force() {
    let tolerance = 1e-12;
    let all = [
        LinearAlgebra::Whole(SparseLu::default()),
        LinearAlgebra::Whole(SparseLu::Partial),
        LinearAlgebra::condensed(),
    ];
    let choices = [Method::BN, Method::Ip].into_iter().flat_map(|method| {
        all.map(|linear| SolverChoice { linear: Some(linear), tolerance, ..SolverChoice::new(method) })
    });
    let ends: Vec<PointRecord> = choices.map(|choice| point(&report(&PUNCH, choice), "handle").clone()).collect();
    let first = &ends[0];
    near(&first.force, &[3e5, -5e6], 1e-9);
    for other in &ends {
        near(&other.displacement, &first.displacement, 1e-9);
        near(&other.rotation, &first.rotation, 1e-9);
    }
    let to: Vec<String> =
        first.displacement.iter().map(|u| 1e3 * u).chain(first.rotation.clone()).map(|x| format!("{x:e}")).collect();
    let moved = format!(
        "[[support]]\ncoupling = \"handle\"\nfix = [\"x\", \"y\", \"rotation_z\"]\ndisplacement = [{}]\n[time]",
        to.join(", ")
    );
    let text = edit(&PUNCH, "[[load]]\ncoupling = \"handle\"\nforce = [300, -5000]\n", "");
    let report = report(&edit(&text, "[time]", &moved), SolverChoice { tolerance, ..bn() });
    near(&point(&report, "handle").force, &first.force, 1e-6);
    assert!(point(&report, "handle").moment[0].abs() < 1e-6 * 5e6 * 0.01);
}

/// A load beside the base tips a punch; the motion that nothing resists is a rotation.
#[test]
fn a_punch_that_tips_is_said_to_tip() {
    let text = edit(&PUNCH, "force = [300, -5000]", "force = [0, -5000]");
    let text = edit(&text, "[time]", "[[load]]\ncoupling = \"handle\"\nmoment = 60000\n[time]");
    let model = model_of(&text);
    let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ()).unwrap();
    assert_ne!(report.status, Status::Converged);
    assert!(report.explanation.reason.contains("a rotation about"), "{}", report.explanation.reason);
}

/// Forces stay where they were: a roller that is free to turn does not roll.
#[test]
fn a_body_that_rolls_is_warned_of() {
    let load = |rest: &str| format!("[[load]]\ncoupling = \"punch\"\nforce = [10, -1726.2]\n{rest}");
    let text = pressed(2.0, 16, "\"(x - 100)^2 / 200\"", &load("")).replace("cells = \"triangle6\"\n", "");
    let text = edit(&text, "friction = 0", "friction = 0.5");
    let text = edit(&text, "point = [100, 100]", "point = [100, 200]");
    let warned = |text: &str| {
        let report = report(text, bn());
        report.warnings.iter().any(|warning| warning.kind == WarningKind::LARGE_MOTION)
    };
    assert!(warned(&text));
    let held = edit(&text, "[time]", "[[support]]\ncoupling = \"punch\"\nfix = [\"rotation_z\"]\n[time]");
    assert!(!warned(&held));
    assert!(!warned(&edit(&PUNCH, "[300, -5000]", "[100, -5000]")));
}

/// A rigid body equals a body a million times as stiff.
#[test]
fn a_rigid_body_is_the_limit_of_a_stiff_one() {
    let punch = edit(
        &PUNCH,
        "boundary = \"punch:bottom\"\nagainst = \"plate:top\"",
        "boundary = \"plate:top\"\nagainst = \"punch:bottom\"",
    );
    let stiff =
        punch.replace("young = 1\n", "young = 2.1e12\n").replace("body = \"punch\"\n", "boundary = \"punch:top\"\n");
    let [rigid, stiff] = [&punch, &stiff].map(|text| point(&report(text, bn()), "handle").clone());
    near(&stiff.displacement, &rigid.displacement, 1e-4);
    near(&stiff.rotation, &rigid.rotation, 1e-3);
}

/// Nothing but friction holds the punch along the plate.
#[test]
fn a_rigid_body_that_slides_is_named() {
    for (from, to) in
        [("friction = 0.3", "friction = 0"), ("[300, -5000]", "[3000, -5000]"), ("[300, -5000]", "[0, 5000]")]
    {
        let model = discretise(&parsed(&edit(&PUNCH, from, to))).unwrap();
        let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ()).unwrap();
        assert_ne!(report.status, Status::Converged, "{to}");
        assert!(report.explanation.reason.contains("punch"), "{to}: {}", report.explanation.reason);
    }
}

/// A ball between two plates: three bodies, one of them rigid and held by contact and friction alone. Both contacts
/// carry the whole force.
#[test]
fn a_rigid_body_between_two_others() {
    let text = scene! { r#"
units = { length = "mm", stress = "MPa" }
[[body]] name = "lower", mesh = { kind = "block", size = [20, 10], elements = [20, 10] }
material = { young = 2.1e5, poisson = 0.3 }
[[body]] name = "roller", at = [8, 10], mesh = { kind = "block", size = [4, 4], elements = [4, 2] }
material = { young = 1, poisson = 0.3 }
[[body]] name = "upper", at = [0, 14], mesh = { kind = "block", size = [20, 10], elements = [20, 10] }
material = { young = 2.1e5, poisson = 0.3 }
[[coupling]] name = "roller", body = "roller"
[[contact]] boundary = "roller:bottom", against = "lower:top", gap = "(x - 10)^2 / 200", friction = 0.2
[[contact]] boundary = "upper:bottom", against = "roller:top", gap = "(x - 10)^2 / 200", friction = 0.2
[[support]] boundary = "lower:bottom", fix = ["x", "y"]
[[support]] boundary = "upper:top", fix = ["x", "y"], displacement = [0, -0.01]
[time] end = 1, increments = 2
"# };
    for linear in [LinearAlgebra::Whole(SparseLu::default()), LinearAlgebra::condensed()] {
        let report = report(&text, SolverChoice { linear: Some(linear), ..bn() });
        let [lower, upper] = [0, 1].map(|k| report.reactions.last().unwrap().supports[k].force.clone());
        near(&[lower[1]], &[-upper[1]], 1e-9);
        assert!(lower[1] > 1e5, "{lower:?}");
        // The roller moves half as far, by symmetry.
        let roller = point(&report, "roller");
        near(&roller.displacement, &[0.0, -0.5e-5], 1e-9);
        assert!(roller.rotation[0].abs() < 1e-12 && roller.force.iter().all(|f| *f == 0.0), "{roller:?}");
    }
}

/// An elastic half-plane, nearly: a deep plate below a rigid body whose bottom is 2 `a` wide, with `across` elements below
/// it and twice as many beside and under it. No friction.
fn pressed(a: f64, across: usize, gap: &str, load: &str) -> String {
    let beside = 2 * across;
    scene_text(&format!(
        r#"
units = {{ length = "mm", stress = "MPa" }}
[[body]] name = "plate"
[body.mesh] kind = "block", size = [[{side}, {width}, {side}], 100]
elements = [[{beside}, {across}, {beside}], {beside}], grading = [[0.02, 1, 50], 0.01], cells = "triangle6"
[body.material] young = 2e5, poisson = 0.3
[[body]] name = "punch", at = [{side}, 100]
[body.mesh] kind = "block", size = [{width}, 5], elements = [8, 2]
[body.material] young = 1, poisson = 0.3
[[coupling]] name = "punch", body = "punch", point = [100, 100]
[[contact]] boundary = "plate:top", against = "punch:bottom", friction = 0, gap = {gap}
[[support]] boundary = "plate:bottom", fix = ["x", "y"]
{load}
[time] end = 1, increments = 1
"#,
        side = 100.0 - a,
        width = 2.0 * a,
    ))
}

/// A flat rigid punch with a force and a moment on a half-plane turns by `θ = 4 M / (π E* a²)` (Johnson, Contact Mechanics,
/// 1985, section 2.8). Its pressure is singular at both edges, so that the order is 1.
#[test]
fn a_flat_punch_tilts() {
    let load = "[[support]]\ncoupling = \"punch\"\nfix = [\"x\"]\n[[load]]\ncoupling = \"punch\"\nforce = [0, -5000]\n\
                [[load]]\ncoupling = \"punch\"\nmoment = 8000";
    let exact = 4.0 * 8000.0 / (std::f64::consts::PI * 2e5 / 0.91 * 25.0);
    let error = |across: usize| {
        let report = report(&pressed(5.0, across, "0", load), bn());
        1.0 - point(&report, "punch").rotation[0] / exact
    };
    let [coarse, fine] = [10, 20].map(error);
    assert!(fine > 0.0 && fine < 0.012 && coarse / fine > 1.6, "{coarse} {fine}");
}

/// A rigid roller pressed by a force has the pressure of Hertz, `p = √(P E* / π R)`.
#[test]
fn a_roller_is_pressed_by_a_force() {
    let load = "[[support]]\ncoupling = \"punch\"\nfix = [\"x\", \"rotation_z\"]\n[[load]]\ncoupling = \"punch\"\n\
                force = [0, -1726.2]";
    let text = pressed(2.0, 30, "\"(x - 100)^2 / 200\"", load).replace("cells = \"triangle6\"\n", "");
    let report = report(&text, bn());
    let exact = (1726.2 * 2e5 / 0.91 / (std::f64::consts::PI * 100.0)).sqrt();
    let peak = report.largest_pressure.as_ref().unwrap().pressure.unwrap() * 1e-6;
    assert!((peak / exact - 1.0).abs() < 0.01, "{peak} {exact}");
}

/// Random rigid punches in the plane and in space: BN and IP, whole and condensed, agree, the forces balance, and those of
/// the punch are its load.
#[test]
fn random_rigid_bodies() {
    let mut random = Random(20_261);
    let tolerance = 1e-12;
    for trial in 0..16 {
        let space = trial % 4 == 3;
        let mut number = |from: f64, to: f64| from + (to - from) * random.next();
        let (mu, side, push) = (number(0.1, 0.8), number(8.0, 14.0), number(-1.0, 1.0));
        let (down, arm) = (number(500.0, 5000.0), number(-1.5, 1.5));
        // Half of the friction at most, and a resultant within the middle half of the base.
        let aside = 0.5 * mu * down * push;
        let elements = 2 + (number(0.0, 4.0) as usize);
        let more = if space { ", \"z\"" } else { "" };
        let (size, at) = if space {
            (format!("[20, 6, {side}]"), format!("[6, 0, {side}]"))
        } else {
            (format!("[20, {side}]"), format!("[6, {side}]"))
        };
        let (punch, coarse, fine) = if space {
            ("[8, 6, 4]".to_string(), format!("[{elements}, 2, 1]"), "[10, 3, 4]")
        } else {
            ("[8, 4]".to_string(), format!("[{elements}, 2]"), "[10, 6]")
        };
        let force = if space { format!("[{aside}, 0, {}]", -down) } else { format!("[{aside}, {}]", -down) };
        let moment = if space { format!("[0, {}, 0]", -down * arm) } else { format!("{}", down * arm) };
        let text = scene! { format r#"
units = {{ length = "mm", stress = "MPa" }}
[[body]] name = "plate", mesh = {{ kind = "block", size = {size}, elements = {fine} }}
material = {{ young = 2e5, poisson = 0.3 }}
[[body]] name = "punch", at = {at}, mesh = {{ kind = "block", size = {punch}, elements = {coarse} }}
material = {{ young = 1, poisson = 0.3 }}
[[coupling]] name = "punch", body = "punch"
[[contact]] boundary = "plate:top", against = "punch:bottom", friction = {mu}
[[support]] boundary = "plate:bottom", fix = ["x", "y"{more}]
[[load]] coupling = "punch", force = {force}
[[load]] coupling = "punch", moment = {moment}
[time] end = 1, increments = 2
"# };
        let whole = LinearAlgebra::Whole(SparseLu::default());
        let choices = [(Method::BN, whole), (Method::BN, LinearAlgebra::condensed()), (Method::Ip, whole)];
        let ends = choices.map(|(method, linear)| {
            let choice = SolverChoice { linear: Some(linear), tolerance, ..SolverChoice::new(method) };
            let report = report(&text, choice);
            let contact = report.boundaries[0].force.clone();
            (point(&report, "punch").clone(), contact)
        });
        for (end, contact) in &ends {
            near(&end.displacement, &ends[0].0.displacement, 1e-7);
            // The contact force on the punch is its load, reversed.
            let reversed: Vec<f64> = end.force.iter().map(|f| -f).collect();
            near(contact, &reversed, 1e-9);
        }
    }
}
