//! Scenes with named units describe the same body as in SI.

#![allow(clippy::unwrap_used)]

use crate::common::edit;
use crate::common::scenes::BLOCK;
use crate::common::vtu::{Array, Piece};
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use stickslip::base::{Field, LengthUnit, Quantity, StressUnit, UnitSystem, Units};
use stickslip::body::{Action, Description, Model};
use stickslip::run::{Recording, Run, discretise};
use stickslip::scene::Scene;
use stickslip::solver::State;
use stickslip::solver::history::{IncrementView, Observer, Status};
use stickslip_output::{Grid, fields};

/// Returns the paper's block in mm and MPa.
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

/// Returns the error of a scene, with its cure.
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

/// This includes the setting `paper`, whose constants are in newtons and metres.
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

/// Formulas take coordinates in the unit of length, and return values in the unit of their quantity.
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
    let model = discretise(&scene).unwrap();
    close(model.contact.obstacles[0].0.at(x).gap, 1.5e-3);
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
    let model = discretise(&Scene::read(&folder.join("scene.toml"), &[]).unwrap());
    fs::remove_dir_all(&folder).unwrap();
    let gap = model.unwrap().contact.obstacles[0].0.at([0.2, 0.0, 0.0]).gap;
    assert!((gap - 3e-4).abs() < 1e-18, "{gap}");
}

/// The scale of a mesh file is given in the unit of length, which is also its default.
#[test]
fn a_mesh_file_is_in_the_unit_of_length() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("data/init/roller.toml");
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

/// A message quotes a number as given in the scene, or states that it is another.
#[test]
fn messages_quote_the_numbers_of_the_scene() {
    let said = |from: &str, to: &str| refused(&edit(&block_in_mm(), from, to));
    assert!(said("210e3", "-210e3").contains("material.young is -210000.0, but must be positive"));
    assert!(said("[1000, 1000]", "[1000, 0]").contains("mesh.size is [1000.0, 0.0]"));
    assert!(said("gap = 1e-2", "gap = 1e60").contains("gap has the number 1e60"));
    assert!(said("210e3", "1e46").contains("in SI units material.young has the number 1e52"));
    let no_model = |text: &str| {
        let error = discretise(&scene(text)).unwrap_err();
        format!("{error}; {}", miette::Diagnostic::help(&error).unwrap())
    };
    let nowhere = [&block_in_mm(), "\n[[support]]\npoint = [205, 1000]\nfix = [\"x\"]\n"].concat();
    let error = no_model(&nowhere);
    assert!(error.contains("no node of the mesh is at (205, 1000) mm"), "{error}");
    assert!(error.contains("the nearest is at (200, 1000) mm") || error.contains("(210, 1000) mm"), "{error}");
    let deep = edit(&block_in_mm(), "gap = 1e-2", "gap = -500");
    let error = no_model(&deep);
    assert!(error.contains("starts 500 mm inside the body") && error.contains("1000 mm thick"), "{error}");
}

/// The warning of large displacements is the same as in SI, and names the units.
#[test]
fn a_modulus_in_the_wrong_unit_is_warned_of() {
    // E in GPa together with loads in MPa.
    let overrides = ["mesh.elements=[4,4]", "material.young=21", "solver.setting=default"];
    let overrides: Vec<_> = overrides.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::parse("s.toml", &block_in_mm(), &overrides).unwrap();
    let report = Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    let message = report.warnings.iter().find(|warning| warning.message.contains("assumed to be small")).unwrap();
    assert!(message.message.contains("are lengths in mm, moduli and tractions in MPa?"), "{}", message.message);
    assert!(message.message.contains(") mm moves by "), "{}", message.message);
}

/// Returns every array of a VTU file.
fn arrays(grid: &Grid) -> Vec<Array> {
    let Piece { points, point, cell, .. } = Piece::read(&grid.to_string());
    let points = Array { name: "Points".to_string(), components: 3, values: points };
    [points].into_iter().chain(point).chain(cell).collect()
}

/// Observer that keeps the fields of the last increment.
struct Last<'a>(&'a Model, Option<Grid>);

impl Observer for Last<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        self.1 = Some(fields(self.0, step));
        ControlFlow::Continue(())
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
    for (Array { name, values: si, .. }, Array { name: other, values: mm, .. }) in si.iter().zip(&mm) {
        assert_eq!((name, si.len()), (other, mm.len()));
        let unit = match name.as_str() {
            "Points" | "displacement" | "slip" | "opening" => 1e-3,
            "contact_pressure"
            | "tangential_traction"
            | "stress"
            | "principal_stress"
            | "von_mises"
            | "nodal_stress"
            | "nodal_von_mises" => 1e6,
            "contact" | "material" | "discretisation_error" => 1.0,
            other => panic!("what is the unit of {other}?"),
        };
        let largest = si.iter().filter(|x| x.is_finite()).fold(0.0_f64, |m, x| m.max(x.abs()));
        for (si, mm) in si.iter().zip(mm) {
            let same = (si - unit * mm).abs() <= 1e-9 * largest || (si.is_nan() && mm.is_nan());
            assert!(same, "{name}: {si} and {mm}");
        }
    }
}

/// From Rust numbers are SI, and results may use other units.
#[test]
fn a_description_says_what_its_results_are_in() {
    let units = Units::new(LengthUnit::Millimetre, StressUnit::Megapascal);
    let given = Description { units, ..scene(BLOCK).description };
    assert_eq!(given, scene(&block_in_mm()).description);
    assert_eq!(given.system(2), UnitSystem::new(units, 2));
    assert_eq!(given.system(2).name(Quantity::Force), "N/mm");
}
