//! The program, as it is called.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::Value;

use super::svg::texts;

pub fn studies(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip-studies")).args(args).output().unwrap()
}

pub fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

/// The table that `args` ask for, which must come out as it should.
#[track_caller]
fn table(args: &[&str]) -> Value {
    let output = studies(&[&["tables"], args, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    serde_json::from_str(stdout(&output)).unwrap()
}

#[test]
fn cells_of_table_ii() {
    let table = table(&["block", "--contact-nodes", "5", "--increments", "1"]);
    let columns = table["columns"].as_array().unwrap();
    let names: Vec<_> = columns.iter().map(|column| column["method"].as_str().unwrap()).collect();
    assert_eq!(names, ["bn", "ip-safe", "ip-prev", "bn-default", "ip"]);
    for column in columns {
        for (cell, mu) in column["cells"].as_array().unwrap().iter().zip([0.1, 0.4, 0.8]) {
            assert_eq!((&cell["contact_nodes"], &cell["increments"], &cell["mu"]), (&5.into(), &1.into(), &mu.into()));
            assert!(cell["status"] == "converged" && cell["here"]["nle"].as_f64().unwrap() >= 1.0);
        }
    }
    assert_eq!(columns[1]["nle"]["cells"], 3);
}

/// A table tells of the cells that were computed: what was once found of others belongs to the documentation.
#[test]
fn notes_are_of_this_run() {
    let cell = ["block", "--contact-nodes", "5", "--increments", "1", "--mu", "0.1", "--methods", "ip-prev"];
    assert_eq!(table(&cell)["notes"], Value::Array(vec![]));
    let output = studies(&[&["tables"], &cell[..]].concat());
    assert!(!stdout(&output).contains("chaotic"), "{}", stdout(&output));
}

#[test]
fn what_is_not_there_is_refused() {
    for (args, said) in [
        (&["tables", "block", "--contact-nodes", "7"][..], "no such cell"),
        (&["tables", "block", "--solver", "mumps"], "this build has no mumps"),
        (&["tables", "block", "--solver", "pardiso"], "it is one of umfpack, mumps"),
        (&["extremes", "--only", "weather"], "no such sweep"),
        (&["figures", "--only", "3"], "3"),
    ] {
        let output = studies(args);
        assert_eq!(output.status.code(), Some(2), "{args:?}");
        assert_eq!(stdout(&output), "");
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
    }
}

/// A folder of its own for a test, gone when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        Folder(std::env::temp_dir().join(format!("stickslip-studies-{name}-{}", std::process::id())))
    }

    fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn figures_are_written_where_they_are_asked_for() {
    let folder = Folder::new("figures");
    let out = folder.0.join("new");
    let run = |only: &str| studies(&["figures", "--only", only, "--out", out.to_str().unwrap()]);
    for only in ["3", "4,8", "all"] {
        assert_eq!(run(only).status.code(), Some(2), "{only}");
        assert!(!folder.0.exists());
    }
    let output = run("5");
    assert_eq!(output.status.code(), Some(0));
    assert!(stdout(&output).contains("figure5.svg\n  BN: Theta from 1.1e17 to "), "{}", stdout(&output));
    let written = Folder(out.clone());
    assert_eq!(written.names(), ["figure5.csv", "figure5.svg"]);
    texts(&fs::read_to_string(out.join("figure5.svg")).unwrap());

    // A file in the place of the folder.
    fs::remove_dir_all(&out).unwrap();
    fs::write(&out, "mine").unwrap();
    let output = run("5");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("--out"));
}

#[test]
fn a_sweep_is_drawn() {
    let folder = Folder::new("extremes");
    let output =
        studies(&["extremes", "--only", "loads", "--methods", "bn", "--csv", "--out", folder.0.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(folder.0.join("extremes.csv")).unwrap(), stdout(&output));
    assert_eq!(folder.names(), ["extremes.csv", "loads-pa_error.svg", "loads-pa_iterations.svg"]);
}

/// Forces of a parabola on a block and on a body of revolution; those of quadrilaterals from a program that shares nothing with this one.
#[test]
fn elements_beside_each_other() {
    let folder = std::env::temp_dir().join(format!("stickslip-elements-{}", std::process::id()));
    let out = folder.to_str().unwrap();
    let output = studies(&["elements", "--only", "line,revolved", "--sizes", "1", "--out", out]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    for (name, known) in [
        ("line", &[("quadrilateral,8,", "3.8650909608e-4")][..]),
        ("revolved", &[("quadrilateral,8,", "1.2040165610e-5"), ("quadrilateral:b-bar,8,", "1.1954779737e-5")]),
    ] {
        let csv = fs::read_to_string(folder.join(format!("{name}.csv"))).unwrap();
        for (elements, value) in known {
            let line = csv.lines().find(|line| line.starts_with(elements)).unwrap();
            let [found, known] = [line.split(',').nth(4).unwrap(), value].map(|x| x.parse::<f64>().unwrap());
            assert!((found / known - 1.0).abs() < 1e-9, "{line}");
        }
        let svg = fs::read_to_string(folder.join(format!("{name}-unknowns.svg"))).unwrap();
        assert!(svg.lines().any(|line| line == "triangle6") && folder.join(format!("{name}-time.svg")).exists());
    }
    fs::remove_dir_all(&folder).unwrap();
    assert_eq!(studies(&["elements", "--only", "plate"]).status.code(), Some(2));
}
