//! `stickslip converge`: a quantity is known to the asked share, or the program says why not.

#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::fs;

use stickslip::scene::Scene;
use stickslip_cli::converge::{Limits, Plan, compute};

use crate::program::{Folder, assert_exit, flat, json, number, stderr, stdout, stickslip};

/// Hertz's cylinder on a half-plane.
const LINE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/hertz_line.toml");
const PUNCH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/tutorials/punch.toml");

fn converge<'a>(scene: &'a str, sought: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&["converge", scene, "--for", sought], more].concat()
}

#[test]
fn a_peak_is_known_to_two_percent() {
    let folder = Folder::new();
    let out = folder.join("out");
    let output = stickslip(&converge(LINE, "peak", &["--to", "0.02", "--out", &out]));
    assert_exit(&output, 0);
    assert!(stdout(&output).lines().all(|line| line.chars().count() <= 100), "{}", stdout(&output));
    let text = flat(&output);
    let (verdict, _) = text.split_once(" verdict ").unwrap().1.split_once("fine enough for 2.0 %").unwrap();
    assert!(verdict.starts_with("the peak pressure is 53.6") && !verdict.contains("own mesh"), "{text}");
    assert!(text.contains("the scene's own mesh 48 + 48, 28 layers is fine enough"), "{text}");
    assert_eq!(folder.names("out"), ["converge.csv", "converge.json", "converge.svg"]);
    let table = fs::read_to_string(folder.join("out/converge.csv")).unwrap();
    assert!(table.starts_with("mesh,elements,increments,peak,change,resolved,seconds\n\"12 + 12, 7 layers\",168,1,"));
    let study: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("out/converge.json")).unwrap()).unwrap();
    assert_eq!((study["verdict"].as_str(), study["unit"].as_str()), (Some("known"), Some("Pa")));
    assert_eq!(study["runs"].as_array().unwrap().len() + 1, table.lines().count());
    assert!(number(&study["uncertainty"]) <= 0.02 && number(&study["uncertainty_increments"]) == 0.0, "{study}");
    // Eight times as fine: 53.505 MPa.
    assert!((number(&study["extrapolated"]) / 53.505e6 - 1.0).abs() < 2e-3, "{study}");
    let svg = fs::read_to_string(folder.join("out/converge.svg")).unwrap();
    for text in ["element size, relative to the finest mesh", "extrapolated", "peak pressure [MPa]"] {
        assert!(svg.contains(text), "{text}");
    }
}

/// The last run is that of `stickslip run` to the last bit.
#[test]
fn values_are_those_of_a_run() {
    let study = stickslip(&converge(LINE, "peak", &["--json"]));
    let run = stickslip(&["run", LINE, "--json"]);
    let (study, run) = (json(&study), json(&run));
    assert_eq!(study["value"], run["largest_pressure"]["pressure"]);
    // Any number of a report or of the forces is known in the same way.
    for (quantity, unit) in [("largest_pressure.mean_pressure", "Pa"), ("last:contact.sum_p_n", "N/m")] {
        let study = json(&stickslip(&converge(LINE, quantity, &["--to", "0.2", "--json"])));
        assert_eq!(
            (&study["verdict"], &study["unit"], &study["quantity"]),
            (&"known".into(), &unit.into(), &quantity.into())
        );
    }
    let set = ["--set", "mesh.elements=[[5,7,6],8]", "--set", "mesh.grading=[[1,1,20],0.1]"];
    let more = [&set[..], &["--to", "0.5", "--json"]].concat();
    let study = json(&stickslip(&converge(PUNCH, "friction_work", &more)));
    let last = study["runs"].as_array().unwrap().last().unwrap().clone();
    let mesh = format!("mesh.elements={}", last["mesh"].as_str().unwrap());
    let increments = format!("time.increments={}", last["increments"]);
    let run = stickslip(&[
        "run",
        PUNCH,
        "--json",
        "--set",
        &mesh,
        "--set",
        "mesh.grading=[[1,1,20],0.1]",
        "--set",
        &increments,
    ]);
    let increments = json(&run)["increments"].as_array().unwrap().clone();
    let work: f64 = increments.iter().map(|increment| number(&increment["friction_work"])).sum();
    assert!((number(&study["value"]) / work - 1.0).abs() < 1e-12, "{study}");
}

#[test]
fn mesh_and_increments_are_refined_in_turn() {
    let set = ["--set", "mesh.elements=[[5,7,6],8]", "--set", "mesh.grading=[[1,1,20],0.1]"];
    let output = stickslip(&converge(PUNCH, "friction_work", &[&set[..], &["--to", "0.1", "--json"]].concat()));
    let study = json(&output);
    assert_exit(&output, 0);
    let runs = study["runs"].as_array().unwrap();
    for pair in runs.windows(2) {
        let same = |key: &str| pair[0][key] == pair[1][key];
        assert!(same("mesh") != same("increments"), "{study}");
    }
    assert!(number(&study["uncertainty_increments"]) > 0.0 && number(&study["uncertainty_mesh"]) > 0.0);
    assert!((number(&study["order_increments"]) - 1.0).abs() < 0.3, "{study}");
}

#[test]
fn singular_peaks_have_no_mesh() {
    let sharp = "contact.obstacle.formula=\"0.1 * max(0, x - 5)\"";
    let set = ["--set", sharp, "--set", "mesh.elements=[[4,6,5],8]", "--set", "mesh.grading=[[1,1,20],0.1]"];
    let output = stickslip(&converge(PUNCH, "peak", &set));
    assert_exit(&output, 1);
    let text = flat(&output);
    assert!(text.contains("no mesh will do: the pressure is singular at (5, 50) mm on `top`"), "{text}");
    assert!(text.contains("--for force") && !text.contains("extrapolated"), "{text}");
    // The force has a limit.
    let output = stickslip(&converge(PUNCH, "force", &[&set[..], &["--to", "0.05"]].concat()));
    assert_exit(&output, 0);
}

#[test]
fn limits_and_failures_end_with_status_1() {
    let output = stickslip(&converge(LINE, "peak", &["--to", "1e-6", "--max-runs", "3"]));
    assert_exit(&output, 1);
    assert!(flat(&output).contains("3 runs are done (--max-runs)"), "{}", stdout(&output));
    let output = stickslip(&converge(LINE, "peak", &["--to", "1e-6", "--within", "0.01"]));
    assert_exit(&output, 1);
    assert!(flat(&output).contains("(--within)"), "{}", stdout(&output));
    let output = stickslip(&converge(LINE, "peak", &["--to", "1e-6", "--meshes", "12,24,48", "--json"]));
    assert_exit(&output, 1);
    let study = json(&output);
    assert_eq!((study["verdict"].as_str(), study["runs"].as_array().unwrap().len()), (Some("no-finer-mesh"), 3));
    let output = stickslip(&converge(PUNCH, "peak", &["--set", "solver.max_iterations=1"]));
    assert_exit(&output, 1);
    assert!(flat(&output).contains("did not converge"), "{}", stdout(&output));
}

#[test]
fn bad_questions_are_refused() {
    let output = stickslip(&converge(LINE, "friction_work", &[]));
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("the scene has no friction work"), "{}", stderr(&output));
    assert!(stderr(&output).contains("ask for peak, force"), "{}", stderr(&output));
    for (more, word) in [
        (["--to", "2"], "between 0 and 1"),
        (["--meshes", "a.msh"], "generates its mesh"),
        (["--ratio", "1"], "from 1.2 to 4"),
    ] {
        let output = stickslip(&converge(LINE, "peak", &more));
        assert_exit(&output, 2);
        assert!(stderr(&output).contains(word), "{}", stderr(&output));
    }
    let output = stickslip(&converge(LINE, "pressure", &[]));
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("peak, force, friction_work, stick_ratio"), "{}", stderr(&output));
    for (quantity, word) in [("max:nowhere.f_x", "is at `nowhere`"), ("status", "`status` is no number")] {
        let output = stickslip(&converge(LINE, quantity, &[]));
        assert_exit(&output, 2);
        assert!(stderr(&output).replace("\n  │ ", " ").contains(word), "{}", stderr(&output));
    }
    let output = stickslip(&converge(LINE, "peak", &["--meshes", "24,12,6"]));
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("from coarse to fine"), "{}", stderr(&output));
}

/// Files of other programs stay as they are. Earlier results are replaced.
#[test]
fn foreign_files_are_not_replaced() {
    let folder = Folder::new();
    let out = folder.join("out");
    fs::create_dir(&out).unwrap();
    for name in ["converge.csv", "converge.svg"] {
        let file = folder.0.join("out").join(name);
        fs::write(&file, "mine").unwrap();
        let output = stickslip(&converge(LINE, "force", &["--to", "0.5", "--out", &out]));
        assert_exit(&output, 2);
        let words = stderr(&output).replace("\n  │ ", " ");
        assert!(words.contains(name) && words.contains("was not written by stickslip"), "{words}");
        assert_eq!(fs::read_to_string(&file).unwrap(), "mine");
        fs::remove_file(&file).unwrap();
    }
    for _ in 0..2 {
        assert_exit(&stickslip(&converge(LINE, "force", &["--to", "0.5", "--out", &out])), 0);
    }
}

/// A body on a floor, with a mesh file.
const FILE: &str = "mesh = { kind = 'gmsh', file = 'a.msh' }
    material = { young = 1e9, poisson = 0.3 }
    support = [{ boundary = 'top', fix = ['x', 'y'] }]
    contact = [
      { boundary = 'bottom', friction = 0.3, obstacle = { kind = 'plane', approach = [[0, 0], [1, 1e-3]] } },
    ]
    time = { end = 1, increments = 2 }";

/// A mesh file of quadrilaterals has finer ones only by name.
#[test]
fn mesh_files_are_named() {
    let (folder, file) = Folder::with_scene(FILE);
    fs::write(folder.join("a.msh"), include_str!("../../../../data/meshes/plate_quads_mm.msh")).unwrap();
    let output = stickslip(&converge(&file, "peak", &[]));
    assert_exit(&output, 2);
    let words = stderr(&output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    assert!(words.contains("triangles or tetrahedra, which refine themselves"), "{words}");
    // Names are relative to the scene file, wherever the command is typed.
    assert!(words.contains("relative to the scene file (--meshes coarse.msh,fine.msh)"), "{words}");
    let output = stickslip(&converge(&file, "force", &["--meshes", "a.msh"]));
    assert_exit(&output, 1);
    assert!(flat(&output).contains("no finer mesh is named"), "{}", stdout(&output));
}

/// Meshes of triangles refine themselves, and each is named by the value of `mesh.refine` that leads to it.
#[test]
fn triangles_refine_themselves() {
    let (folder, file) = Folder::with_scene(FILE);
    fs::write(folder.join("a.msh"), include_str!("../../../../data/meshes/square_triangles.msh")).unwrap();
    let output = stickslip(&converge(&file, "force", &["--to", "0.05", "--json"]));
    assert_exit(&output, 0);
    let study = json(&output);
    let runs = study["runs"].as_array().unwrap();
    let (first, last) = (&runs[0], &runs[runs.len() - 1]);
    assert!(first["mesh"].as_str().unwrap().ends_with("a.msh"), "{first}");
    let refine = last["mesh"].as_str().unwrap().replace("refine", "mesh.refine").replace(' ', "");
    let scene = Scene::read(file.as_ref(), &[refine.parse().unwrap()]).unwrap();
    let again = stickslip::run::Run::new(&scene).unwrap();
    assert_eq!(again.model().mesh.cells.len() as u64, last["elements"].as_u64().unwrap(), "{refine}");
    // The force on a finer mesh is within the uncertainty.
    let value = |study: &serde_json::Value, key: &str| study[key].as_f64().unwrap();
    let finer = json(&stickslip(&converge(&file, "force", &["--to", "0.01", "--json"])));
    let error = (value(&study, "value") / value(&finer, "extrapolated") - 1.0).abs();
    assert!(error <= value(&study, "uncertainty"), "{error} {study}");
    // The study alone refines: named meshes are what they are, whatever the scene says.
    let named = |more: &[&str]| {
        let set = ["--set", "mesh.elements=[[5,7,6],8]", "--set", "mesh.cells=triangle", "--meshes", "5,10", "--json"];
        let study = json(&stickslip(&converge(PUNCH, "force", &[&set[..], more].concat())));
        study["runs"].as_array().unwrap().iter().map(|run| number(&run["value"])).collect::<Vec<_>>()
    };
    assert_eq!(named(&["--set", "mesh.refine=0.3"]), named(&[]));
}

/// On the file of the last mesh a scene has the same force, of two bodies, also of tetrahedra. In other units than m coordinates are
/// rounded once more.
#[test]
fn the_last_mesh_is_a_file() {
    let plane = |cells| (cells, "[10, 5]", "[3, 2]", "['x', 'y']", "[2, 5]", "[0.01, -0.05]");
    let space = ("tetrahedron", "[10, 10, 5]", "[1, 1, 1]", "['x', 'y', 'z']", "[2, 0, 5]", "[0.01, 0, -0.05]");
    let mm = "units = { length = 'mm', stress = 'MPa' }";
    let all = [
        (plane("triangle"), "", 1e-12),
        (plane("triangle6"), "", 1e-12),
        (space, "", 1e-12),
        (plane("triangle6"), mm, 1e-11),
    ];
    for ((cells, size, elements, fix, at, down), units, bound) in all {
        let block = format!("mesh = {{ kind = 'block', size = {size}, elements = {elements}, cells = '{cells}' }}");
        let [soft, hard] = ["young = 1e3, poisson = 0.3", "young = 2e3, poisson = 0.2"];
        let bodies = format!(
            "body = [{{ name = 'lower', {block}, material = {{ {soft} }} }},
                     {{ name = 'upper', at = {at}, {block}, material = {{ {hard} }} }}]"
        );
        let rest = format!(
            "{units}
            support = [{{ boundary = 'lower:bottom', fix = {fix} }},
                       {{ boundary = 'upper:top', fix = {fix}, displacement = {down} }}]
            contact = [{{ boundary = 'upper:bottom', against = 'lower:top', friction = 0.3 }}]
            time = {{ end = 1, increments = 1 }}"
        );
        let (folder, file) = Folder::with_scene(&format!("{bodies}\n{rest}"));
        let out = folder.join("out");
        let output = stickslip(&converge(&file, "force", &["--to", "0.1", "--max-runs", "3", "--out", &out, "--json"]));
        let study = json(&output);
        let last = study["runs"].as_array().unwrap().last().unwrap().clone();
        let file = "mesh = { kind = 'gmsh', file = 'out/converge.msh' }";
        let groups = format!("group = [{{ name = 'lower', {soft} }}, {{ name = 'upper', {hard} }}]");
        let again = folder.join("again.toml");
        fs::write(&again, format!("{file}\nmaterial = {{ {soft}, {groups} }}\n{rest}")).unwrap();
        let increments = last["increments"].to_string();
        let run = json(&stickslip(&["run", &again, "--json", "--increments", &increments]));
        let error = number(&run["largest_force"]["magnitude"]) / number(&study["value"]) - 1.0;
        assert!(last["mesh"].as_str().unwrap().starts_with("refine") && error.abs() < bound, "{error} {study}");
    }
}

/// Returns a unit square of `n` by `n` quadrilaterals, of eight nodes if `second`.
fn square(n: usize, second: bool) -> String {
    let number = |x: usize, y: usize| 1 + x + (2 * n + 1) * y;
    let mut nodes = String::from("*NODE\n");
    let (mut elements, mut bottom, mut top) =
        (format!("*ELEMENT, TYPE=CPE{}\n", if second { 8 } else { 4 }), vec![], vec![]);
    for (y, x) in (0..=2 * n).flat_map(|y| (0..=2 * n).map(move |x| (y, x))) {
        let place = [x, y].map(|c| c as f64 / (2 * n) as f64);
        writeln!(nodes, "{}, {}, {}", number(x, y), place[0], place[1]).unwrap();
        if y == 0 || y == 2 * n {
            if y == 0 { &mut bottom } else { &mut top }.push(number(x, y).to_string());
        }
        if x % 2 == 0 && y % 2 == 0 && x < 2 * n && y < 2 * n {
            let around = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]];
            let around = around[..if second { 8 } else { 4 }].iter().map(|[i, j]| number(x + i, y + j).to_string());
            writeln!(elements, "{}, {}", number(x, y), around.collect::<Vec<_>>().join(", ")).unwrap();
        }
    }
    let set = |name: &str, of: &[String]| format!("*NSET, NSET={name}\n{}\n", of.join(",\n"));
    [nodes, elements, set("BOTTOM", &bottom), set("TOP", &top)].concat()
}

/// A mesh of second order is finer than one of first order with as many elements.
#[test]
fn meshes_of_second_order_are_finer() {
    let (folder, file) = Folder::with_scene(
        "mesh = { kind = 'abaqus', file = 'a.inp' }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'TOP', fix = ['x', 'y'] }]
        contact = [
          { boundary = 'BOTTOM', friction = 0.3, obstacle = { kind = 'plane', approach = [[0, 0], [1, 1e-3]] } },
        ]
        time = { end = 1, increments = 2 }",
    );
    for (name, n, second) in [("a.inp", 4, false), ("b.inp", 4, true), ("c.inp", 8, true)] {
        fs::write(folder.join(name), square(n, second)).unwrap();
    }
    let output = stickslip(&converge(&file, "force", &["--to", "0.02", "--meshes", "a.inp,b.inp,c.inp", "--json"]));
    let study: serde_json::Value = serde_json::from_str(stdout(&output)).unwrap();
    assert!(study["runs"].as_array().unwrap().len() > 1, "{study}");
    let output = stickslip(&converge(&file, "force", &["--to", "1e-9", "--meshes", "b.inp,a.inp"]));
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("elements and is no finer"), "{}", stderr(&output));
    // All meshes are read before anything is solved.
    for (last, word) in [("missing.inp", "missing.inp"), ("a.inp", "is no finer")] {
        let meshes = ["b.inp", "c.inp", last].map(|name| name.parse().unwrap());
        let limits = Limits { to: 0.02, most_runs: 12, within: 1e9 };
        let plan = Plan { sought: "force".parse().unwrap(), meshes: meshes.to_vec(), ratio: 2.0, limits };
        let mut begun = Vec::new();
        let scene = Scene::read(file.as_ref(), &[]).unwrap();
        let error = compute(&scene, &plan, &mut |run| begun.push(run), &mut ()).unwrap_err();
        assert!(error.to_string().contains(word) && begun.is_empty(), "{error} {begun:?}");
    }
}

/// A study carries the warnings of its last run, and is not known where one of them is never to be ignored.
#[test]
fn what_is_never_to_be_ignored_is_never_known() {
    let folder = Folder::new();
    let scene = |obstacle: &str| {
        format!(
            "mesh = {{ kind = \"block\", size = [1, 0.5], elements = [20, 20] }}\nmaterial = {{ young = 1e9, poisson = 0.3 \
             }}\n[[support]]\nboundary = \"top\"\nfix = [\"x\", \"y\"]\n[[contact]]\nboundary = \"bottom\"\nfriction = 0.3\nobstacle = {{ \
             {obstacle}, approach = [[0, 0], [1, 2e-4]] }}\n[time]\nend = 1\nincrements = 4\n"
        )
    };
    let bumps = scene("kind = \"formula\", formula = \"1e-4 * (1 - cos(2 * PI * x * 20))\"");
    fs::write(folder.join("bumps.toml"), bumps).unwrap();
    fs::write(folder.join("plane.toml"), scene("kind = \"plane\"")).unwrap();
    let of = |file: &str, sought: &str, more: &[&str]| {
        let file = folder.join(file);
        stickslip(&converge(&file, sought, &[&["--to", "0.2", "--meshes", "5,10,20"], more].concat()))
    };
    let text = of("bumps.toml", "force", &[]);
    assert_exit(&text, 1);
    assert!(flat(&text).contains("never to be ignored") && stdout(&text).contains("\nwarning "), "{}", stdout(&text));
    let study = json(&of("bumps.toml", "force", &["--json"]));
    assert_eq!(study["verdict"], "warned");
    assert!(
        study["warnings"].as_array().unwrap().iter().any(|warning| warning["kind"] == "obstacle-between-nodes"),
        "{study}"
    );
    // A pressure that each run calls singular has no value; the force of the same runs has one.
    assert_exit(&of("plane.toml", "force", &[]), 0);
    let study = json(&of("plane.toml", "peak", &["--json"]));
    assert!(study["verdict"] != "known" && study["uncertainty"].is_null(), "{study}");
}
