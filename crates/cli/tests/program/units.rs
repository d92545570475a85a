//! The output for a scene with named units, compared with the same scene in SI.

#![allow(clippy::unwrap_used)]

use super::documented_units::documented_keys;
use crate::common::edit;
use crate::program::{Folder, assert_exit, csv, json, small, stderr, stdout, stickslip};
use serde_json::Value;
use std::fs;
use std::path::Path;
use stickslip::base::{LengthUnit, StressUnit, UnitSystem, Units};
use stickslip::run::report::UnitNames;

const CUBE: &str = include_str!("../../../../data/scenes/cube.toml");
const UNITS: &str = "[units]\nlength = \"mm\"\nstress = \"MPa\"\n\n[mesh]";

fn edited(text: &str, edits: &[(&str, &str)]) -> String {
    edits.iter().fold(text.to_string(), |text, (from, to)| edit(&text, from, to))
}

/// Returns a block in SI and in mm and MPa, with a spring, and with a force at a point.
fn block() -> [String; 2] {
    let more = |point: &str, force: &str, stiffness: &str| {
        let load = format!("\n[[load]]\npoint = {point}\nforce = {force}\n");
        format!("{load}[[spring]]\nboundary = \"right\"\nnormal = {stiffness}\n")
    };
    let probe = "\n[[output.probe]]\nname = \"line\"\nfrom = [0.5, 0.25]\nto = [0.5, 0.75]\npoints = 3\n";
    let output = edit(&small(), "times =", "fields = true\ndeformed = true\ntimes =");
    let si = [&output, probe, &more("[1.0, 1.0]", "[0, -1e5]", "1e9")].concat();
    let si = edit(&si, "setting = \"paper\"", "setting = \"default\"");
    let mm = edited(
        &si,
        &[
            ("[mesh]", UNITS),
            ("[1.0, 1.0]", "[1000, 1000]"),
            ("210e9", "210e3"),
            ("gap = 1e-5", "gap = 1e-2"),
            ("[0.0, -10e6]", "[0, -10]"),
            ("[-10e6, 0.0]", "[-10, 0]"),
            ("point = [1.0, 1.0]", "point = [1000, 1000]"),
            ("[0, -1e5]", "[0, -1e2]"),
            ("normal = 1e9", "normal = 1"),
            ("[0.5, 0.25]", "[500, 250]"),
            ("[0.5, 0.75]", "[500, 750]"),
        ],
    );
    [si, mm]
}

fn cube() -> [String; 2] {
    let si = edited(CUBE, &[("[10, 10, 10]", "[3, 3, 3]"), ("increments = 10", "increments = 4")]);
    let mm = edited(
        &si,
        &[
            ("[mesh]", UNITS),
            ("[1.0, 1.0, 1.0]", "[1000, 1000, 1000]"),
            ("210e9", "210e3"),
            ("gap = 1e-5", "gap = 1e-2"),
            ("[0.0, 0.0, -10e6]", "[0, 0, -10]"),
            ("[-10e6, 0.0, 0.0]", "[-10, 0, 0]"),
            ("[0.0, 10e6, 0.0]", "[0, 10, 0]"),
        ],
    );
    [si, mm]
}

/// Returns an SI unit in the system of mm and MPa, in this number of dimensions.
fn in_mm(unit: &str, dimension: usize) -> f64 {
    match (unit, dimension) {
        ("Pa", _) => 1e6,
        ("N", 3) => 1.0,
        ("m", _) | ("N m" | "J", 3) => 1e-3,
        // Per mm of depth.
        ("N", _) => 1e3,
        ("" | "s" | "B" | "N m" | "J", _) => 1.0,
        other => panic!("what is {other:?}?"),
    }
}

/// Runs both scenes. Returns their folders.
fn run(texts: &[String; 2]) -> [Folder; 2] {
    texts.each_ref().map(|text| {
        let (folder, scene) = Folder::with_scene(text);
        assert_exit(&stickslip(&["run", &scene, "--out", &folder.join("out")]), 0);
        folder
    })
}

/// Returns the header and the rows of a table, without quoted texts, which may contain commas.
fn table(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    let plain: String = text.split('"').step_by(2).collect();
    let mut rows = plain.lines().map(|line| line.split(',').map(String::from).collect::<Vec<_>>());
    let header = rows.next().unwrap();
    (header.join(","), rows.collect())
}

fn close(si: f64, value: f64, unit: f64, largest: f64) -> bool {
    (si - value * unit).abs() <= 1e-9 * largest
}

/// Returns the unit of a column, independent of the program.
fn unit_of_column(name: &str) -> &'static str {
    match name {
        "x" | "y" | "z" | "w_n" | "w_t" | "w_o" | "gap" | "slip_t" | "slip_o" | "u_x" | "u_y" | "u_z" => "m",
        "sigma_n" | "sigma_t" | "sigma_o" | "sigma_patch" | "s_xx" | "s_yy" | "s_zz" | "s_xy" | "von_mises"
        | "sigma_along" | "sigma_across" | "sigma_shear" => "Pa",
        "p_n" | "p_t" | "p_o" | "f_x" | "f_y" | "f_z" | "sum_p_n" | "sum_p_t" | "sum_p_o" => "N",
        "m_x" | "m_y" | "m_z" => "N m",
        "friction_work" | "strain_energy" => "J",
        "n_x" | "n_y" | "n_z" | "t_x" | "t_y" | "t_z" | "o_x" | "o_y" | "o_z" | "node" | "point" | "index" | "time"
        | "iterations" | "backtracks" | "open" | "stick" | "slip" | "parts" | "attempts" | "friction_used" => "",
        other => panic!("what is the unit of the column {other}?"),
    }
}

/// Returns `true` for rounding errors, wall times and words.
fn is_no_number(name: &str) -> bool {
    let errors =
        ["theta", "equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation", "backward_error"];
    let words = ["status", "rescued", "boundary", "kind", "balance", "slip_state"];
    errors.contains(&name) || words.contains(&name) || name.starts_with("seconds_")
}

#[test]
fn tables_are_told_in_the_units_of_the_scene() {
    for (texts, dimension) in [(block(), 2), (cube(), 3)] {
        let folders = run(&texts);
        let mut files = folders[0].names("out");
        assert_eq!(files, folders[1].names("out"));
        files.retain(|name| Path::new(name).extension().is_some_and(|extension| extension == "csv"));
        assert!(files.len() >= 4, "{files:?}");
        for file in files {
            let [(header, si), (other, mm)] = folders.each_ref().map(|folder| table(&folder.0.join("out").join(&file)));
            assert!(header == other && si.len() == mm.len());
            for (k, name) in header.split(',').enumerate().filter(|(_, name)| !is_no_number(name)) {
                let column = |rows: &[Vec<String>]| rows.iter().map(|row| row[k].clone()).collect::<Vec<_>>();
                let number = |field: &String| field.parse().unwrap_or_else(|_| panic!("{file}, {name}: {field}"));
                let pairs = column(&si).into_iter().zip(column(&mm)).filter(|(si, mm)| {
                    assert_eq!(si.is_empty(), mm.is_empty());
                    !si.is_empty()
                });
                let pairs: Vec<(f64, f64)> = pairs.map(|(si, mm)| (number(&si), number(&mm))).collect();
                let largest = pairs.iter().fold(0.0_f64, |m, (si, _)| m.max(si.abs()));
                let unit = in_mm(unit_of_column(name), dimension);
                for (si, mm) in pairs {
                    assert!(close(si, mm, unit, largest), "{file}, {name}: {si} and {mm}");
                }
            }
        }
    }
}

/// Collects every number of a JSON value with its path, in the notation of doc/reference/results.md.
fn numbers(value: &Value, at: &str, into: &mut Vec<(String, f64)>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                let path = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
                numbers(value, &path, into);
            }
        }
        Value::Array(values) => {
            for value in values {
                numbers(value, &if value.is_object() { format!("{at}[]") } else { at.to_string() }, into);
            }
        }
        Value::Number(number) => into.push((at.to_string(), number.as_f64().unwrap())),
        _ => {}
    }
}

#[test]
fn reports_are_told_in_the_units_of_the_scene() {
    let units = documented_keys();
    for (texts, dimension) in [(block(), 2), (cube(), 3)] {
        let folders = run(&texts);
        let [si, mm] = folders.each_ref().map(|folder| {
            let text = fs::read_to_string(folder.join("out/run.json")).unwrap();
            serde_json::from_str::<Value>(&text).unwrap()
        });
        assert!(si.get("units").is_none());
        let order = |report: &Value| report.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
        assert_eq!(order(&mm), [order(&si), vec!["units".to_string()]].concat());
        let (mut found, mut expected) = (Vec::new(), Vec::new());
        numbers(&si, "", &mut expected);
        numbers(&mm, "", &mut found);
        found.retain(|(path, _)| !path.starts_with("units"));
        assert_eq!(found.len(), expected.len());
        for ((path, si), (other, mm)) in expected.iter().zip(&found) {
            assert_eq!(path, other);
            let unit = &units[path];
            let rounded = ["kkt", "theta", "backward_error", "balance"].iter().any(|name| path.contains(name));
            if rounded || unit == "B" || (unit == "s" && path.contains("seconds")) {
                continue;
            }
            let largest = expected.iter().filter(|(p, _)| p == path).fold(0.0_f64, |m, (_, x)| m.max(x.abs()));
            assert!(close(*si, *mm, in_mm(unit, dimension), largest), "{path}: {si} and {mm}");
        }
        let system = UnitSystem::new(Units::new(LengthUnit::Millimetre, StressUnit::Megapascal), dimension);
        assert_eq!(mm["units"], serde_json::to_value(UnitNames::of(&system)).unwrap());
        let (name, size) = if dimension == 2 { ("N/mm", 1e3) } else { ("N", 1.0) };
        assert_eq!(
            (mm["units"]["force"]["name"].as_str(), mm["units"]["force"]["si"].as_f64()),
            (Some(name), Some(size))
        );
    }
    let places = |text: &str| {
        let (_folder, scene) = Folder::with_scene(text);
        json(&stickslip(&["run", &scene, "--json"]))["reactions"][0]["loads"][2]["at"].clone()
    };
    assert_eq!(block().each_ref().map(|text| places(text)), ["[1.0, 1.0]", "[1000.0, 1000.0]"]);
}

#[test]
fn pictures_name_the_units_of_the_scene() {
    let svg = |folder: &Folder, name: &str| fs::read_to_string(folder.0.join("out").join(name)).unwrap();
    for (texts, picture) in [(block(), "contact_0004.svg"), (cube(), "contact_0004.svg")] {
        let [si, mm] = run(&texts).map(|folder| svg(&folder, picture));
        assert!(si.contains("\nx, m\n") && si.contains("MPa") && mm.contains("\nx, mm\n") && mm.contains("MPa"));
        // The pictures agree except for the numbers along axes of length.
        let drawn = |text: &str| {
            let parts = text.split('<').filter(|part| !part.starts_with("text") && !part.starts_with("/text"));
            parts.map(String::from).collect::<Vec<_>>()
        };
        assert_eq!(drawn(&si), drawn(&mm));
    }
    let [si, mm] = run(&block());
    for (name, of_si, of_mm) in [
        ("deformed_0004.svg", ["m at most", "von Mises, MPa"], ["mm at most", "von Mises, MPa"]),
        ("forces.svg", ["force, N/m"; 2], ["force, N/mm"; 2]),
    ] {
        assert!(of_si.iter().all(|said| svg(&si, name).contains(said)), "{name}");
        assert!(of_mm.iter().all(|said| svg(&mm, name).contains(said)), "{name}");
    }
    let kpa = edited(&block()[0], &[("[mesh]", "[units]\nlength = \"m\"\nstress = \"kPa\"\n\n[mesh]")]);
    let kpa = edited(&kpa, &[("210e9", "210e6"), ("[0.0, -10e6]", "[0, -10e3]"), ("[-10e6, 0.0]", "[-10e3, 0]")]);
    let kpa = edited(&kpa, &[("[0, -1e5]", "[0, -1e2]"), ("normal = 1e9", "normal = 1e6")]);
    let (folder, scene) = Folder::with_scene(&kpa);
    let output = stickslip(&["run", &scene, "--out", &folder.join("out")]);
    assert_exit(&output, 0);
    assert!(svg(&folder, "contact_0004.svg").contains("\ncontact stress, kPa\n"));
    assert!(stdout(&output).contains(") kN/m"), "{}", stdout(&output));
}

#[test]
fn people_are_told_in_the_units_of_the_scene() {
    let [_, mm] = block();
    let (_folder, scene) = Folder::with_scene(&mm);
    let printed = |args: &[&str]| {
        let output = stickslip(&[args, &[&scene]].concat());
        assert_exit(&output, 0);
        stdout(&output).to_string()
    };
    let run = printed(&["run"]);
    for said in [") N/mm\n", "N/mm on the body", "reaction     left:", " mm at most"] {
        assert!(run.contains(said), "{said}: {run}");
    }
    let check = printed(&["check"]);
    for said in [
        "block 1000 mm x 1000 mm",
        "E = 210000 MPa",
        "plane at 0.01 mm",
        "(0, -10) MPa, in all (0, ",
        "load         [1000.0, 1000.0]: (0, -100) N/mm",
        "1 MPa/mm along the normal, 0 MPa/mm across",
    ] {
        assert!(check.contains(said), "{said}: {check}");
    }
    let words = |text: &str, unit: &str| text.split_whitespace().any(|word| word.trim_matches([',', ';', ')']) == unit);
    for text in [&run, &check] {
        assert!(!words(text, "m") && !words(text, "Pa") && !words(text, "N") && !words(text, "N/m2"), "{text}");
    }
    let loose = edited(&mm, &[("fix = [\"x\", \"y\"]", "fix = [\"x\"]")]);
    let (_folder, scene) = Folder::with_scene(&[&loose, "\n[solver]\n"].concat().replace("\n[solver]\n\n", "\n"));
    let output = stickslip(&["check", &scene]);
    assert!(!words(stdout(&output), "m"), "{}{}", stdout(&output), stderr(&output));
}

/// `--set` changes units like any other key. Both units are required.
#[test]
fn units_can_be_set() {
    let [_, mm] = block();
    let (_folder, scene) = Folder::with_scene(&mm);
    let report = |args: &[&str]| json(&stickslip(&[&["run", &scene, "--json"], args].concat()));
    let inches = report(&["--set", "units.length=in", "--set", "units.stress=psi"]);
    assert_eq!(inches["units"]["force"]["name"], "lbf/in");
    assert_eq!(report(&["--set", "units.length=cm"])["units"]["length"]["si"], 0.01);
    let [si, _] = block();
    let (_folder, scene) = Folder::with_scene(&si);
    let half = stickslip(&["check", &scene, "--set", "units.length=mm"]);
    assert_exit(&half, 2);
    assert!(stderr(&half).contains("`stress`, in `units`"), "{}", stderr(&half));
    assert_exit(&stickslip(&["check", &scene, "--set", "units.length=m", "--set", "units.stress=Pa"]), 0);
}

#[test]
fn sweeps_are_told_in_the_units_of_the_scene() {
    const QUANTITIES: &str = "largest_pressure.pressure,max:bottom.f_x,last:top.u_y,friction.friction_work";
    let [si, mm] = block().map(|text| {
        let (folder, scene) = Folder::with_scene(&text);
        let out = folder.join("out");
        let output =
            stickslip(&["sweep", &scene, "--vary", "contact.friction=0.1,0.2", "--out", &out, "--table", QUANTITIES]);
        assert_exit(&output, 0);
        let page = fs::read_to_string(folder.join("out/sweep.html")).unwrap();
        let json: Value = serde_json::from_str(&fs::read_to_string(folder.join("out/sweep.json")).unwrap()).unwrap();
        (page, json, csv(&folder.0.join("out/sweep.csv")), fs::read_to_string(folder.join("out/sweep.svg")).unwrap())
    });
    assert!(
        si.0.contains("pressure [MPa]") && si.0.contains("max f_x of bottom [N/m]<") && si.1.get("units").is_none()
    );
    for head in ["pressure [MPa]<", "max f_x of bottom [N/mm]<", "last u_y of top [mm]<", "friction work [mJ/mm]<"] {
        assert!(mm.0.contains(head), "{head}: {}", mm.0);
    }
    assert_eq!(mm.1["units"]["force"]["name"], "N/mm");
    assert!([si.3, mm.3].iter().all(|svg| svg.contains("largest contact pressure [MPa]")));
    for (k, name) in si.2.0.split(',').enumerate() {
        let unit = match name {
            "largest_pressure" | "largest_pressure.pressure" => "Pa",
            "last:top.u_y" => "m",
            "friction.friction_work" => "J",
            name if name.contains(".f_") || name.contains(".sum_p") => "N",
            _ => continue,
        };
        for (si, mm) in si.2.1.iter().zip(&mm.2.1) {
            let [si, mm] = [si, mm].map(|row| row[k].parse::<f64>().unwrap());
            assert!(close(si, mm, in_mm(unit, 2), si.abs()), "{name}: {si} and {mm}");
        }
    }
    let (_folder, scene) = Folder::with_scene(&block()[1]);
    let refused = stickslip(&["sweep", &scene, "--vary", "units.length=mm,cm"]);
    assert_exit(&refused, 2);
    assert!(stderr(&refused).contains("units.length cannot be varied"), "{}", stderr(&refused));
}

#[test]
fn comparisons_are_told_in_the_units_of_the_scene() {
    let meshes = |text: &str| {
        let (folder, scene) = Folder::with_scene(text);
        let small = ["--methods", "bn", "--solvers", "condensed", "--meshes", "4", "--increments", "2"];
        let output = stickslip(&[&["compare", &scene, "--out", &folder.join("out")], &small[..]].concat());
        assert_exit(&output, 0);
        (stdout(&output).to_string(), csv(&folder.0.join("out/meshes.csv")))
    };
    let [(si_text, (header, si)), (mm_text, (_, mm))] = block().map(|text| meshes(&text));
    assert!(
        si_text.contains("sum p_n [N/m] ") && mm_text.contains("sum p_n [N/mm] ") && mm_text.contains("energy [mJ/mm]")
    );
    for (k, name) in header.split(',').enumerate().filter(|(_, name)| !name.starts_with("error_")) {
        let unit = match name {
            "energy" | "friction_work" => "J",
            name if name.starts_with("sum_p") => "N",
            _ => continue,
        };
        let [si, mm] = [&si, &mm].map(|rows| rows[0][k].parse::<f64>().unwrap());
        assert!(close(si, mm, in_mm(unit, 2), si.abs()), "{name}: {si} and {mm}");
    }
}
