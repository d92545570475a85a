//! Pretensions and periodic boundaries: bars and joints in closed form, equal results of all methods, refused inputs.
#![allow(clippy::unwrap_used)]

use stickslip::algebra::linear::SparseLu;
use stickslip::run::report::{RunReport, SectionRecord};
use stickslip::run::{Run, discretise, tightening};
use stickslip::scene::Scene;
use stickslip::solver::history::{LinearAlgebra, Method, SolverChoice, Status};

use crate::common::edit;

/// A bar of two parts between rigid walls, without lateral contraction.
const BAR: &str = r#"
units = { length = "mm", stress = "MPa" }
[[body]]
name = "lower"
[body.mesh]
kind = "block"
size = [10, 40]
elements = [3, 4]
[body.material]
young = 2e5
poisson = 0
[[body]]
name = "upper"
at = [0, 40]
[body.mesh]
kind = "block"
size = [10, 60]
elements = [2, 5]
[body.material]
young = 2e5
poisson = 0
[[contact]]
boundary = "lower:top"
against = "upper:bottom"
glue = true
[[pretension]]
name = "bolt"
boundary = "lower:top"
force = 1000
[[support]]
boundary = "lower:bottom"
fix = ["x", "y"]
[[support]]
boundary = "upper:top"
fix = ["x", "y"]
[time]
end = 1
increments = 2
"#;

/// A bolt in two parts beside a sleeve, both below a rigid head that moves along the bolt only. The bolt has a stiffness of
/// E A / 40 mm with the area 4 mm (times 1 mm), the sleeve three times as much.
const JOINT: &str = r#"
units = { length = "mm", stress = "MPa" }
[[body]]
name = "shank"
mesh = { kind = "block", size = [4, 30], elements = [2, 3] }
material = { young = 2e5, poisson = 0 }
[[body]]
name = "stud"
at = [0, 30]
mesh = { kind = "block", size = [4, 10], elements = [3, 2] }
material = { young = 2e5, poisson = 0 }
[[body]]
name = "sleeve"
at = [6, 0]
mesh = { kind = "block", size = [12, 40], elements = [3, 4] }
material = { young = 2e5, poisson = 0 }
[[body]]
name = "head"
at = [0, 40]
mesh = { kind = "block", size = [20, 5], elements = [5, 1] }
material = { young = 1, poisson = 0 }
[[coupling]]
name = "head"
body = "head"
[[contact]]
boundary = "shank:top"
against = "stud:bottom"
glue = true
[[contact]]
boundary = "stud:top"
against = "head:bottom"
glue = true
[[contact]]
boundary = "sleeve:top"
against = "head:bottom"
friction = 0.2
[[support]]
boundary = "shank:bottom"
fix = ["x", "y"]
[[support]]
boundary = "sleeve:bottom"
fix = ["x", "y"]
[[support]]
coupling = "head"
fix = ["x", "rotation_z"]
[[pretension]]
name = "bolt"
boundary = "shank:top"
force = 1200
history = [[0, 0], [1, 1]]
lock = 1
[[load]]
coupling = "head"
force = [0, 800]
history = [[1, 0], [2, 1], [3, 4]]
[time]
end = 3
increments = 6
"#;

/// A strip that is one period of a layer, below a pressure.
const STRIP: &str = r#"
[mesh]
kind = "block"
size = [3, 2]
elements = [4, 3]
[material]
young = 100
poisson = 0.25
[[contact]]
boundary = "right"
against = "left"
glue = true
shift = [3, 0]
[[support]]
boundary = "bottom"
fix = ["y"]
[[support]]
point = [0, 0]
fix = ["x"]
[[load]]
boundary = "top"
pressure = 2
[time]
end = 1
increments = 1
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("scene.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn bn() -> SolverChoice {
    SolverChoice::new(Method::BN)
}

fn report(text: &str, solver: SolverChoice) -> RunReport {
    let model = discretise(&scene(text)).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let report = Run::of(&model, model.times().to_vec(), solver).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    assert!(report.reactions.iter().all(|record| record.balance < 1e-9), "{:?}", report.reactions);
    report
}

/// The section of the first pretension at the end of increment `index`, from 1.
fn section(report: &RunReport, index: usize) -> &SectionRecord {
    let record = report.reactions.iter().find(|record| record.index == index).unwrap();
    &record.pretensions[0]
}

fn last(report: &RunReport) -> &SectionRecord {
    section(report, report.reactions.last().unwrap().index)
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found}, not {expected}");
}

/// `F = E A δ / L`, in the plane per m of depth, with different meshes of both sides.
#[test]
fn a_bar_is_tightened() {
    let stiffness = 2e11 * 0.01 / 0.1;
    let forced = report(BAR, bn());
    let bolt = last(&forced);
    near(bolt.tension, 1e6, 1e-9);
    near(bolt.shortening, 1e6 / stiffness, 1e-9);
    near(bolt.displacement[1], 1e6 / stiffness, 1e-9);
    near(section(&forced, 1).tension, 5e5, 1e-9);
    near(forced.reactions[1].supports[1].force[1], 1e6, 1e-9);
    let shortened = report(&edit(BAR, "force = 1000", "shortening = 0.5"), bn());
    near(last(&shortened).tension, 5e-4 * stiffness, 1e-9);
    near(last(&shortened).shortening, 5e-4, 1e-12);
    near(shortened.reactions[1].supports[0].force[1], -5e-4 * stiffness, 1e-9);
    // The other side as boundary, and the section of an oblique bar.
    let exchanged = BAR.replace("\"lower:top\"", "\"section\"").replace("\"upper:bottom\"", "\"lower:top\"");
    let exchanged = report(&exchanged.replace("\"section\"", "\"upper:bottom\""), bn());
    near(last(&exchanged).shortening, 1e6 / stiffness, 1e-9);
    near(last(&exchanged).force[1], -1e6, 1e-9);
}

/// A body of revolution: the force is over the full circumference.
#[test]
fn a_bolt_of_revolution_is_tightened() {
    let text = BAR.replace("poisson = 0", "poisson = 0\nplane = \"axisymmetric\"");
    let text = text.replace("fix = [\"x\", \"y\"]", "fix = [\"y\"]");
    let stiffness = 2e11 * std::f64::consts::PI * 1e-4 / 0.1;
    let forced = report(&text, bn());
    near(last(&forced).tension, 1e3, 1e-9);
    near(last(&forced).shortening, 1e3 / stiffness, 1e-9);
    let shortened = report(&edit(&text, "force = 1000", "shortening = 0.5"), bn());
    near(last(&shortened).tension, 5e-4 * stiffness, 1e-9);
}

/// The joint in the plane, of revolution, and in space, with the area of the bolt in m² (m in the plane) and the stiffness of
/// the sleeve relative to that of the bolt.
fn joints() -> [(String, f64, f64); 3] {
    let round = JOINT
        .replace("poisson = 0 }", "poisson = 0, plane = \"axisymmetric\" }")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"y\"]")
        .replace("fix = [\"x\", \"rotation_z\"]", "fix = [\"x\"]")
        .replace("force = 1200", "force = 12000")
        .replace("force = [0, 800]", "force = [0, 8000]");
    let space = JOINT
        .replace("[4, 30], elements = [2, 3]", "[4, 5, 30], elements = [2, 1, 3]")
        .replace("[4, 10], elements = [3, 2]", "[4, 5, 10], elements = [1, 2, 2]")
        .replace("[12, 40], elements = [3, 4]", "[12, 5, 40], elements = [3, 1, 4]")
        .replace("[20, 5], elements = [5, 1]", "[20, 5, 5], elements = [5, 2, 1]")
        .replace("at = [0, 30]", "at = [0, 0, 30]")
        .replace("at = [0, 40]", "at = [0, 0, 40]")
        .replace("at = [6, 0]", "at = [6, 0, 0]")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\", \"z\"]")
        .replace("fix = [\"x\", \"rotation_z\"]", "fix = [\"x\", \"y\", \"rotation_x\", \"rotation_y\", \"rotation_z\"]")
        .replace("force = [0, 800]", "force = [0, 0, 800]");
    let pi = std::f64::consts::PI;
    [
        (JOINT.to_string(), 4e-3, 3.0),
        (round, pi * 16e-6, (18.0_f64.powi(2) - 36.0) / 16.0),
        (space, 20e-6, 3.0),
    ]
}

/// The joint diagram: `F = F_0 + φ P` with `φ = k_b / (k_b + k_p)` until the joint separates, then `F = P`.
#[test]
fn a_joint_follows_its_diagram() {
    for (text, area, ratio) in joints() {
        let report = report(&text, bn());
        let factor = if area == 4e-3 { 1e3 } else { 1.0 };
        let factor = if area == std::f64::consts::PI * 16e-6 { 10.0 } else { factor };
        let (force, service) = (1200.0 * factor, 800.0 * factor);
        let soft = 0.04 / (2e11 * area);
        near(section(&report, 1).tension, 0.5 * force, 1e-9);
        near(section(&report, 2).tension, force, 1e-9);
        near(section(&report, 2).shortening, force * soft * (1.0 + 1.0 / ratio), 1e-9);
        near(section(&report, 3).tension, force + 0.5 * service / (1.0 + ratio), 1e-9);
        near(section(&report, 4).tension, force + service / (1.0 + ratio), 1e-9);
        near(section(&report, 4).shortening, section(&report, 2).shortening, 1e-12);
        near(section(&report, 6).tension, 4.0 * service, 1e-9);
    }
}

/// Tightening by the force and by the shortening, and all methods and ways of linear algebra, give the same.
#[test]
fn all_methods_agree_about_a_joint() {
    let [(plane, ..), _, (space, ..)] = joints();
    for text in [plane, space] {
        let expected = report(&text, bn());
        let choices = [
            SolverChoice::new(Method::Ip),
            SolverChoice { linear: Some(LinearAlgebra::condensed()), ..bn() },
            SolverChoice { linear: Some(LinearAlgebra::Whole(SparseLu::Partial)), ..bn() },
        ];
        for choice in choices {
            let found = report(&text, choice);
            for index in 1..=6 {
                near(section(&found, index).tension, section(&expected, index).tension, 1e-7);
            }
        }
    }
}

/// Before it locks, a tightened bolt that only contact holds can move without resistance; the model knows it.
#[test]
fn a_free_section_is_a_rigid_motion() {
    let loose = &BAR[..BAR.find("[[support]]\nboundary = \"upper:top\"").unwrap()];
    let loose = format!("{loose}{}", &BAR[BAR.find("[time]").unwrap()..]);
    let model = tightening(&scene(&loose)).unwrap();
    assert_eq!(model.rigid_motions.len(), 1);
    assert!(model.rigid_motions[0].to_string().contains("a translation along (0, "), "{}", model.rigid_motions[0]);
    let held = edit(&loose, "force = 1000", "shortening = 1");
    assert!(tightening(&scene(&held)).unwrap().rigid_motions.is_empty());
    // Without a support the two parts are one body that moves and turns, and may separate.
    let free = edit(&loose, "[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n", "");
    assert_eq!(tightening(&scene(&free)).unwrap().rigid_motions.len(), 4);
}

/// A periodic strip is strained along its height only; with a free period it expands.
#[test]
fn a_periodic_strip_is_pressed() {
    let height = |report: &RunReport| report.reactions[0].loads[0].displacement[1];
    let confined = report(STRIP, bn());
    near(height(&confined), -2.0 * 2.0 * (1.25 * 0.5) / (100.0 * 0.75), 1e-9);
    let free = edit(STRIP, "[[support]]", "[[pretension]]\nname = \"wall\"\nboundary = \"right\"\nforce = 0\n[[support]]");
    let free = report(&free, bn());
    near(height(&free), -2.0 * 2.0 * (1.0 - 0.0625) / 100.0, 1e-9);
    near(last(&free).shortening, 3.0 * 2.0 * 0.25 * 1.25 / 100.0, 1e-9);
    // Different meshes of both sides.
    let cut = edit(STRIP, "kind = \"block\"", "kind = \"block\"\ncells = \"triangle6\"");
    near(height(&report(&cut, bn())), height(&confined), 1e-9);
}

/// Bars one behind the other: `1 / E = Σ c / E`. A shear has a moment that the periodic boundaries carry.
#[test]
fn a_laminate_has_its_modulus() {
    let laminate = r#"
[[body]]
name = "soft"
mesh = { kind = "block", size = [4, 2], elements = [2, 3] }
material = { young = 100, poisson = 0 }
[[body]]
name = "hard"
at = [4, 0]
mesh = { kind = "block", size = [6, 2], elements = [2, 4] }
material = { young = 300, poisson = 0 }
[[contact]]
boundary = "soft:right"
against = "hard:left"
glue = true
[[contact]]
boundary = "hard:right"
against = "soft:left"
glue = true
shift = [10, 0]
[[pretension]]
name = "cell"
boundary = "hard:right"
shortening = 0.01
[[support]]
boundary = "soft:bottom"
fix = ["y"]
[[support]]
point = [0, 0]
fix = ["x"]
[time]
end = 1
increments = 1
"#;
    let modulus = 1.0 / (0.4 / 100.0 + 0.6 / 300.0);
    near(last(&report(laminate, bn())).tension, 2.0 * modulus * 0.01 / 10.0, 1e-9);
}
