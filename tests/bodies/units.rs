//! Scenes in units of their own: the same body in SI and in others is the same body.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use crate::common::edit;
use crate::common::faults::BLOCK;
use stickslip::description::{Action, Description, Field};
use stickslip::history::{Observer, Status, Step};
use stickslip::model::Model;
use stickslip::nonlinear::Flow;
use stickslip::problem::State;
use stickslip::report::{Grid, fields};
use stickslip::run::{Recording, Run};
use stickslip::scene::Scene;
use stickslip::units::{LengthUnit, Quantity, StressUnit, UnitSystem, Units};
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet, Piece};

/// The paper's block in mm and MPa.
fn block_in_mm() -> String {
    let units = "[units]\nlength = \"mm\"\nstress = \"MPa\"\n\n[mesh]";
    [
        ("[mesh]", units),
        ("[1.0, 1.0]", "[1000, 1000]"),
        ("210e9", "210e3"),
        ("gap = 1e-5", "gap = 1e-2"),
        ("[0.0, -10e6]", "[0, -10]"),
        ("[-10e6, 0.0]", "[-10, 0]"),
    ]
    .iter()
    .fold(BLOCK.to_string(), |text, (from, to)| edit(&text, from, to))
}

fn scene(text: &str) -> Scene {
    Scene::parse("scene.toml", text, &[]).unwrap()
}

/// The error of a scene, with its remedy.
fn refused(text: &str) -> String {
    let error = Scene::parse("scene.toml", text, &[]).unwrap_err();
    format!("{error}; {}", miette::Diagnostic::help(&error).unwrap())
}

fn run(scene: &Scene) -> Vec<State> {
    let mut recording = Recording::all();
    let report = Run::new(scene).unwrap().solve(&mut recording).unwrap();
    assert_eq!(report.status, Status::Converged);
    recording.increments.into_iter().map(|increment| increment.state).collect()
}

/// In the setting `paper`, too, whose constants are newtons and metres.
#[test]
fn the_block_in_millimetres_has_the_contact_forces_of_the_block_in_metres() {
    for setting in ["paper", "default"] {
        let overrides: Vec<_> = ["mesh.elements=[12,12]", "time.increments=8", &format!("solver.setting={setting}")]
            .iter()
            .map(|text| text.parse().unwrap())
            .collect();
        let [si, mm] = [BLOCK, &block_in_mm()].map(|text| run(&Scene::parse("s.toml", text, &overrides).unwrap()));
        assert!(crate::common::difference(&si, &mm) < 1e-9, "{}", crate::common::difference(&si, &mm));
        assert!(si.last().unwrap().p_n.iter().sum::<f64>() > 1e6);
    }
}

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

const PLANE: &str = r#"
    [mesh]
    kind = "half-plane"
    size = [0.2, 0.1]
    contact_width = 0.02
    contact_elements = 4
    outer_elements = 3
    layers = 4
    [material]
    young = 210e9
    poisson = 0.3
    density = 7850
    expansion = 1.2e-5
    layers = [[0.03, 70e9, 0.33]]
    [[support]]
    boundary = "bottom"
    fix = ["x", "y"]
    displacement = [0, 2e-6]
    [[spring]]
    boundary = "right"
    normal = 3e9
    tangential = 2e9
    [[spring]]
    boundary = "right"
    stiffness = [1e9, 4e9]
    [[spring]]
    point = [0.0, 0.1]
    stiffness = [5e6, 6e6]
    [[contact]]
    boundary = "contact"
    friction = 0.3
    [contact.obstacle]
    kind = "cylinder"
    radius = 0.5
    apex = [0.0, 0.1]
    approach = [[0, 0], [1, 3e-6]]
    motion.translation = [[0, 0, 0], [1, 1e-6, 0]]
    motion.rotation = { through = [0.0, 0.6], history = [[0, 0], [1, 1e-6]] }
    [[load]]
    boundary = "right"
    traction = [1e6, -2e6]
    [[load]]
    boundary = "right"
    pressure = 3e5
    [[load]]
    boundary = "top"
    force = [1e3, 2e3]
    [[load]]
    acceleration = [0, -9.81]
    [[load]]
    rotation = { through = [0.1, 0.05], speed = 10 }
    [[load]]
    temperature = 30
    [time]
    end = 1
    increments = 2
"#;

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
    let (si, inches) = (scene(PLANE), scene(&in_inches(PLANE, IN_INCHES, 2)));
    assert_same(&inches.description, &si.description);
    assert_eq!(inches.description.units, Units::new(LengthUnit::Inch, StressUnit::Ksi));
    assert_eq!(si.description.units, Units::SI);
    Model::new(&inches).unwrap();
}

const SPACE: &str = r#"
    [mesh]
    kind = "block"
    size = [[0.1, 0.3], 0.2, 0.1]
    elements = [[2, 2], 2, 2]
    [material]
    young = 210e9
    poisson = 0.3
    [[material.group]]
    name = "body"
    young = 70e9
    poisson = 0.2
    density = 2700
    [[support]]
    boundary = "left"
    direction = [1, 1, 0]
    displacement = 1e-6
    [[support]]
    point = [0.4, 0.0, 0.1]
    fix = ["x"]
    [[spring]]
    boundary = "right"
    stiffness = [1e9, 4e9, 2e9]
    [[spring]]
    point = [0.4, 0.2, 0.0]
    stiffness = [5e6, 6e6, 7e6]
    [[contact]]
    boundary = "bottom"
    friction = 0.3
    obstacle = { kind = "plane", through = [0.0, 0.0, -1e-5] }
    [[contact]]
    boundary = "top"
    friction = 0.3
    obstacle = { kind = "sphere", radius = 2.0, apex = [0.2, 0.1, 0.1001] }
    [[contact]]
    boundary = "back"
    friction = 0.3
    obstacle = { kind = "wedge", angle = 0.1, apex = [0.2, 0.2001, 0.05], axis = [0, 0, 1] }
    [[contact]]
    boundary = "front"
    friction = 0.3
    obstacle = { kind = "plane", gap = 2e-5 }
    [[contact]]
    boundary = "right"
    friction = 0.3
    [[contact.obstacle]]
    kind = "socket"
    radius = 3.0
    apex = [0.401, 0.1, 0.05]
    normal = [1, 0, 0]
    [[contact.obstacle]]
    kind = "bore"
    radius = 4.0
    apex = [0.402, 0.1, 0.05]
    axis = [0, 0, 1]
    normal = [1, 0, 0]
    [[contact.obstacle]]
    kind = "cone"
    half_angle = 1.4
    apex = [0.403, 0.1, 0.05]
    normal = [1, 0, 0]
    [[contact.obstacle]]
    kind = "surface"
    file = "surface.stl"
    scale = 0.5
    [[load]]
    point = [0.4, 0.2, 0.1]
    force = [1e3, 2e3, 3e3]
    [[load]]
    acceleration = [0, 0, -9.81]
    [time]
    end = 1
    increments = 2
    [[output.probe]]
    name = "line"
    from = [0.1, 0.0, 0.0]
    to = [0.3, 0.2, 0.1]
    points = 3
"#;

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
    let (si, inches) = (scene(SPACE), scene(&in_inches(SPACE, SPACE_IN_INCHES, 3)));
    assert_same(&inches.description, &si.description);
    let [si, inches] = [si, inches].map(|scene| numbers(&format!("{:?}", scene.output.probes)));
    assert_eq!(si.len(), 7);
    assert!(si.iter().zip(&inches).all(|((_, x), (_, y))| (x - y).abs() <= 4e-16 * x.abs()), "{si:?} {inches:?}");
}

/// Formulas get coordinates in the unit of length and give values in the unit of what they stand for.
#[test]
fn formulas_are_written_in_the_units_of_the_scene() {
    let text = edit(&block_in_mm(), "[0, -10]", "['0.001 * x', '-1e-5 * x^2']");
    let text = edit(&text, "{ kind = \"plane\", gap = 1e-2 }", "{ kind = 'formula', formula = '1 + x / 500' }");
    let text = [&text, "\n[[load]]\ntemperature = 'x / 100'\n"].concat();
    let scene = scene(&edit(&text, "poisson = 0.3", "poisson = 0.3\nexpansion = 1e-5"));
    let x = [0.25, 0.0, 0.0];
    let field = |k: usize| match &scene.description.loads[k].action {
        Action::Traction { traction, .. } => traction.iter().map(|t| t.at(x)).collect(),
        Action::Temperature(temperature) => vec![temperature.at(x)],
        other => panic!("{other:?}"),
    };
    let close = |found: f64, expected: f64| assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{found}");
    close(field(0)[0], 0.25e6);
    close(field(0)[1], -0.625e6);
    close(field(2)[0], 2.5);
    let model = Model::new(&scene).unwrap();
    close(model.obstacles[0].0.at(x).gap, 1.5e-3);
    assert!(matches!(&scene.description.loads[0].action, Action::Traction { traction, .. } if
        matches!(&traction[0], Field::Formula(formula) if formula.text() == "0.001 * x")));
}

#[test]
fn a_table_of_gaps_is_in_the_unit_of_length() {
    let folder = std::env::temp_dir().join(format!("stickslip-units-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("gaps.csv"), "x,gap\n0,0.5\n400,0.1\n1000,0.4\n").unwrap();
    let text = edit(&block_in_mm(), "{ kind = \"plane\", gap = 1e-2 }", "{ kind = 'table', file = 'gaps.csv' }");
    fs::write(folder.join("scene.toml"), &text).unwrap();
    let model = Model::new(&Scene::read(&folder.join("scene.toml"), &[]).unwrap());
    fs::remove_dir_all(&folder).unwrap();
    let gap = model.unwrap().obstacles[0].0.at([0.2, 0.0, 0.0]).gap;
    assert!((gap - 3e-4).abs() < 1e-18, "{gap}");
}

/// The scale of a mesh file is the unit of length unless it is given, in that unit.
#[test]
fn a_mesh_file_is_in_the_unit_of_length() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/init/roller.toml");
    let text = fs::read_to_string(&path).unwrap();
    let nodes = |text: &str| {
        let scene = Scene::parse(&path.display().to_string(), text, &[]).unwrap();
        scene.description.mesh.build().unwrap().nodes.clone()
    };
    let metres = nodes(&text);
    let millimetres = [&text, "\n[units]\nlength = \"mm\"\nstress = \"GPa\"\n"].concat();
    let without = edit(&millimetres, "scale = 1e-3", "");
    let largest = metres.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for text in [without, edit(&millimetres, "scale = 1e-3", "scale = 1")] {
        let found = nodes(&text);
        let off = found.iter().flatten().zip(metres.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-15 * largest, "{off}");
    }
    assert!((nodes(&edit(&millimetres, "scale = 1e-3", "scale = 1000"))[0][0] - 1000.0 * metres[0][0]).abs() < 1e-12);
}

#[test]
fn units_that_cannot_be_are_refused() {
    let listed = "use one of the values it lists";
    let form = "`stickslip init block` shows the form of every value";
    for (from, to, line, said, help) in [
        ("\"mm\"", "\"yd\"", 7, "unknown variant `yd`, expected one of `m`, `mm`", listed),
        ("\"MPa\"", "\"N/mm2\"", 8, "unknown variant `N/mm2`, expected one of `Pa`, `kPa`, `MPa`", listed),
        ("\"MPa\"", "\"mpa\"", 8, "unknown variant `mpa`", listed),
        ("\"mm\"", "1e-3", 7, "expected a word in quotes", form),
        ("\"MPa\"", "6", 8, "expected a word in quotes", form),
        ("stress = \"MPa\"\n", "", 6, "missing field `stress`, in `units`", "add the key"),
        ("length = \"mm\"\n", "", 6, "missing field `length`, in `units`", "add the key"),
        ("stress = \"MPa\"", "stress = \"MPa\"\nforce = \"N\"", 9, "unknown field `force`", "remove the key"),
        ("[units]\nlength = \"mm\"\nstress = \"MPa\"", "units = \"mm\"", 6, "expected a table", form),
    ] {
        let error = refused(&edit(&block_in_mm(), from, to));
        assert!(error.starts_with(&format!("scene.toml:{line}: ")), "{to}: {error}");
        assert!(error.contains(said) && error.contains(help), "{to}: {error}");
    }
}

/// A message has the number as it stands in the scene, or says that it is another.
#[test]
fn messages_quote_the_numbers_of_the_scene() {
    let said = |from: &str, to: &str| refused(&edit(&block_in_mm(), from, to));
    assert!(said("210e3", "-210e3").contains("material.young is -210000.0, but must be positive"));
    assert!(said("[1000, 1000]", "[1000, 0]").contains("mesh.size is [1000.0, 0.0]"));
    assert!(said("gap = 1e-2", "gap = 1e60").contains("gap has the number 1e60"));
    assert!(said("210e3", "1e46").contains("in SI units material.young has the number 1e52"));
    let no_model = |text: &str| {
        let error = Model::new(&scene(text)).unwrap_err();
        format!("{error}; {}", miette::Diagnostic::help(&error).unwrap())
    };
    let nowhere = [&block_in_mm(), "\n[[support]]\npoint = [205, 1000]\nfix = [\"x\"]\n"].concat();
    let error = no_model(&nowhere);
    assert!(error.contains("no node of the mesh is at (205, 1000) mm"), "{error}");
    assert!(error.contains("the nearest is at (200, 1000) mm") || error.contains("(210, 1000) mm"), "{error}");
    let deep = edit(&block_in_mm(), "gap = 1e-2", "gap = -500");
    let error = no_model(&deep);
    assert!(error.contains("starts 5e2 mm inside the body") && error.contains("1e3 mm thick"), "{error}");
}

/// The warning of displacements that are not small is as in SI, and names the units.
#[test]
fn a_modulus_in_the_wrong_unit_is_warned_of() {
    // E in GPa beside loads in MPa.
    let overrides = ["mesh.elements=[4,4]", "material.young=21", "solver.setting=default"];
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::parse("s.toml", &block_in_mm(), &overrides).unwrap();
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let message = report.warnings.iter().find(|warning| warning.message.contains("taken as small")).unwrap();
    assert!(message.message.contains("are lengths in mm, moduli and tractions in MPa?"), "{}", message.message);
    assert!(message.message.contains(") mm moves by "), "{}", message.message);
}

/// Every array of a VTU file, by name.
fn arrays(grid: &Grid) -> Vec<(String, Vec<f64>)> {
    let DataSet::UnstructuredGrid { mut pieces, .. } = Vtk::parse_xml(grid.to_vtu().as_bytes()).unwrap().data else {
        panic!("no grid")
    };
    let Piece::Inline(piece) = pieces.pop().unwrap() else { panic!("no piece") };
    let attributes = piece.data.point.into_iter().chain(piece.data.cell);
    let arrays = attributes.map(|attribute| match attribute {
        Attribute::DataArray(array) => (array.name, array.data.cast_into().unwrap()),
        Attribute::Field { .. } => panic!("a field"),
    });
    [("Points".to_string(), piece.points.cast_into().unwrap())].into_iter().chain(arrays).collect()
}

/// The fields of the last increment.
struct Last<'a>(&'a Model, Option<Grid>);

impl Observer for Last<'_> {
    fn increment(&mut self, step: &Step<'_>) -> Flow {
        self.1 = Some(fields(self.0, step));
        Flow::Continue
    }
}

#[test]
fn vtu_files_are_in_the_units_of_the_scene() {
    let overrides: Vec<_> = ["mesh.elements=[5,4]", "time.increments=2"].map(|text| text.parse().unwrap()).to_vec();
    let grid = |text: &str| {
        let scene = Scene::parse("s.toml", text, &overrides).unwrap();
        let run = Run::new(&scene).unwrap();
        let mut last = Last(run.model(), None);
        run.solve(&mut last).unwrap();
        arrays(&last.1.unwrap())
    };
    let (si, mm) = (grid(BLOCK), grid(&block_in_mm()));
    assert_eq!(si.len(), mm.len());
    for ((name, si), (other, mm)) in si.iter().zip(&mm) {
        assert_eq!(name, other);
        let unit = match name.as_str() {
            "Points" | "displacement" | "slip" | "gap" => 1e-3,
            "contact_pressure" | "tangential_traction" | "stress" | "principal_stress" | "von_mises" => 1e6,
            "status" | "material" => 1.0,
            other => panic!("what is the unit of {other}?"),
        };
        let largest = si.iter().filter(|x| x.is_finite()).fold(0.0_f64, |m, x| m.max(x.abs()));
        for (si, mm) in si.iter().zip(mm) {
            let same = (si - unit * mm).abs() <= 1e-9 * largest || (si.is_nan() && mm.is_nan());
            assert!(same, "{name}: {si} and {mm}");
        }
    }
}

/// From Rust, too: numbers are given in any units, results are told in them.
#[test]
fn a_description_says_what_its_numbers_are_in() {
    let units = Units::new(LengthUnit::Millimetre, StressUnit::Megapascal);
    let raw = Description {
        units: Units::SI,
        ..scene(&block_in_mm().replace("[units]\nlength = \"mm\"\nstress = \"MPa\"\n", "")).description
    };
    let given = raw.given_in(units);
    assert_eq!(given, scene(&block_in_mm()).description);
    assert_eq!(given.system(2), UnitSystem { units, dimension: 2 });
    assert_eq!(given.system(2).name(Quantity::Force), "N/mm");
}
