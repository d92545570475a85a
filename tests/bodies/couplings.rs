//! Couplings to reference points: bars in closed form, forces and motions that belong together, rigid bodies pressed by
//! forces, and inputs that are refused.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use miette::Diagnostic;
use stickslip::algebra::linear::SparseLu;
use stickslip::body::fem::Material;
use stickslip::body::mesh::{Boundary, Mesh, MeshSource};
use stickslip::body::{Axis, Coupling, Description, Load, Model, Part, Support, Where};
use stickslip::run::report::{PointRecord, RunReport};
use stickslip::run::{Run, discretise};
use stickslip::scene::Scene;
use stickslip::solver::history::{LinearAlgebra, Method, SolverChoice, Status};

use crate::common::edit;
use crate::common::random::Random;

/// A cantilever of 100 mm x 10 mm, without lateral contraction, so that beam theory is exact for a moment.
const BEAM: &str = r#"
units = { length = "mm", stress = "MPa" }
[mesh]
kind = "block"
size = [100, 10]
elements = [10, 2]
cells = "triangle6"
[material]
young = 2e5
poisson = 0
plane = "stress"
[[support]]
boundary = "left"
fix = ["x", "y"]
[[coupling]]
name = "end"
boundary = "right"
[[load]]
coupling = "end"
moment = 1000
[time]
end = 1
increments = 1
"#;

/// A bar of 40 mm x 4 mm x 6 mm.
const BAR: &str = r#"
units = { length = "mm", stress = "MPa" }
[mesh]
kind = "block"
size = [40, 4, 6]
elements = [4, 1, 1]
cells = "tetrahedron10"
[material]
young = 2e5
poisson = 0
[[support]]
boundary = "left"
fix = ["x", "y", "z"]
[[coupling]]
name = "end"
boundary = "right"
[[load]]
coupling = "end"
moment = [0, 500, 300]
[[load]]
coupling = "end"
force = [1200, 0, 0]
[time]
end = 1
increments = 1
"#;

/// A rigid punch on an elastic plate with friction, pressed, pushed and tilted.
const PUNCH: &str = r#"
units = { length = "mm", stress = "MPa" }
[[body]]
name = "plate"
[body.mesh]
kind = "block"
size = [40, 20]
elements = [20, 10]
[body.material]
young = 2.1e5
poisson = 0.3
[[body]]
name = "punch"
at = [15, 20]
[body.mesh]
kind = "block"
size = [10, 10]
elements = [3, 2]
[body.material]
young = 1
poisson = 0.3
[[coupling]]
name = "handle"
body = "punch"
point = [19, 30]
[[contact]]
boundary = "punch:bottom"
against = "plate:top"
friction = 0.3
[[support]]
boundary = "plate:bottom"
fix = ["x", "y"]
[[load]]
coupling = "handle"
force = [300, -5000]
[time]
end = 1
increments = 4
"#;

fn scene(text: &str) -> Scene {
    Scene::parse("scene.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn report(text: &str, solver: SolverChoice) -> RunReport {
    let scene = scene(text);
    let model = discretise(&scene).unwrap();
    solved(&model, solver)
}

fn solved(model: &Model, solver: SolverChoice) -> RunReport {
    let report = Run::of(model, model.times().to_vec(), solver).unwrap().solve(&mut ()).unwrap();
    assert_eq!(report.status, Status::Converged, "{}", report.explanation.reason);
    assert!(report.reactions.iter().all(|record| record.balance < 1e-9), "{:?}", report.reactions);
    report
}

/// The reference point `name` at the end.
fn point<'a>(report: &'a RunReport, name: &str) -> &'a PointRecord {
    report.reactions.last().unwrap().couplings.iter().find(|coupling| coupling.at == name).unwrap()
}

fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let apart = found.iter().zip(expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(found.len() == expected.len() && apart <= tolerance * size, "{found:?}, not {expected:?}");
}

fn bn() -> SolverChoice {
    SolverChoice::new(Method::BN)
}

/// In pure bending `θ = M L / E I` and `v = M L² / 2 E I`; SI, per m of depth.
#[test]
fn pure_bending_is_exact() {
    let report = report(BEAM, bn());
    let end = point(&report, "end");
    let bending = 2e11 * 0.01_f64.powi(3) / 12.0;
    near(&end.rotation, &[1000.0 * 0.1 / bending], 1e-9);
    near(&end.displacement, &[0.0, 1000.0 * 0.01 / (2.0 * bending)], 1e-9);
    near(&end.moment, &[1000.0], 1e-12);
    let reactions = &report.reactions[0].supports[0];
    near(&reactions.moment, &[-1000.0], 1e-9);
}

/// A spring against rotation shares the moment with the bar, `θ = M / (E I / L + k)`.
#[test]
fn a_rotational_spring_shares_the_moment() {
    let bending = 2e11 * 0.01_f64.powi(3) / 12.0 / 0.1;
    let text = edit(BEAM, "[time]", "[[spring]]\ncoupling = \"end\"\nrotational = 1e5\n[time]");
    let report = report(&text, bn());
    near(&point(&report, "end").rotation, &[1000.0 / (bending + 1e5)], 1e-9);
    near(&report.reactions[0].springs[0].moment, &[-1e5 * 1000.0 / (bending + 1e5)], 1e-9);
    // The moment on the body.
    near(&point(&report, "end").moment, &[1000.0 * bending / (bending + 1e5)], 1e-9);
}

#[test]
fn bending_about_two_axes_and_tension() {
    let report = report(BAR, bn());
    let end = point(&report, "end");
    let (about_y, about_z) = (4.0 * 216.0 / 12.0, 6.0 * 64.0 / 12.0);
    let [of_y, of_z] = [0.5 * 40.0 / (2e5 * about_y) * 1e3, 0.3 * 40.0 / (2e5 * about_z) * 1e3];
    near(&end.rotation, &[0.0, of_y, of_z], 1e-9);
    let stretched = 1200.0 * 40.0 / (2e5 * 24.0);
    near(&end.displacement, &[1e-3 * stretched, 1e-3 * of_z * 20.0, -1e-3 * of_y * 20.0], 1e-9);
    near(&end.force, &[1200.0, 0.0, 0.0], 1e-12);
    near(&end.moment, &[0.0, 0.5, 0.3], 1e-12);
}

/// A support that moves the point as the forces did needs these forces, also at a point beside the boundary.
#[test]
fn forces_and_motions_belong_together() {
    for text in [BEAM, BAR] {
        let text = &edit(
            text,
            "name = \"end\"",
            if text == BEAM { "name = \"end\"\npoint = [120, -7]" } else { "name = \"end\"\npoint = [45, -3, 8]" },
        );
        let forced = report(text, bn());
        let end = point(&forced, "end");
        let list = |values: &[f64], factor: f64| {
            values.iter().map(|x| format!("{:e}", factor * x)).collect::<Vec<_>>().join(", ")
        };
        let (fix, rotation) = if text.contains("[40, 4, 6]") {
            ("\"x\", \"y\", \"z\"", "\"rotation_x\", \"rotation_y\", \"rotation_z\"")
        } else {
            ("\"x\", \"y\"", "\"rotation_z\"")
        };
        let to = format!("{}, {}", list(&end.displacement, 1e3), list(&end.rotation, 1.0));
        let support = format!("[[support]]\ncoupling = \"end\"\nfix = [{fix}, {rotation}]\ndisplacement = [{to}]\n");
        let loads = text.find("[[load]]").unwrap()..text.find("[time]").unwrap();
        let moved = report(&text.replace(&text[loads], &support), bn());
        let again = point(&moved, "end");
        near(&again.displacement, &end.displacement, 1e-12);
        near(&again.rotation, &end.rotation, 1e-12);
        let moment = end.moment.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (again, force) in again.force.iter().zip(&end.force) {
            assert!((again - force).abs() <= 1e-8 * (force.abs() + moment / 0.01), "{again} {force}");
        }
        near(&again.moment, &end.moment, 1e-8);
    }
}

/// A distributing coupling does the work of its forces: `F · U = Σ f · u`, so that displacement by a moment and rotation by a
/// force are equal, and the boundary is not stiffened.
#[test]
fn distributing_forces_are_reciprocal() {
    let at = "name = \"end\"\nkind = \"distributing\"\npoint = [110, 3]";
    let moment = edit(BEAM, "name = \"end\"", at);
    let force = edit(&moment, "moment = 1000", "force = [0, 7]");
    let (by_moment, by_force) = (report(&moment, bn()), report(&force, bn()));
    let (of_moment, of_force) = (point(&by_moment, "end"), point(&by_force, "end"));
    near(&[7e3 * of_moment.displacement[1]], &[1000.0 * of_force.rotation[0]], 1e-9);
    near(&of_moment.moment, &[1000.0], 1e-9);
    near(&of_force.force, &[0.0, 7e3], 1e-9);
    let rigid = edit(BEAM, "name = \"end\"", "name = \"end\"\npoint = [110, 3]");
    let rigid = report(&rigid, bn());
    let [free, rigid] = [of_moment, point(&rigid, "end")].map(|end| end.rotation[0]);
    // Without lateral contraction a plane end stays plane, so that both are exact.
    near(&[free], &[rigid], 1e-9);
    let space = edit(BAR, "name = \"end\"", "name = \"end\"\nkind = \"distributing\"");
    let space = report(&space, bn());
    near(&point(&space, "end").force, &[1200.0, 0.0, 0.0], 1e-9);
    near(&point(&space, "end").moment, &[0.0, 0.5, 0.3], 1e-9);
}

/// Two bars of one mesh with a common end share a force by their stiffness; supports hold only one of them in its
/// directions, so that the coupling holds the other.
#[test]
fn one_point_carries_two_bodies() {
    let bodies = r#"
[[body]]
name = "thick"
mesh = { kind = "block", size = [0.1, 0.02], elements = [4, 2] }
material = { young = 2e11, poisson = 0, plane = "stress" }
[[body]]
name = "thin"
at = [0, 0.05]
mesh = { kind = "block", size = [0.1, 0.01], elements = [3, 2] }
material = { young = 2e11, poisson = 0, plane = "stress" }
[time]
end = 1
increments = 1
"#;
    let mesh = discretise(&scene(bodies)).unwrap().mesh;
    let mut mesh = Mesh::clone(&mesh);
    let facets = ["thick:right", "thin:right"].map(|name| mesh.boundary(name).unwrap().facets.clone()).concat();
    mesh.boundaries.push(Boundary { name: "ends".into(), facets });
    let material = scene(bodies).description.material;
    let both = Description::new(MeshSource::Given(Arc::new(mesh)), material, vec![1.0])
        .support("thick:left", &[Axis::X, Axis::Y])
        .held(Support::new("thin:left", &[Axis::X]))
        .coupling(Coupling::rigid("ends", "ends"))
        .held(Support::new("", &[]).of_coupling("ends", &[Axis::Z]))
        .load(Load::from(stickslip::body::Action::Force { at: Where::Coupling("ends".into()), force: vec![6e5, 0.0] }));
    let model = Model::build(&both).unwrap();
    assert!(model.rigid_motions.is_empty(), "{:?}", model.rigid_motions);
    let report = solved(&model, bn());
    let end = point(&report, "ends");
    near(&end.displacement, &[6e5 * 0.1 / (2e11 * 0.03), 0.0], 1e-9);
    near(&report.reactions[0].supports[0].force, &[-4e5, 0.0], 1e-9);
    near(&report.reactions[0].supports[1].force, &[-2e5, 0.0], 1e-9);
    // Without the coupling the thin bar may move along y.
    let apart = Description { couplings: Vec::new(), supports: both.supports[..2].to_vec(), loads: Vec::new(), ..both };
    assert_eq!(Model::build(&apart).unwrap().rigid_motions.len(), 1);
}

/// A disc at the end of a shaft moves along the axis only.
#[test]
fn a_body_of_revolution_is_pulled() {
    let text = BEAM
        .replace("plane = \"stress\"", "plane = \"axisymmetric\"")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"y\"]")
        .replace("boundary = \"left\"", "boundary = \"bottom\"")
        .replace("boundary = \"right\"", "boundary = \"top\"")
        .replace("moment = 1000", "force = [0, 5000]");
    let report = report(&text, bn());
    let area = std::f64::consts::PI * 100.0 * 100.0;
    near(&point(&report, "end").displacement, &[0.0, 1e-3 * 5000.0 * 10.0 / (2e5 * area)], 1e-9);
}

/// Half of a bar with the point on the plane of symmetry is half of the whole.
#[test]
fn symmetry_may_hold_carried_nodes() {
    let whole = edit(BEAM, "moment = 1000", "force = [600, 0]");
    let half = edit(&whole, "size = [100, 10]", "size = [100, 5]");
    let half = edit(&half, "force = [600, 0]", "force = [300, 0]");
    let symmetry = "[[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n";
    let loose = edit(&half, "[[coupling]]", &format!("{symmetry}[[coupling]]"));
    let error = discretise(&scene(&loose)).unwrap_err().to_string();
    assert!(error.contains("support[1]") || error.contains("holds the node"), "{error}");
    let guided = format!("{symmetry}[[support]]\ncoupling = \"end\"\nfix = [\"y\", \"rotation_z\"]\n[[coupling]]");
    let half = edit(&half, "[[coupling]]", &guided);
    let [whole, half] = [whole, half].map(|text| point(&report(&text, bn()), "end").displacement.clone());
    near(&half[..1], &whole[..1], 1e-9);
}

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
    let ends: Vec<PointRecord> = choices.map(|choice| point(&report(PUNCH, choice), "handle").clone()).collect();
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
    let text = edit(PUNCH, "[[load]]\ncoupling = \"handle\"\nforce = [300, -5000]\n", "");
    let report = report(&edit(&text, "[time]", &moved), SolverChoice { tolerance, ..bn() });
    near(&point(&report, "handle").force, &first.force, 1e-6);
    assert!(point(&report, "handle").moment[0].abs() < 1e-6 * 5e6 * 0.01);
}

/// A pushed half of a bar, and a disc at its axis: supports hold carried nodes in directions in which the point does not move.
#[test]
fn moved_points_on_planes_of_symmetry() {
    let support = "[[support]]\ncoupling = \"end\"\nfix = [\"x\", \"y\", \"rotation_z\"]\ndisplacement = [0.3, 0, 0]\n";
    let symmetry = "[[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n";
    let half = edit(BEAM, "[[load]]\ncoupling = \"end\"\nmoment = 1000\n", &format!("{support}{symmetry}"));
    near(&point(&report(&half, bn()), "end").force, &[2e11 * 0.003 * 0.01, 0.0], 1e-9);
    let disc = BEAM
        .replace("plane = \"stress\"", "plane = \"axisymmetric\"")
        .replace("fix = [\"x\", \"y\"]", "fix = [\"y\"]")
        .replace("boundary = \"left\"", "boundary = \"bottom\"")
        .replace("boundary = \"right\"", "boundary = \"top\"")
        .replace(
            "[[load]]\ncoupling = \"end\"\nmoment = 1000\n",
            "[[support]]\ncoupling = \"end\"\nfix = [\"y\"]\ndisplacement = 0.1\n",
        );
    let area = std::f64::consts::PI * 0.01;
    near(&point(&report(&disc, bn()), "end").force, &[0.0, 2e11 * 0.01 * area], 1e-9);
}

/// A load beside the base tips a punch; the motion that nothing resists is a rotation.
#[test]
fn a_punch_that_tips_is_said_to_tip() {
    let text = edit(PUNCH, "force = [300, -5000]", "force = [0, -5000]");
    let text = edit(&text, "[time]", "[[load]]\ncoupling = \"handle\"\nmoment = 60000\n[time]");
    let model = discretise(&scene(&text)).unwrap();
    let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ()).unwrap();
    assert_ne!(report.status, Status::Converged);
    assert!(report.explanation.reason.contains("a rotation about"), "{}", report.explanation.reason);
}

/// Forces stay where they were: a roller that is free to turn does not roll.
#[test]
fn a_body_that_rolls_is_warned_of() {
    use stickslip::run::report::WarningKind;
    let load = |rest: &str| format!("[[load]]\ncoupling = \"punch\"\nforce = [10, -1726.2]\n{rest}");
    let text = pressed(2.0, 16, "\"(x - 100)^2 / 200\"", &load("")).replace("cells = \"triangle6\"\n", "");
    let text = edit(&text, "friction = 0", "friction = 0.5");
    let text = edit(&text, "point = [100, 100]", "point = [100, 200]");
    let warned = |text: &str| {
        let report = report(text, bn());
        report.warnings.iter().any(|warning| warning.kind == WarningKind::LargeMotion)
    };
    assert!(warned(&text));
    let held = edit(&text, "[time]", "[[support]]\ncoupling = \"punch\"\nfix = [\"rotation_z\"]\n[time]");
    assert!(!warned(&held));
    assert!(!warned(&edit(PUNCH, "[300, -5000]", "[100, -5000]")));
}

/// A rigid body equals a body a million times as stiff.
#[test]
fn a_rigid_body_is_the_limit_of_a_stiff_one() {
    let punch = edit(
        PUNCH,
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
        let model = discretise(&scene(&edit(PUNCH, from, to))).unwrap();
        let run = Run::of(&model, model.times().to_vec(), bn()).unwrap();
        let report = run.solve(&mut ()).unwrap();
        assert_ne!(report.status, Status::Converged, "{to}");
        assert!(report.explanation.reason.contains("punch"), "{to}: {}", report.explanation.reason);
    }
}

/// A ball between two plates: three bodies, one of them rigid and held by contact and friction alone. Both contacts
/// carry the whole force.
#[test]
fn a_rigid_body_between_two_others() {
    let text = r#"
units = { length = "mm", stress = "MPa" }
[[body]]
name = "lower"
mesh = { kind = "block", size = [20, 10], elements = [20, 10] }
material = { young = 2.1e5, poisson = 0.3 }
[[body]]
name = "roller"
at = [8, 10]
mesh = { kind = "block", size = [4, 4], elements = [4, 2] }
material = { young = 1, poisson = 0.3 }
[[body]]
name = "upper"
at = [0, 14]
mesh = { kind = "block", size = [20, 10], elements = [20, 10] }
material = { young = 2.1e5, poisson = 0.3 }
[[coupling]]
name = "roller"
body = "roller"
[[contact]]
boundary = "roller:bottom"
against = "lower:top"
gap = "(x - 10)^2 / 200"
friction = 0.2
[[contact]]
boundary = "upper:bottom"
against = "roller:top"
gap = "(x - 10)^2 / 200"
friction = 0.2
[[support]]
boundary = "lower:bottom"
fix = ["x", "y"]
[[support]]
boundary = "upper:top"
fix = ["x", "y"]
displacement = [0, -0.01]
[time]
end = 1
increments = 2
"#;
    for linear in [LinearAlgebra::Whole(SparseLu::default()), LinearAlgebra::condensed()] {
        let report = report(text, SolverChoice { linear: Some(linear), ..bn() });
        let [lower, upper] = [0, 1].map(|k| report.reactions.last().unwrap().supports[k].force.clone());
        near(&[lower[1]], &[-upper[1]], 1e-9);
        assert!(lower[1] > 1e5, "{lower:?}");
        // By symmetry it moves half as far.
        let roller = point(&report, "roller");
        near(&roller.displacement, &[0.0, -0.5e-5], 1e-9);
        assert!(roller.rotation[0].abs() < 1e-12 && roller.force.iter().all(|f| *f == 0.0), "{roller:?}");
    }
}

/// Faults of the beam: what to replace, by what, words of the message, words of the help.
const OF_BEAM: &[(&str, &str, &str, &str)] = &[
    ("name = \"end\"\nboundary", "boundary", "missing field `name`", "add the key"),
    ("boundary = \"right\"", "", "needs a boundary or a body", "add one"),
    ("boundary = \"right\"", "boundary = \"right\"\nbody = \"block\"", "both boundary and body", "keep one"),
    ("boundary = \"right\"", "boundary = \"rihgt\"", "no boundary `rihgt`", "bottom"),
    ("boundary = \"right\"", "body = \"bolck\"", "no body `bolck`", "bodies"),
    ("boundary = \"right\"", "boundary = \"right\"\nkind = \"elastic\"", "unknown variant", "one of the values"),
    ("boundary = \"right\"", "body = \"block\"\nkind = \"distributing\"", "needs a boundary", "rigid"),
    ("boundary = \"right\"", "boundary = \"right\"\npoint = [1, 2, 3]", "3 components", "[x, y]"),
    ("boundary = \"right\"", "boundary = \"right\"\npoint = [nan, 2]", "finite", "not nan"),
    ("boundary = \"right\"", "boundary = \"right\"\nweight = 1", "unknown field `weight`", "spelling"),
    ("boundary = \"right\"", "boundary = \"left\"", "holds the node", "couple"),
    ("[[load]]", "[[coupling]]\nname = \"end\"\nboundary = \"top\"\n[[load]]", "two couplings", "a name of its own"),
    ("[[load]]", "[[coupling]]\nname = \"top\"\nboundary = \"top\"\n[[load]]", "both carry the node", "share no node"),
    ("moment = 1000", "moment = [1, 2, 3]", "3 components", "one number"),
    ("moment = 1000", "moment = inf", "finite", "one about z"),
    ("moment = 1000", "moment = 1000\nforce = [0, 1]", "both force and moment", "two loads"),
    ("moment = 1000", "pressure = 3", "a pressure has no coupling", "remove"),
    ("moment = 1000", "traction = [1, 0]\nboundary = \"top\"", "a traction has no coupling", "remove"),
    ("moment = 1000", "force = [1, 2, 3]", "3 components", "[x, y]"),
    ("moment = 1000", "temperature = 3", "a temperature has no coupling", "remove"),
    ("coupling = \"end\"\nmoment = 1000", "moment = 1000", "needs a coupling", "add the key"),
    ("coupling = \"end\"", "coupling = \"edn\"", "no coupling `edn`", "couplings end"),
    ("coupling = \"end\"", "coupling = \"end\"\nboundary = \"top\"", "a moment has no boundary", "remove"),
    ("[[load]]", "[[support]]\ncoupling = \"end\"\nfix = [\"normal\"]\n[[load]]", "single point", "direction"),
    ("[[load]]", "[[support]]\ncoupling = \"end\"\nfix = [\"z\"]\n[[load]]", "two dimensions", "leave out"),
    ("[[load]]", "[[support]]\ncoupling = \"end\"\nfix = [\"rotation_x\"]\n[[load]]", "about z only", "rotation_z"),
    ("[[load]]", "[[support]]\ncoupling = \"no\"\nfix = [\"x\"]\n[[load]]", "no coupling `no`", "couplings end"),
    ("[[load]]", "[[support]]\nboundary = \"top\"\nfix = [\"rotation_z\"]\n[[load]]", "rotation", "name a coupling"),
    (
        "[[load]]",
        "[[support]]\nboundary = \"top\"\ncoupling = \"end\"\nfix = [\"x\"]\n[[load]]",
        "both boundary",
        "keep one",
    ),
    ("[[load]]", "[[support]]\ncoupling = \"end\"\ndirection = [0, 0]\n[[load]]", "a direction", "give e.g."),
    ("[[load]]", "[[spring]]\ncoupling = \"end\"\n[[load]]", "stiffness or rotational", "add one"),
    ("[[load]]", "[[spring]]\ncoupling = \"end\"\nrotational = -1\n[[load]]", "0 or more", "give stiffnesses"),
    ("[[load]]", "[[spring]]\ncoupling = \"end\"\nrotational = [1, 2, 3]\n[[load]]", "3 components", "one number"),
    ("[[load]]", "[[spring]]\nrotational = 1\n[[load]]", "needs a coupling", "add the key"),
    (
        "[[load]]",
        "[[spring]]\ncoupling = \"end\"\nrotational = 1\nstiffness = [1, 0]\n[[load]]",
        "both stiffness and rotational",
        "two springs",
    ),
    ("[[load]]", "[[spring]]\ncoupling = \"end\"\nnormal = 1\n[[load]]", "stiffness or rotational", "add one"),
];

/// Each fault of a coupling, and of what acts on it, names its key.
#[test]
fn faults_name_their_keys() {
    let distributing = edit(BEAM, "name = \"end\"", "name = \"end\"\nkind = \"distributing\"");
    let axisymmetric =
        BEAM.replace("plane = \"stress\"", "plane = \"axisymmetric\"").replace("fix = [\"x\", \"y\"]", "fix = [\"x\"]");
    let plate = edit(PUNCH, "[[coupling]]", "[[coupling]]\nname = \"plate\"\nbody = \"plate\"\n[[coupling]]");
    let others: &[(&str, &str, &str, &str, &str)] = &[
        (
            &distributing,
            "[[load]]",
            "[[support]]\ncoupling = \"end\"\nfix = [\"x\"]\n[[load]]",
            "moves freely",
            "rigid",
        ),
        (
            &distributing,
            "[[load]]",
            "[[spring]]\ncoupling = \"end\"\nrotational = 1\n[[load]]",
            "moves freely",
            "rigid",
        ),
        (&axisymmetric, "", "", "does not turn", "remove"),
        (&plate, "", "", "every node", "elastic"),
        (BEAM, "boundary = \"right\"", "boundary = \"right\"\npoint = [1e7, 0]", "times the size", "nearer point"),
        (
            BEAM,
            "[[load]]",
            "[[contact]]\nboundary = \"right\"\nfriction = 0\nobstacle = { kind = \"plane\" }\n[[load]]",
            "rigid by a coupling",
            "elastic",
        ),
        (&axisymmetric, "moment = 1000", "force = [1, 0]", "along its axis only", "[0, y]"),
        (BAR, "moment = [0, 500, 300]", "moment = 3", "1 components", "[x, y, z]"),
    ];
    let all = OF_BEAM.iter().map(|&(from, to, says, help)| (BEAM, from, to, says, help));
    let mut wrong = Vec::new();
    for (text, from, to, says, help) in all.chain(others.iter().copied()) {
        let text = if from.is_empty() { text.to_string() } else { edit(text, from, to) };
        let (message, cure) = match Scene::parse("scene.toml", &text, &[]) {
            Err(error) => (error.to_string(), error.help().map(|help| help.to_string())),
            Ok(scene) => {
                let error = discretise(&scene).expect_err(&text);
                (error.to_string(), error.help().map(|help| help.to_string()))
            }
        };
        let cure = cure.unwrap_or_default();
        if !message.contains(says) || !message.starts_with("scene.toml:") || !cure.contains(help) {
            wrong.push(format!("{message}\n  help: {cure}\n  not: {says}; {help}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A rigid coupling of a body in the library.
#[test]
fn the_library_couples() {
    let block = Description::new(MeshSource::block([1.0, 1.0], [4, 4]), Material::new(2e11, 0.3), vec![1.0])
        .support("left", &[Axis::X, Axis::Y])
        .coupling(Coupling::distributing("end", "right").at([1.5, 0.5]));
    assert_eq!(block.couplings[0].part, Part::Boundary("right".into()));
    let model = Model::build(
        &block.load(Load::from(stickslip::body::Action::Moment { coupling: "end".into(), moment: vec![1.0] })),
    );
    assert!(model.is_ok());
}

/// An elastic half-plane, nearly: a deep plate below a rigid body whose bottom is 2 `a` wide, with `across` elements below
/// it and twice as many beside and under it. No friction.
fn pressed(a: f64, across: usize, gap: &str, load: &str) -> String {
    let beside = 2 * across;
    format!(
        r#"
units = {{ length = "mm", stress = "MPa" }}
[[body]]
name = "plate"
[body.mesh]
kind = "block"
size = [[{side}, {width}, {side}], 100]
elements = [[{beside}, {across}, {beside}], {beside}]
grading = [[0.02, 1, 50], 0.01]
cells = "triangle6"
[body.material]
young = 2e5
poisson = 0.3
[[body]]
name = "punch"
at = [{side}, 100]
[body.mesh]
kind = "block"
size = [{width}, 5]
elements = [8, 2]
[body.material]
young = 1
poisson = 0.3
[[coupling]]
name = "punch"
body = "punch"
point = [100, 100]
[[contact]]
boundary = "plate:top"
against = "punch:bottom"
friction = 0
gap = {gap}
[[support]]
boundary = "plate:bottom"
fix = ["x", "y"]
{load}
[time]
end = 1
increments = 1
"#,
        side = 100.0 - a,
        width = 2.0 * a,
    )
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
        let text = format!(
            r#"
units = {{ length = "mm", stress = "MPa" }}
[[body]]
name = "plate"
mesh = {{ kind = "block", size = {size}, elements = {fine} }}
material = {{ young = 2e5, poisson = 0.3 }}
[[body]]
name = "punch"
at = {at}
mesh = {{ kind = "block", size = {punch}, elements = {coarse} }}
material = {{ young = 1, poisson = 0.3 }}
[[coupling]]
name = "punch"
body = "punch"
[[contact]]
boundary = "plate:top"
against = "punch:bottom"
friction = {mu}
[[support]]
boundary = "plate:bottom"
fix = ["x", "y"{more}]
[[load]]
coupling = "punch"
force = {force}
[[load]]
coupling = "punch"
moment = {moment}
[time]
end = 1
increments = 2
"#
        );
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
