//! Couplings to reference points: bars in closed form, forces and motions that belong together, and inputs that are refused.

mod rigid_bodies;

use crate::common::prelude::*;
use stickslip::body::{Direction, Held, Part};
use stickslip::run::report::PointRecord;

scene! {
/// A cantilever of 100 mm x 10 mm, without lateral contraction, so that beam theory is exact for a moment.
static BEAM = r#"
units = { length = "mm", stress = "MPa" }
[mesh] kind = "block", size = [100, 10], elements = [10, 2], cells = "triangle6"
[material] young = 2e5, poisson = 0, plane = "stress"
[[support]] boundary = "left", fix = ["x", "y"]
[[coupling]] name = "end", boundary = "right"
[[load]] coupling = "end", moment = 1000
[time] end = 1, increments = 1
"# }

scene! {
/// A bar of 40 mm x 4 mm x 6 mm.
static BAR = r#"
units = { length = "mm", stress = "MPa" }
[mesh] kind = "block", size = [40, 4, 6], elements = [4, 1, 1], cells = "tetrahedron10"
[material] young = 2e5, poisson = 0
[[support]] boundary = "left", fix = ["x", "y", "z"]
[[coupling]] name = "end", boundary = "right"
[[load]] coupling = "end", moment = [0, 500, 300]
[[load]] coupling = "end", force = [1200, 0, 0]
[time] end = 1, increments = 1
"# }

scene! {
/// A rigid punch on an elastic plate with friction, pressed, pushed and tilted.
static PUNCH = r#"
units = { length = "mm", stress = "MPa" }
[[body]] name = "plate"
[body.mesh] kind = "block", size = [40, 20], elements = [20, 10]
[body.material] young = 2.1e5, poisson = 0.3
[[body]] name = "punch", at = [15, 20]
[body.mesh] kind = "block", size = [10, 10], elements = [3, 2]
[body.material] young = 1, poisson = 0.3
[[coupling]] name = "handle", body = "punch", point = [19, 30]
[[contact]] boundary = "punch:bottom", against = "plate:top", friction = 0.3
[[support]] boundary = "plate:bottom", fix = ["x", "y"]
[[load]] coupling = "handle", force = [300, -5000]
[time] end = 1, increments = 4
"# }

fn report(text: &str, solver: SolverChoice) -> RunReport {
    balanced(&model_of(text), solver)
}

/// The reference point `name` at the end.
fn point<'a>(report: &'a RunReport, name: &str) -> &'a PointRecord {
    report.reactions.last().unwrap().couplings.iter().find(|coupling| coupling.at == name).unwrap()
}

fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert!(apart(found, expected) <= tolerance, "{found:?}, not {expected:?}");
}

/// In pure bending `θ = M L / E I` and `v = M L² / 2 E I`; SI, per m of depth.
#[test]
fn pure_bending_is_exact() {
    let report = report(&BEAM, bn());
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
    let text = edit(&BEAM, "[time]", "[[spring]]\ncoupling = \"end\"\nrotational = 1e5\n[time]");
    let report = report(&text, bn());
    near(&point(&report, "end").rotation, &[1000.0 / (bending + 1e5)], 1e-9);
    near(&report.reactions[0].springs[0].moment, &[-1e5 * 1000.0 / (bending + 1e5)], 1e-9);
    // The moment on the body.
    near(&point(&report, "end").moment, &[1000.0 * bending / (bending + 1e5)], 1e-9);
}

#[test]
fn bending_about_two_axes_and_tension() {
    let report = report(&BAR, bn());
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
    for text in [&BEAM, &BAR] {
        let text = &edit(
            text,
            "name = \"end\"",
            if text.contains("[100, 10]") {
                "name = \"end\"\npoint = [120, -7]"
            } else {
                "name = \"end\"\npoint = [45, -3, 8]"
            },
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
        let moment = largest(&end.moment);
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
    let moment = edit(&BEAM, "name = \"end\"", at);
    let force = edit(&moment, "moment = 1000", "force = [0, 7]");
    let (by_moment, by_force) = (report(&moment, bn()), report(&force, bn()));
    let (of_moment, of_force) = (point(&by_moment, "end"), point(&by_force, "end"));
    near(&[7e3 * of_moment.displacement[1]], &[1000.0 * of_force.rotation[0]], 1e-9);
    near(&of_moment.moment, &[1000.0], 1e-9);
    near(&of_force.force, &[0.0, 7e3], 1e-9);
    let rigid = edit(&BEAM, "name = \"end\"", "name = \"end\"\npoint = [110, 3]");
    let rigid = report(&rigid, bn());
    let [free, rigid] = [of_moment, point(&rigid, "end")].map(|end| end.rotation[0]);
    // Without lateral contraction a plane end stays plane, so that both are exact.
    near(&[free], &[rigid], 1e-9);
    let space = edit(&BAR, "name = \"end\"", "name = \"end\"\nkind = \"distributing\"");
    let space = report(&space, bn());
    near(&point(&space, "end").force, &[1200.0, 0.0, 0.0], 1e-9);
    near(&point(&space, "end").moment, &[0.0, 0.5, 0.3], 1e-9);
}

/// A moment and a force beside the centroid are tractions that change linearly: on cells of second order beam theory is exact with
/// two facets across, and on others the bar moves as with this traction, given as a formula.
#[test]
fn distributed_moments_are_linear_tractions() {
    let bar = |size: &str, elements: &str, cells: &str, load: &str, at: &str| {
        let held = if at.matches(',').count() == 2 { ("bottom", "[\"z\"]") } else { ("left", "[\"x\"]") };
        let (ends, corner) = if held.0 == "left" { ("right", "[0, 0]") } else { ("top", "[0, 0, 0]") };
        let across = if held.0 == "left" { "[\"y\"]" } else { "[\"x\", \"y\"]" };
        let twist = if held.0 == "left" { "" } else { "[[support]]\npoint = [1, 0, 0]\nfix = [\"y\"]\n" };
        let text = format!(
            "[mesh]\nkind = \"block\"\nsize = {size}\nelements = {elements}\ncells = \"{cells}\"\n[material]\nyoung = 1000\n\
             poisson = 0\n[[support]]\nboundary = \"{}\"\nfix = {}\n[[support]]\npoint = {corner}\nfix = {across}\n{twist}\
             [[coupling]]\nname = \"tip\"\nboundary = \"{ends}\"\nkind = \"distributing\"\npoint = {at}\n[[load]]\n{}\n\
             [time]\nend = 1\nincrements = 1\n",
            held.0,
            held.1,
            load.replace("END", ends)
        );
        point(&report(&text, bn()), "tip").clone()
    };
    // F = 4 at (0.5, -0.8) from the centroid, moments 1 and -2; the bar of 1 x 2 x 5 has I = 2/3 and 1/6.
    let in_space = "coupling = \"tip\"\nforce = [0, 0, 4]\n[[load]]\ncoupling = \"tip\"\nmoment = [1, -2, 0]";
    let [m_x, m_y] = [1.0 - 0.8 * 4.0, -2.0 - 0.5 * 4.0];
    let traction = format!(
        "boundary = \"END\"\ntraction = [0, 0, \"2 + ({}) * (y - 1) - ({}) * (x - 0.5)\"]",
        1.5 * m_x,
        6.0 * m_y
    );
    for (elements, cells) in [("[2, 2, 4]", "hexahedron20"), ("[1, 1, 2]", "tetrahedron10"), ("[2, 1, 2]", "prism15")] {
        let found = bar("[1, 2, 5]", elements, cells, in_space, "[1, 0.2, 7]");
        near(&found.rotation[..2], &[m_x * 5.0 * 1.5 / 1e3, m_y * 5.0 * 6.0 / 1e3], 1e-9);
    }
    for cells in ["hexahedron", "tetrahedron", "prism"] {
        let [coupled, loaded] =
            [in_space, &traction].map(|load| bar("[1, 2, 5]", "[2, 3, 4]", cells, load, "[1, 0.2, 7]"));
        near(&coupled.rotation[..2], &loaded.rotation[..2], 1e-9);
        near(&coupled.displacement, &loaded.displacement, 1e-9);
    }
    // A bar of 5 x 2, force 4 at 0.8 below the axis: M = 1 + 0.8 · 4, I = 2/3.
    let plane = "coupling = \"tip\"\nforce = [4, 0]\n[[load]]\ncoupling = \"tip\"\nmoment = 1";
    for cells in ["quadrilateral8", "triangle6"] {
        let found = bar("[5, 2]", "[3, 2]", cells, plane, "[6, 0.2]");
        near(&found.rotation, &[4.2 * 5.0 * 1.5 / 1e3], 1e-9);
    }
    let traction = "boundary = \"END\"\ntraction = [\"2 - 6.3 * (y - 1)\", 0]";
    for cells in ["quadrilateral", "triangle"] {
        let [coupled, loaded] = [plane, traction].map(|load| bar("[5, 2]", "[4, 3]", cells, load, "[6, 0.2]"));
        near(&coupled.rotation, &loaded.rotation, 1e-9);
    }
}

/// Two bars of one mesh with a common end share a force by their stiffness; supports hold only one of them in its
/// directions, so that the coupling holds the other.
#[test]
fn one_point_carries_two_bodies() {
    let bodies = scene! { r#"
[[body]] name = "thick", mesh = { kind = "block", size = [0.1, 0.02], elements = [4, 2] }
material = { young = 2e11, poisson = 0, plane = "stress" }
[[body]] name = "thin", at = [0, 0.05], mesh = { kind = "block", size = [0.1, 0.01], elements = [3, 2] }
material = { young = 2e11, poisson = 0, plane = "stress" }
[time] end = 1, increments = 1
"# };
    let mut mesh = Mesh::clone(&model_of(&bodies).mesh);
    let facets = ["thick:right", "thin:right"].map(|name| mesh.boundary(name).unwrap().facets.clone()).concat();
    mesh.boundaries.push(Boundary { name: "ends".into(), facets });
    let material = parsed(&bodies).description.material;
    let both = Description::new(MeshSource::Given(Arc::new(mesh)), material, vec![1.0])
        .support("thick:left", &[Axis::X, Axis::Y])
        .with_support(Support::new("thin:left", &[Axis::X]))
        .coupling(Coupling::rigid("ends", "ends"))
        .with_support(Support {
            at: Where::Coupling("ends".into()),
            held: vec![Held { direction: Direction::Rotation(Axis::Z), displacement: 0.0 }],
            history: None,
        })
        .load(Load::from(stickslip::body::Action::Force { at: Where::Coupling("ends".into()), force: vec![6e5, 0.0] }));
    let model = Model::build(&both).unwrap();
    assert!(model.constraints.rigid_motions.is_empty(), "{:?}", model.constraints.rigid_motions);
    let report = balanced(&model, bn());
    let end = point(&report, "ends");
    near(&end.displacement, &[6e5 * 0.1 / (2e11 * 0.03), 0.0], 1e-9);
    near(&report.reactions[0].supports[0].force, &[-4e5, 0.0], 1e-9);
    near(&report.reactions[0].supports[1].force, &[-2e5, 0.0], 1e-9);
    // Without the coupling the thin bar may move along y.
    let apart = Description { couplings: Vec::new(), supports: both.supports[..2].to_vec(), loads: Vec::new(), ..both };
    assert_eq!(Model::build(&apart).unwrap().constraints.rigid_motions.len(), 1);
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
    let whole = edit(&BEAM, "moment = 1000", "force = [600, 0]");
    let half = edit(&whole, "size = [100, 10]", "size = [100, 5]");
    let half = edit(&half, "force = [600, 0]", "force = [300, 0]");
    let symmetry = "[[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n";
    let loose = edit(&half, "[[coupling]]", &format!("{symmetry}[[coupling]]"));
    let error = discretise(&parsed(&loose)).unwrap_err().to_string();
    assert!(error.contains("support[1]") || error.contains("holds the node"), "{error}");
    let guided = format!("{symmetry}[[support]]\ncoupling = \"end\"\nfix = [\"y\", \"rotation_z\"]\n[[coupling]]");
    let half = edit(&half, "[[coupling]]", &guided);
    let [whole, half] = [whole, half].map(|text| point(&report(&text, bn()), "end").displacement.clone());
    near(&half[..1], &whole[..1], 1e-9);
}

/// A pushed half of a bar, and a disc at its axis: supports hold carried nodes in directions in which the point does not move.
#[test]
fn moved_points_on_planes_of_symmetry() {
    let support = "[[support]]\ncoupling = \"end\"\nfix = [\"x\", \"y\", \"rotation_z\"]\ndisplacement = [0.3, 0, 0]\n";
    let symmetry = "[[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n";
    let half = edit(&BEAM, "[[load]]\ncoupling = \"end\"\nmoment = 1000\n", &format!("{support}{symmetry}"));
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

/// Faults of the beam.
const OF_BEAM: &str = include_str!("../refused/tables/couplings.txt");

/// Faults of a distributing coupling.
const OF_DISTRIBUTING: &str = r#"
[[load]] | [[support]]¶coupling = "end"¶fix = ["x"]¶[[load]] | - | moves freely | rigid
[[load]] | [[spring]]¶coupling = "end"¶rotational = 1¶[[load]] | - | moves freely | rigid
"#;

/// Faults of the bar.
const OF_BAR: &str = r#"
[[load]] | [[contact]]¶boundary = "bottom"¶friction = 0.3¶obstacle = { kind = "plane" }¶[[load]] | - |
    a rigid coupling carries | end the coupled boundary
moment = [0, 500, 300] | moment = 3 | - | 1 components | [x, y, z]
"#;

/// Each fault of a coupling, and of what acts on it, names its key.
#[test]
fn faults_name_their_keys() {
    let distributing = edit(&BEAM, "name = \"end\"", "name = \"end\"\nkind = \"distributing\"");
    let axisymmetric =
        BEAM.replace("plane = \"stress\"", "plane = \"axisymmetric\"").replace("fix = [\"x\", \"y\"]", "fix = [\"x\"]");
    let on_the_axis = edit(&axisymmetric, "boundary = \"right\"", "boundary = \"left\"");
    let on_the_axis = edit(&on_the_axis, "moment = 1000", "force = [0, 1]");
    let on_the_axis = edit(&on_the_axis, "boundary = \"left\"\nfix = [\"x\"]", "boundary = \"bottom\"\nfix = [\"y\"]");
    let aside = edit(&axisymmetric, "moment = 1000", "force = [0, 1]")
        + "[[support]]\ncoupling = \"end\"\ndirection = [1, 1]\ndisplacement = 0\n";
    let plate = edit(&PUNCH, "[[coupling]]", "[[coupling]]\nname = \"plate\"\nbody = \"plate\"\n[[coupling]]");
    verify_all(&BEAM, OF_BEAM, refused);
    verify_all(&distributing, OF_DISTRIBUTING, refused);
    verify_all(&BAR, OF_BAR, refused);
    verify_all(&axisymmetric, "moment = 1000 | force = [1, 0] | - | along its axis only | [0, y]", refused);
    for (text, message, help) in [
        (&axisymmetric, "does not turn", "remove"),
        (&aside, "off the axis", "fix \"y\""),
        (&plate, "every node", "elastic"),
        (&on_the_axis, "no area", "name another boundary"),
    ] {
        says(&refused(text), message, help);
    }
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
