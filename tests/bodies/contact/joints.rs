//! Pretensions and periodic boundaries: bars and joints in closed form, equal results of all methods, refused inputs.

use crate::common::prelude::*;
use stickslip::run::report::SectionRecord;
use stickslip::run::tightening;

scene! {
/// A bar of two parts between rigid walls, without lateral contraction.
static BAR = r#"
units = { length = "mm", stress = "MPa" }
[[body]] name = "lower"
[body.mesh] kind = "block", size = [10, 40], elements = [3, 4]
[body.material] young = 2e5, poisson = 0
[[body]] name = "upper", at = [0, 40]
[body.mesh] kind = "block", size = [10, 60], elements = [2, 5]
[body.material] young = 2e5, poisson = 0
[[contact]] boundary = "lower:top", against = "upper:bottom", glue = true
[[pretension]] name = "bolt", boundary = "lower:top", force = 1000
[[support]] boundary = "lower:bottom", fix = ["x", "y"]
[[support]] boundary = "upper:top", fix = ["x", "y"]
[time] end = 1, increments = 2
"# }

scene! {
/// A bolt in two parts beside a sleeve, both below a rigid head that moves along the bolt only. The bolt has a stiffness of
/// E A / 40 mm with the area 4 mm (times 1 mm), the sleeve three times as much.
static JOINT = r#"
units = { length = "mm", stress = "MPa" }
[[body]] name = "shank", mesh = { kind = "block", size = [4, 30], elements = [2, 3] }
material = { young = 2e5, poisson = 0 }
[[body]] name = "stud", at = [0, 30], mesh = { kind = "block", size = [4, 10], elements = [3, 2] }
material = { young = 2e5, poisson = 0 }
[[body]] name = "sleeve", at = [6, 0], mesh = { kind = "block", size = [12, 40], elements = [3, 4] }
material = { young = 2e5, poisson = 0 }
[[body]] name = "head", at = [0, 40], mesh = { kind = "block", size = [20, 5], elements = [5, 1] }
material = { young = 1, poisson = 0 }
[[coupling]] name = "head", body = "head"
[[contact]] boundary = "shank:top", against = "stud:bottom", glue = true
[[contact]] boundary = "stud:top", against = "head:bottom", glue = true
[[contact]] boundary = "sleeve:top", against = "head:bottom", friction = 0.2
[[support]] boundary = "shank:bottom", fix = ["x", "y"]
[[support]] boundary = "sleeve:bottom", fix = ["x", "y"]
[[support]] coupling = "head", fix = ["x", "rotation_z"]
[[pretension]] name = "bolt", boundary = "shank:top", force = 1200, history = [[0, 0], [1, 1]], lock = 1
[[load]] coupling = "head", force = [0, 800], history = [[1, 0], [2, 1], [3, 4]]
[time] end = 3, increments = 6
"# }

scene! {
/// A strip that is one period of a layer, below a pressure.
static STRIP = r#"
[mesh] kind = "block", size = [3, 2], elements = [4, 3]
[material] young = 100, poisson = 0.25
[[contact]] boundary = "right", against = "left", glue = true, shift = [3, 0]
[[support]] boundary = "bottom", fix = ["y"]
[[support]] point = [0, 0], fix = ["x"]
[[load]] boundary = "top", pressure = 2
[time] end = 1, increments = 1
"# }

fn report(text: &str, solver: SolverChoice) -> RunReport {
    balanced(&model_of(text), solver)
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
    let forced = report(&BAR, bn());
    let bolt = last(&forced);
    near(bolt.normal_force, 1e6, 1e-9);
    near(bolt.shortening, 1e6 / stiffness, 1e-9);
    near(bolt.displacement[1], 1e6 / stiffness, 1e-9);
    near(section(&forced, 1).normal_force, 5e5, 1e-9);
    near(forced.reactions[1].supports[1].force[1], 1e6, 1e-9);
    let shortened = report(&edit(&BAR, "force = 1000", "shortening = 0.5"), bn());
    near(last(&shortened).normal_force, 5e-4 * stiffness, 1e-9);
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
    near(last(&forced).normal_force, 1e3, 1e-9);
    near(last(&forced).shortening, 1e3 / stiffness, 1e-9);
    let shortened = report(&edit(&text, "force = 1000", "shortening = 0.5"), bn());
    near(last(&shortened).normal_force, 5e-4 * stiffness, 1e-9);
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
        .replace(
            "fix = [\"x\", \"rotation_z\"]",
            "fix = [\"x\", \"y\", \"rotation_x\", \"rotation_y\", \"rotation_z\"]",
        )
        .replace("force = [0, 800]", "force = [0, 0, 800]");
    let pi = std::f64::consts::PI;
    [(JOINT.to_string(), 4e-3, 3.0), (round, pi * 16e-6, (18.0_f64.powi(2) - 36.0) / 16.0), (space, 20e-6, 3.0)]
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
        near(section(&report, 1).normal_force, 0.5 * force, 1e-9);
        near(section(&report, 2).normal_force, force, 1e-9);
        near(section(&report, 2).shortening, force * soft * (1.0 + 1.0 / ratio), 1e-9);
        near(section(&report, 3).normal_force, force + 0.5 * service / (1.0 + ratio), 1e-9);
        near(section(&report, 4).normal_force, force + service / (1.0 + ratio), 1e-9);
        near(section(&report, 4).shortening, section(&report, 2).shortening, 1e-12);
        near(section(&report, 6).normal_force, 4.0 * service, 1e-9);
        let bolt = &report.pretension_forces[0];
        near(bolt.locked_force.unwrap(), force, 1e-9);
        near(bolt.force_range[0], force, 1e-9);
        near(bolt.force_range[1], 4.0 * service, 1e-9);
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
                near(section(&found, index).normal_force, section(&expected, index).normal_force, 1e-7);
            }
        }
    }
}

/// Before it locks, a tightened bolt that only contact holds can move without resistance; the model knows it.
#[test]
fn a_free_section_is_a_rigid_motion() {
    let loose = &BAR[..BAR.find("[[support]]\nboundary = \"upper:top\"").unwrap()];
    let loose = format!("{loose}{}", &BAR[BAR.find("[time]").unwrap()..]);
    let model = tightening(&parsed(&loose)).unwrap();
    assert_eq!(model.constraints.rigid_motions.len(), 1);
    assert!(
        model.constraints.rigid_motions[0].to_string().contains("a translation along (0, "),
        "{}",
        model.constraints.rigid_motions[0]
    );
    let held = edit(&loose, "force = 1000", "shortening = 1");
    assert!(tightening(&parsed(&held)).unwrap().constraints.rigid_motions.is_empty());
    // Without a support the two parts are one body that moves and turns, and may separate.
    let free = edit(&loose, "[[support]]\nboundary = \"lower:bottom\"\nfix = [\"x\", \"y\"]\n", "");
    assert_eq!(tightening(&parsed(&free)).unwrap().constraints.rigid_motions.len(), 4);
}

/// A periodic strip is strained along its height only; with a free period it expands.
#[test]
fn a_periodic_strip_is_pressed() {
    let height = |report: &RunReport| report.reactions[0].loads[0].displacement[1];
    let confined = report(&STRIP, bn());
    near(height(&confined), -2.0 * 2.0 * (1.25 * 0.5) / (100.0 * 0.75), 1e-9);
    let free =
        edit(&STRIP, "[[support]]", "[[pretension]]\nname = \"wall\"\nboundary = \"right\"\nforce = 0\n[[support]]");
    let free = report(&free, bn());
    near(height(&free), -2.0 * 2.0 * (1.0 - 0.0625) / 100.0, 1e-9);
    near(last(&free).shortening, 3.0 * 2.0 * 0.25 * 1.25 / 100.0, 1e-9);
    // Different meshes of both sides.
    let cut = edit(&STRIP, "kind = \"block\"", "kind = \"block\"\ncells = \"triangle6\"");
    near(height(&report(&cut, bn())), height(&confined), 1e-9);
}

/// Bars one behind the other: `1 / E = Σ c / E`. A shear has a moment that the periodic boundaries carry.
#[test]
fn a_laminate_has_its_modulus() {
    let laminate = scene! { r#"
[[body]] name = "soft", mesh = { kind = "block", size = [4, 2], elements = [2, 3] }
material = { young = 100, poisson = 0 }
[[body]] name = "hard", at = [4, 0], mesh = { kind = "block", size = [6, 2], elements = [2, 4] }
material = { young = 300, poisson = 0 }
[[contact]] boundary = "soft:right", against = "hard:left", glue = true
[[contact]] boundary = "hard:right", against = "soft:left", glue = true, shift = [10, 0]
[[pretension]] name = "cell", boundary = "hard:right", shortening = 0.01
[[support]] boundary = "soft:bottom", fix = ["y"]
[[support]] point = [0, 0], fix = ["x"]
[time] end = 1, increments = 1
"# };
    let modulus = 1.0 / (0.4 / 100.0 + 0.6 / 300.0);
    near(last(&report(&laminate, bn())).normal_force, 2.0 * modulus * 0.01 / 10.0, 1e-9);
}

/// An oblique bar in space of second order: tension and shortening are along its axis.
#[test]
fn an_oblique_bolt_is_tightened() {
    let model = tightening(&parsed(&space_bar("tetrahedron10"))).unwrap();
    let axis = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
    let across = [[1.0, 2.0, 0.0].map(|x: f64| x / 5.0_f64.sqrt()), [-4.0, 2.0, 5.0].map(|x: f64| x / 45.0_f64.sqrt())];
    let mut mesh = Mesh::clone(&model.mesh);
    for x in &mut mesh.nodes {
        *x = [0, 1, 2].map(|c| x[0] * across[0][c] + x[1] * across[1][c] + x[2] * axis[c]);
    }
    let given = model.description().clone();
    let turned = Description { mesh: MeshSource::Given(Arc::new(mesh)), ..given };
    let report = balanced(&Model::build(&turned).unwrap(), bn());
    let bolt = last(&report);
    near(bolt.normal_force, 1e3, 1e-9);
    near(bolt.shortening, 1e3 * 0.1 / (2e11 * 2e-5), 1e-9);
    for (c, along) in axis.iter().enumerate() {
        near(bolt.force[c], 1e3 * along, 1e-8);
        near(bolt.displacement[c], bolt.shortening * along, 1e-12);
    }
}

/// The bar in space.
fn space_bar(cells: &str) -> String {
    BAR.replace(
        "size = [10, 40]\nelements = [3, 4]",
        &format!("cells = \"{cells}\"\nsize = [4, 5, 40]\nelements = [2, 1, 3]"),
    )
    .replace(
        "size = [10, 60]\nelements = [2, 5]",
        &format!("cells = \"{cells}\"\nsize = [4, 5, 60]\nelements = [1, 2, 4]"),
    )
    .replace("at = [0, 40]", "at = [0, 0, 40]")
    .replace("fix = [\"x\", \"y\"]", "fix = [\"x\", \"y\", \"z\"]")
}

/// A strip whose period is sheared: the moment of the forces on its ends belongs to the balance.
#[test]
fn a_sheared_strip_balances() {
    let sheared = edit(&STRIP, "pressure = 2", "traction = [1.5, 0]");
    let sheared = edit(&sheared, "fix = [\"y\"]", "fix = [\"x\", \"y\"]");
    let report = report(&sheared, bn());
    near(report.reactions[0].loads[0].displacement[0], 2.0 * 1.5 * 2.0 * 1.25 / 100.0, 1e-9);
}

/// A strip on a wavy obstacle has the forces of a strip that begins half a period later, where the crest is at its ends.
#[test]
fn a_row_of_punches_has_no_beginning() {
    let pressed = edit(
        &STRIP,
        "[[support]]\nboundary = \"bottom\"\nfix = [\"y\"]\n[[support]]\npoint = [0, 0]\nfix = [\"x\"]\n",
        "",
    );
    let pressed = edit(&pressed, "pressure = 2", "traction = [0.3, -2]");
    let wave = "[[contact]]\nboundary = \"bottom\"\nfriction = 0.4\nobstacle = { kind = \"formula\", formula = \"0.05 * (1 - cos(2.0943951023931953 * (x - at)))\" }\n[[load]]";
    let pressed = edit(&pressed, "[[load]]", wave);
    let pressed = edit(&pressed, "[4, 3]", "[12, 6]");
    for choice in
        [bn(), SolverChoice::new(Method::Ip), SolverChoice { linear: Some(LinearAlgebra::condensed()), ..bn() }]
    {
        let [middle, ends] = ["1.5", "0"].map(|at| report(&pressed.replace("- at", &format!("- {at}")), choice));
        let [middle, ends] = [&middle, &ends].map(|report| report.largest_pressure.as_ref().unwrap().pressure);
        near(ends.unwrap(), middle.unwrap(), 1e-6);
    }
}

/// A body that is periodic along two axes, on which gravity acts along the third, in space.
#[test]
fn a_body_is_periodic_along_two_axes() {
    let text = STRIP
        .replace("size = [3, 2]\nelements = [4, 3]", "size = [3, 4, 2]\nelements = [2, 3, 2]")
        .replace(
            "shift = [3, 0]",
            "shift = [3, 0, 0]\n[[contact]]\nboundary = \"back\"\nagainst = \"front\"\nglue = true\nshift = [0, 4, 0]",
        )
        .replace("fix = [\"y\"]", "fix = [\"z\"]")
        .replace("point = [0, 0]\nfix = [\"x\"]", "point = [0, 0, 0]\nfix = [\"x\", \"y\"]");
    let confined = report(&text, bn());
    near(confined.reactions[0].loads[0].displacement[2], -2.0 * 2.0 * (1.25 * 0.5) / (100.0 * 0.75), 1e-9);
    let sections = "[[pretension]]\nname = \"x\"\nboundary = \"right\"\nforce = 0\n[[pretension]]\nname = \"y\"\nboundary = \"back\"\nforce = 0\n[[support]]";
    let free = report(&edit(&text, "[[support]]", sections), bn());
    near(free.reactions[0].loads[0].displacement[2], -2.0 * 2.0 / 100.0, 1e-9);
    near(free.reactions[0].pretensions[0].shortening, 3.0 * 2.0 * 0.25 / 100.0, 1e-9);
    near(free.reactions[0].pretensions[1].shortening, 4.0 * 2.0 * 0.25 / 100.0, 1e-9);
}

/// Two bolts that lock one after the other keep their shortenings.
#[test]
fn bolts_lock_one_after_the_other() {
    let second = JOINT
        [JOINT.find("[[body]]\nname = \"shank\"").unwrap()..JOINT.find("[[body]]\nname = \"sleeve\"").unwrap()]
        .replace("\"shank\"", "\"shank2\"")
        .replace("\"stud\"\nat = [0, 30]", "\"stud2\"\nat = [20, 30]")
        .replace("name = \"shank2\"", "name = \"shank2\"\nat = [20, 0]");
    let contacts = "[[contact]]\nboundary = \"shank2:top\"\nagainst = \"stud2:bottom\"\nglue = true\n[[contact]]\nboundary = \"stud2:top\"\nagainst = \"head:bottom\"\nglue = true\n[[support]]\nboundary = \"shank2:bottom\"\nfix = [\"x\", \"y\"]\n[[pretension]]\nname = \"bolt2\"\nboundary = \"shank2:top\"\nforce = 600\nhistory = [[1, 0], [2, 1]]\nlock = 2\n[[load]]";
    let text = edit(&JOINT, "[[body]]\nname = \"sleeve\"", &format!("{second}[[body]]\nname = \"sleeve\""));
    let text = edit(&text, "size = [20, 5], elements = [5, 1]", "size = [26, 5], elements = [5, 1]");
    let text = edit(&text, "[[load]]", contacts);
    let text = edit(&text, "[[1, 0], [2, 1], [3, 4]]", "[[2, 0], [3, 1]]");
    let report = report(&text, bn());
    // k = 1, 1 and 3 of bolts and sleeve. While the second bolt has its force, the first and the sleeve share it.
    let one = |index| report_section(&report, index, 0);
    let two = |index| report_section(&report, index, 1);
    near(one(2).normal_force, 1200e3, 1e-9);
    near(one(4).normal_force, 1200e3 - 600e3 / 4.0, 1e-9);
    near(two(4).normal_force, 600e3, 1e-9);
    near(one(6).normal_force, 1050e3 + 800e3 / 5.0, 1e-9);
    near(two(6).normal_force, 600e3 + 800e3 / 5.0, 1e-9);
    near(two(6).shortening, two(4).shortening, 1e-12);
    near(one(6).shortening, one(2).shortening, 1e-12);
}

fn report_section(report: &RunReport, index: usize, k: usize) -> &SectionRecord {
    &report.reactions.iter().find(|record| record.index == index).unwrap().pretensions[k]
}

/// A model that is made without a run still has to lock.
#[test]
fn a_lock_needs_the_run_of_a_scene() {
    let model = Model::build(&parsed(&JOINT).description).unwrap();
    let error = Run::of(&model, model.times().to_vec(), bn()).unwrap_err();
    assert!(error.to_string().contains("`bolt` locks") && error.help().unwrap().to_string().contains("discretise"));
}

/// Faults of the bar.
const OF_BAR: &str = include_str!("../refused/tables/pretensions.txt");

/// Faults of the strip.
const OF_STRIP: &str = include_str!("../refused/tables/periods.txt");

/// Two periodic bodies, one on the other: sizes, elements and kinds of cells of each, and the shifts of the periods.
fn periodic_pair(size: &str, bodies: [(&str, &str); 2], height: &str, shifts: &[(&str, &str, &str)]) -> String {
    let body = |(name, at, (elements, cells)): (&str, &str, (&str, &str))| {
        let periods = shifts.iter().map(|(boundary, against, shift)| {
            format!(
                "[[contact]]\nboundary = \"{name}:{boundary}\"\nagainst = \"{name}:{against}\"\nglue = true\nshift = {shift}\n"
            )
        });
        format!(
            "[[body]]\nname = \"{name}\"\nat = {at}\nmesh = {{ kind = \"block\", size = {size}, elements = {elements}, cells = \
             \"{cells}\" }}\nmaterial = {{ young = 10, poisson = 0.3 }}\n{}",
            periods.collect::<String>()
        )
    };
    let origin = if shifts[0].2.matches(',').count() == 2 { "[0, 0, 0]" } else { "[0, 0]" };
    let held = if origin.len() > 6 { "[\"x\", \"y\", \"z\"]" } else { "[\"x\", \"y\"]" };
    format!(
        "{}{}[[contact]]\nboundary = \"up:bottom\"\nagainst = \"lo:top\"\nfriction = 0.3\n[[support]]\nboundary = \
         \"lo:bottom\"\nfix = {held}\n[time]\nend = 1\nincrements = 1\n",
        body(("lo", origin, bodies[0])),
        body(("up", height, bodies[1])),
    )
}

/// Two periodic bodies in contact have one row for the nodes at both ends of a period: a uniform traction goes through, whatever
/// the meshes.
#[test]
fn periodic_bodies_in_contact_pass_a_traction_on() {
    let plane = [("right", "left", "[1, 0]")];
    let space = [("right", "left", "[1, 0, 0]"), ("back", "front", "[0, 1, 0]")];
    let cases = [
        ("[1, 0.5]", "[8, 4]", "[5, 3]", "quadrilateral", "[0, 0.5]", &plane[..]),
        ("[1, 0.5]", "[4, 2]", "[4, 2]", "quadrilateral8", "[0, 0.5]", &plane),
        ("[1, 0.5]", "[4, 2]", "[3, 1]", "triangle6", "[0, 0.5]", &plane),
        ("[1, 1, 0.5]", "[3, 3, 2]", "[2, 3, 2]", "hexahedron", "[0, 0, 0.5]", &space),
        ("[1, 1, 0.5]", "[2, 2, 1]", "[2, 2, 1]", "tetrahedron", "[0, 0, 0.5]", &space),
        ("[1, 1, 0.5]", "[2, 3, 1]", "[3, 2, 1]", "hexahedron20", "[0, 0, 0.5]", &space),
    ];
    for (size, lower, upper, cells, at, shifts) in cases {
        let traction = if shifts.len() == 2 { "[0.15, 0.05, -1]" } else { "[0.15, -1]" };
        let pair = periodic_pair(size, [(lower, cells), (upper, cells)], at, shifts);
        let text = format!("{pair}[[load]]\nboundary = \"up:top\"\ntraction = {traction}\n");
        let report = report(&text, bn());
        assert_eq!(report.status, Status::Converged, "{cells}");
        let pressures = report.largest_pressure.as_ref().unwrap();
        near(pressures.pressure.unwrap(), 1.0, 1e-9);
        let force = &report.boundaries[0].force;
        near(
            force.iter().map(|f| f * f).sum::<f64>(),
            1.0 + 0.0225 + if shifts.len() == 2 { 0.0025 } else { 0.0 },
            1e-9,
        );
        let balance = report.last_reactions.as_ref().unwrap().balance;
        assert!(balance < 1e-12, "{cells}: {balance}");
    }
}

/// A wavy gap between two periodic bodies has no beginning: neither the forces nor the nodes across the contact tell where the
/// period begins.
#[test]
fn a_contact_across_the_end_of_a_period_is_one() {
    let of_crest = |at: &str| {
        let bodies = [("[16, 6]", "quadrilateral"), ("[24, 6]", "quadrilateral")];
        let text = edit(
            &periodic_pair("[1, 0.5]", bodies, "[0, 0.5]", &[("right", "left", "[1, 0]")]),
            "friction = 0.3",
            &format!("friction = 0.3\ngap = \"0.01 * (1 - cos(2 * PI * (x - {at})))\""),
        );
        report(&format!("{text}[[load]]\nboundary = \"up:top\"\ntraction = [0.01, -0.1]\n"), bn())
    };
    let [middle, end] = ["0.5", "0"].map(of_crest);
    let [middle, end] = [&middle, &end].map(|report| report.largest_pressure.as_ref().unwrap());
    near(end.pressure.unwrap(), middle.pressure.unwrap(), 1e-9);
    assert!(end.nodes_across.is_some_and(|nodes| nodes > 5) && end.nodes_across == middle.nodes_across, "{end:?}");
}

/// A lock just after the end of an increment locks there.
#[test]
fn a_lock_beside_the_end_of_an_increment() {
    let [(plane, ..), ..] = joints();
    let last = |lock: &str| last(&report(&edit(&plane, "lock = 1\n", &format!("lock = {lock}\n")), bn())).normal_force;
    near(last("1.0000000001"), last("1"), 1e-9);
    near(last("0.9999999999"), last("1"), 1e-9);
}

/// Each fault of a pretension or a period names its key.
#[test]
fn faults_name_their_keys() {
    let round = BAR.replace("poisson = 0", "poisson = 0\nplane = \"axisymmetric\"");
    let across = round.replace("fix = [\"x\", \"y\"]", "fix = [\"y\"]").replace("at = [0, 40]", "at = [10, 0]");
    let across = across.replace("lower:top", "lower:right").replace("upper:bottom", "upper:left");
    let periodic = STRIP.replace("poisson = 0.25", "poisson = 0.25\nplane = \"axisymmetric\"");
    verify_all(&BAR, OF_BAR, refused);
    verify_all(&STRIP, OF_STRIP, refused);
    says(&refused(&across), "not across the axis", "y = constant");
    says(&refused(&periodic), "along its axis only", "[0, y]");
}
