//! The page of a result folder is made again.

#![allow(clippy::unwrap_used)]

use std::fs;

use serde_json::Value;

use crate::program::{Folder, assert_exit, small, stderr, stdout, stickslip};

/// Returns the data in the page of a folder.
fn data(folder: &Folder) -> Value {
    let page = fs::read_to_string(folder.0.join("out/report.html")).unwrap();
    let data = page.split("type=\"application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(data).unwrap()
}

/// A run may have been made by an older version, whose page was another.
#[test]
fn a_page_is_made_again() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    assert_exit(&stickslip(&["run", &scene, "--out", &out]), 0);
    let page = folder.0.join("out/report.html");
    let before = fs::read_to_string(&page).unwrap();
    fs::write(&page, "an older page").unwrap();
    // A page that was made again does not spoil a finished run.
    assert_exit(&stickslip(&["run", &scene, "--out", &out, "--resume"]), 0);
    let output = stickslip(&["report", &out]);
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("report.html"), "{}", stdout(&output));
    assert_eq!(fs::read_to_string(&page).unwrap(), before);
    let data = data(&folder);
    assert_eq!(data["report"]["status"], "converged");
    assert_eq!(data["body"].as_array().unwrap().len(), 1 + 2, "the mesh and two states");
    assert_eq!(data["contacts"][0]["boundary"], "bottom");
}

/// A run that was killed leaves no `run.json`.
#[test]
fn a_page_without_a_report_has_tables_and_units() {
    let units = "units = { length = 'mm', stress = 'MPa' }\n";
    let (folder, scene) = Folder::with_scene(&[units, &small()].concat());
    let out = folder.join("out");
    let _ = stickslip(&["run", &scene, "--out", &out]);
    fs::remove_file(folder.0.join("out/run.json")).unwrap();
    let output = stickslip(&["report", &out]);
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("unfinished"), "{}", stdout(&output));
    let data = data(&folder);
    assert_eq!(data["report"], Value::Null);
    assert_eq!(data["units"]["length"]["name"], "mm");
    assert!(data["files"]["increments.csv"].as_str().unwrap().lines().count() > 1);
}

#[test]
fn a_folder_without_results_is_refused_with_the_cure() {
    let folder = Folder::new();
    let refused = |fault: &str, cure: &str| {
        let output = stickslip(&["report", &folder.join("out")]);
        assert_exit(&output, 2);
        let words = stderr(&output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
        assert!(words.contains(fault) && words.contains(cure), "{words}");
    };
    refused("cannot be opened", "name the folder");
    fs::create_dir(folder.0.join("out")).unwrap();
    refused("no results of a run", "name the folder of `--out`");
    fs::write(folder.0.join("out/run.json"), "{").unwrap();
    refused("run.json is no report", "remove run.json");
    fs::write(folder.0.join("out/run.json"), b"{\n\xff}").unwrap();
    refused("run.json, line 2: byte 3 of the file is not UTF-8 text", "save the file as UTF-8");
    fs::write(folder.0.join("out/run.json"), "{}").unwrap();
    fs::write(folder.0.join("out/forces.csv"), b"index,boundary\n1,g\xfcn\n").unwrap();
    refused("forces.csv, line 2: byte 19 of the file is not UTF-8 text", "save the file as UTF-8");
    fs::remove_file(folder.0.join("out/forces.csv")).unwrap();
    assert_exit(&stickslip(&["report", &folder.join("out")]), 0);
}
