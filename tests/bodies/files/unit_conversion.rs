//! Every number of a scene in units of its own is converted.

use crate::common::prelude::*;

/// The numbers in a text, each with the text before it.
fn numbers(text: &str) -> Vec<(String, f64)> {
    let part = |c: char| c.is_ascii_digit() || ".e-".contains(c);
    let mut found = Vec::new();
    let (mut words, mut number) = (String::new(), String::new());
    for c in text.chars().chain([' ']) {
        if part(c) && !(number.is_empty() && !(c.is_ascii_digit() || c == '-')) {
            number.push(c);
        } else {
            if let Ok(x) = number.parse() {
                found.push((std::mem::take(&mut words), x));
            } else {
                words += &number;
            }
            number.clear();
            words.push(c);
        }
    }
    found
}

/// Equal but for the rounding of numbers.
#[track_caller]
fn assert_same(found: &Description, expected: &Description) {
    let [found, expected] =
        [found, expected].map(|d| numbers(&format!("{:?}", Description { units: Units::SI, ..d.clone() })));
    assert_eq!(found.len(), expected.len());
    for ((words, x), (others, y)) in found.iter().zip(&expected) {
        assert!(words == others && (x - y).abs() <= 4e-16 * y.abs(), "{words}: {x}, not {y}");
    }
}

scene! {
static PLANE = r#"
[mesh] kind = "half-plane", size = [0.2, 0.1], contact_width = 0.02, contact_elements = 4, outer_elements = 3
layers = 4
[material] young = 210e9, poisson = 0.3, density = 7850, expansion = 1.2e-5, layers = [[0.03, 70e9, 0.33]]
[[support]] boundary = "bottom", fix = ["x", "y"], displacement = [0, 2e-6]
[[spring]] boundary = "right", normal = 3e9, tangential = 2e9
[[spring]] boundary = "right", stiffness = [1e9, 4e9]
[[spring]] point = [0.0, 0.1], stiffness = [5e6, 6e6]
[[contact]] boundary = "contact", friction = 0.3
[contact.obstacle] kind = "cylinder", radius = 0.5, apex = [0.0, 0.1], approach = [[0, 0], [1, 3e-6]]
motion.translation = [[0, 0, 0], [1, 1e-6, 0]]
motion.rotation = { through = [0.0, 0.6], history = [[0, 0], [1, 1e-6]] }
[[load]] boundary = "right", traction = [1e6, -2e6]
[[load]] boundary = "right", pressure = 3e5
[[load]] boundary = "top", force = [1e3, 2e3]
[[load]] acceleration = [0, -9.81]
[[load]] rotation = { through = [0.1, 0.05], speed = 10 }
[[load]] temperature = 30
[time] end = 1, increments = 2
"# }

const IN_INCHES: &[(&str, &str)] = &[
    ("[mesh]", "[units]\nlength = 'in'\nstress = 'ksi'\n[mesh]"),
    ("size = [0.2, 0.1]", "size = [LENGTH(0.2), LENGTH(0.1)]"),
    ("contact_width = 0.02", "contact_width = LENGTH(0.02)"),
    ("young = 210e9", "young = STRESS(210e9)"),
    ("density = 7850", "density = DENSITY(7850)"),
    ("[0.03, 70e9, 0.33]", "[LENGTH(0.03), STRESS(70e9), 0.33]"),
    ("[0, 2e-6]", "[0, LENGTH(2e-6)]"),
    ("normal = 3e9", "normal = FOUNDATION(3e9)"),
    ("tangential = 2e9", "tangential = FOUNDATION(2e9)"),
    ("[1e9, 4e9]", "[FOUNDATION(1e9), FOUNDATION(4e9)]"),
    ("point = [0.0, 0.1]", "point = [0.0, LENGTH(0.1)]"),
    ("[5e6, 6e6]", "[SPRING(5e6), SPRING(6e6)]"),
    ("radius = 0.5", "radius = LENGTH(0.5)"),
    ("apex = [0.0, 0.1]", "apex = [0.0, LENGTH(0.1)]"),
    ("[1, 3e-6]", "[1, LENGTH(3e-6)]"),
    ("[1, 1e-6, 0]", "[1, LENGTH(1e-6), 0]"),
    ("through = [0.0, 0.6]", "through = [0.0, LENGTH(0.6)]"),
    ("[1e6, -2e6]", "[STRESS(1e6), STRESS(-2e6)]"),
    ("pressure = 3e5", "pressure = STRESS(3e5)"),
    ("[1e3, 2e3]", "[FORCE(1e3), FORCE(2e3)]"),
    ("-9.81", "LENGTH(-9.81)"),
    ("[0.1, 0.05]", "[LENGTH(0.1), LENGTH(0.05)]"),
];

/// The size of a unit of inch and ksi, in SI units, as a handbook has them: 1 ksi = 1000 lbf/in², 1 lbf = 0.45359237 kg · g.
fn handbook(quantity: &str, dimension: usize) -> f64 {
    let (inch, lbf) = (0.0254, 4.448_221_615_260_5);
    let ksi = 1000.0 * lbf / (inch * inch);
    match (quantity, dimension) {
        ("LENGTH", _) => inch,
        ("STRESS", _) => ksi,
        // A thousand lbf s²/in for each in³.
        ("DENSITY", _) => 1000.0 * lbf / inch / inch.powi(3),
        ("FOUNDATION", _) => 1000.0 * lbf / inch.powi(3),
        ("SPRING", 3) => 1000.0 * lbf / inch,
        ("FORCE", 3) => 1000.0 * lbf,
        // Per inch of depth.
        ("SPRING", _) => 1000.0 * lbf / inch / inch,
        ("FORCE", _) => 1000.0 * lbf / inch,
        other => panic!("{other:?}"),
    }
}

/// `text` with its numbers in words, such as `LENGTH(0.1)`, in inches and ksi.
fn in_inches(text: &str, changes: &[(&str, &str)], dimension: usize) -> String {
    let mut text = changes.iter().fold(text.to_string(), |text, (from, to)| edit(&text, from, to));
    for quantity in ["LENGTH", "STRESS", "DENSITY", "FOUNDATION", "SPRING", "FORCE"] {
        while let Some(start) = text.find(&format!("{quantity}(")) {
            let (open, end) = (start + quantity.len() + 1, start + text[start..].find(')').unwrap());
            let number: f64 = text[open..end].parse().unwrap();
            text.replace_range(start..=end, &format!("{:?}", number / handbook(quantity, dimension)));
        }
    }
    text
}

#[test]
fn every_number_of_a_plane_scene_is_converted() {
    let (si, inches) = (parsed(&PLANE), parsed(&in_inches(&PLANE, IN_INCHES, 2)));
    assert_same(&inches.description, &si.description);
    assert_eq!(inches.description.units, Units::new(LengthUnit::Inch, StressUnit::Ksi));
    assert_eq!(si.description.units, Units::SI);
    discretise(&inches).unwrap();
}

scene! {
static SPACE = r#"
[mesh] kind = "block", size = [[0.1, 0.3], 0.2, 0.1], elements = [[2, 2], 2, 2]
[material] young = 210e9, poisson = 0.3
[[material.group]] name = "body", young = 70e9, poisson = 0.2, density = 2700
[[support]] boundary = "left", direction = [1, 1, 0], displacement = 1e-6
[[support]] point = [0.4, 0.0, 0.1], fix = ["x"]
[[spring]] boundary = "right", stiffness = [1e9, 4e9, 2e9]
[[spring]] point = [0.4, 0.2, 0.0], stiffness = [5e6, 6e6, 7e6]
[[contact]] boundary = "bottom", friction = 0.3, obstacle = { kind = "plane", through = [0.0, 0.0, -1e-5] }
[[contact]] boundary = "top", friction = 0.3
obstacle = { kind = "sphere", radius = 2.0, apex = [0.2, 0.1, 0.1001] }
[[contact]] boundary = "back", friction = 0.3
obstacle = { kind = "wedge", angle = 0.1, apex = [0.2, 0.2001, 0.05], axis = [0, 0, 1] }
[[contact]] boundary = "front", friction = 0.3, obstacle = { kind = "plane", gap = 2e-5 }
[[contact]] boundary = "right", friction = 0.3
[[contact.obstacle]] kind = "socket", radius = 3.0, apex = [0.401, 0.1, 0.05], normal = [1, 0, 0]
[[contact.obstacle]] kind = "bore", radius = 4.0, apex = [0.402, 0.1, 0.05], axis = [0, 0, 1], normal = [1, 0, 0]
[[contact.obstacle]] kind = "cone", half_angle = 1.4, apex = [0.403, 0.1, 0.05], normal = [1, 0, 0]
[[contact.obstacle]] kind = "surface", file = "surface.stl", scale = 0.5
[[load]] point = [0.4, 0.2, 0.1], force = [1e3, 2e3, 3e3]
[[load]] acceleration = [0, 0, -9.81]
[time] end = 1, increments = 2
[[output.probe]] name = "line", from = [0.1, 0.0, 0.0], to = [0.3, 0.2, 0.1], points = 3
"# }

const SPACE_IN_INCHES: &[(&str, &str)] = &[
    ("[mesh]", "[units]\nlength = 'in'\nstress = 'ksi'\n[mesh]"),
    ("[[0.1, 0.3], 0.2, 0.1]", "[[LENGTH(0.1), LENGTH(0.3)], LENGTH(0.2), LENGTH(0.1)]"),
    ("210e9", "STRESS(210e9)"),
    ("70e9", "STRESS(70e9)"),
    ("2700", "DENSITY(2700)"),
    ("displacement = 1e-6", "displacement = LENGTH(1e-6)"),
    ("point = [0.4, 0.0, 0.1]", "point = [LENGTH(0.4), 0, LENGTH(0.1)]"),
    ("[1e9, 4e9, 2e9]", "[FOUNDATION(1e9), FOUNDATION(4e9), FOUNDATION(2e9)]"),
    ("point = [0.4, 0.2, 0.0]", "point = [LENGTH(0.4), LENGTH(0.2), 0]"),
    ("[5e6, 6e6, 7e6]", "[SPRING(5e6), SPRING(6e6), SPRING(7e6)]"),
    ("through = [0.0, 0.0, -1e-5]", "through = [0, 0, LENGTH(-1e-5)]"),
    (
        "radius = 2.0, apex = [0.2, 0.1, 0.1001]",
        "radius = LENGTH(2.0), apex = [LENGTH(0.2), LENGTH(0.1), LENGTH(0.1001)]",
    ),
    ("[0.2, 0.2001, 0.05]", "[LENGTH(0.2), LENGTH(0.2001), LENGTH(0.05)]"),
    ("gap = 2e-5", "gap = LENGTH(2e-5)"),
    ("radius = 3.0", "radius = LENGTH(3.0)"),
    ("[0.401, 0.1, 0.05]", "[LENGTH(0.401), LENGTH(0.1), LENGTH(0.05)]"),
    ("radius = 4.0", "radius = LENGTH(4.0)"),
    ("[0.402, 0.1, 0.05]", "[LENGTH(0.402), LENGTH(0.1), LENGTH(0.05)]"),
    ("[0.403, 0.1, 0.05]", "[LENGTH(0.403), LENGTH(0.1), LENGTH(0.05)]"),
    ("scale = 0.5", "scale = LENGTH(0.5)"),
    ("point = [0.4, 0.2, 0.1]", "point = [LENGTH(0.4), LENGTH(0.2), LENGTH(0.1)]"),
    ("from = [0.1, 0.0, 0.0]", "from = [LENGTH(0.1), 0, 0]"),
    ("to = [0.3, 0.2, 0.1]", "to = [LENGTH(0.3), LENGTH(0.2), LENGTH(0.1)]"),
    ("[1e3, 2e3, 3e3]", "[FORCE(1e3), FORCE(2e3), FORCE(3e3)]"),
    ("-9.81", "LENGTH(-9.81)"),
];

#[test]
fn every_number_of_a_scene_in_space_is_converted() {
    let (si, inches) = (parsed(&SPACE), parsed(&in_inches(&SPACE, SPACE_IN_INCHES, 3)));
    assert_same(&inches.description, &si.description);
    let [si, inches] = [si, inches].map(|scene| numbers(&format!("{:?}", scene.output.probes)));
    assert_eq!(si.len(), 7);
    assert!(si.iter().zip(&inches).all(|((_, x), (_, y))| (x - y).abs() <= 4e-16 * x.abs()), "{si:?} {inches:?}");
}

/// A plate of 20 mm carries 20 times the force per mm; forces, energies and their units in results are those of the whole
/// body.
#[test]
fn a_plane_body_has_a_thickness() {
    for (units, length, young, gap) in
        [("units = { length = \"mm\", stress = \"MPa\" }\n", 1e3, 2e5, 0.0), ("", 1.0, 2e11, 0.0)]
    {
        let scene = |thickness: &str, force: f64, stiffness: f64| {
            let text = format!(
                "{units}[mesh]\nkind = \"block\"\nsize = [{}, {}]\nelements = [6, 3]\n[material]\nyoung = {young:e}\n\
                 poisson = 0.3\nplane = \"stress\"\n{thickness}\n[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n\
                 [[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {{ kind = \"plane\", gap = {gap} }}\n\
                 [[spring]]\npoint = [{}, {}]\nstiffness = [0, {stiffness:e}]\n\
                 [[load]]\nboundary = \"top\"\nforce = [{}, {}]\n[time]\nend = 1\nincrements = 2\n",
                0.1 * length,
                0.05 * length,
                0.1 * length,
                0.05 * length,
                0.5 * force,
                -force
            );
            parsed(&text)
        };
        let solved = |scene: &Scene| {
            let model = discretise(scene).unwrap();
            let report = Run::of(&model, model.times().to_vec(), bn()).unwrap().solve(&mut ());
            let report = report.unwrap();
            assert_eq!(report.status, Status::Converged);
            (report.to_value().unwrap(), report)
        };
        let thin = solved(&scene("", 1000.0 / 20.0 * if length > 1.0 { 1.0 } else { 1e3 }, 3e3));
        let thick = solved(&scene(&format!("thickness = {}", 0.02 * length), 1000.0, 3e3 * 0.02 * length));
        let number = |report: &serde_json::Value, pointer: &str| report.pointer(pointer).unwrap().as_f64().unwrap();
        // The SI numbers are per m of depth in both.
        let [a, b] = [&thin.1, &thick.1].map(|report| report.reactions[1].supports[0].force[1]);
        assert!((a - b).abs() < 1e-9 * a.abs(), "{a} {b}");
        for (pointer, factor) in [
            ("/reactions/1/supports/0/force/1", 0.02),
            ("/reactions/1/springs/0/force/1", 0.02),
            ("/reactions/1/loads/0/moment/0", 0.02),
            ("/boundaries/0/sum_p_n", 0.02),
            ("/increments/1/friction_work", 0.02),
            ("/increments/1/strain_energy", 0.02),
            ("/largest_displacement/length", f64::NAN),
        ] {
            let [of_thin, of_thick] = [&thin.0, &thick.0].map(|report| number(report, pointer));
            // Lengths of the user: 0.02 m are 20 mm.
            let factor = if factor.is_nan() { 1.0 } else { factor * length };
            assert!((of_thick - factor * of_thin).abs() < 1e-9 * of_thick.abs(), "{pointer}: {of_thin} {of_thick}");
        }
        assert_eq!(thick.0.pointer("/units/force/name").unwrap(), "N");
        assert_eq!(thick.1.units.name(Quantity::Energy), if length > 1.0 { "mJ" } else { "J" });
    }
}

#[test]
fn a_thickness_that_cannot_be_is_refused() {
    let plane = "[mesh]\nkind = \"block\"\nsize = [1, 1]\nelements = [1, 1]\n[material]\nyoung = 1\npoisson = 0\n";
    let rest = "[[support]]\nboundary = \"left\"\nfix = [\"x\", \"y\"]\n[time]\nend = 1\nincrements = 1\n";
    let space = plane.replace("[1, 1]", "[1, 1, 1]");
    for (text, says) in [
        (format!("{plane}thickness = 0\n{rest}"), "thickness"),
        (format!("{plane}thickness = nan\n{rest}"), "thickness"),
        (format!("{plane}thickness = -3\n{rest}"), "thickness"),
        (format!("{plane}thickness = 1\nplane = \"axisymmetric\"\n{rest}"), "no thickness"),
        (format!("{space}thickness = 1\n{rest}"), "three dimensions"),
    ] {
        let message = refused(&text).to_string();
        assert!(message.contains(says) && message.starts_with("scene.toml:8"), "{message}");
    }
}
