//! Failures of the program: exit status, message, and the remaining files.

// Given values are read back exactly.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::edit;
use crate::program::{Folder, assert_exit, count, csv, json, number, send, small, stderr, stdout, stickslip, without};
use serde_json::Value;

#[test]
fn no_convergence_is_status_1_and_what_was_reached_is_written() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    let output = stickslip(&["run", &scene, "--json", "--out", &out, "--set", "solver.max_iterations=1"]);
    assert_exit(&output, 1);
    let report = json(&output);
    assert_eq!(report["status"], "max-iterations");
    let reason = report["reason"].as_str().unwrap();
    assert!(
        reason.contains("no convergence within max_iterations = 1")
            && reason.contains("a larger solver.max_iterations"),
        "{reason}"
    );
    let records = report["increments"].as_array().unwrap();
    let last = records.last().unwrap();
    assert_eq!(last["status"], "max-iterations");
    let (_, rows) = csv(&Path::new(&out).join("increments.csv"));
    assert_eq!((rows.len(), rows.last().unwrap()[2].as_str()), (records.len(), "max-iterations"));
    let names = folder.names("out");
    assert!(names.contains(&format!("contact_{:04}.csv", count(&last["index"]))), "{names:?}");
    let written: Value = serde_json::from_str(&fs::read_to_string(Path::new(&out).join("run.json")).unwrap()).unwrap();
    assert_eq!(written, report);
}

#[test]
fn a_body_that_nothing_holds_is_singular_and_has_no_numbers() {
    let (folder, scene) = Folder::with_scene(&without(&small(), "[[support]]", "[[load]]"));
    let out = folder.join("out");
    let output = stickslip(&["run", &scene, "--json", "--out", &out]);
    assert_exit(&output, 1);
    let report = json(&output);
    assert_eq!(report["status"], "singular");
    let reason = report["reason"].as_str().unwrap();
    assert!(reason.contains("nothing holds the body against a "), "{reason}");
    assert!(reason.contains("translation along") || reason.contains("rotation about"), "{reason}");
    assert_eq!(report["increments"].as_array().unwrap().len(), 0);
    assert_eq!(report["final"], serde_json::json!({ "sum_p_n": 0.0, "sum_p_t": 0.0 }));
    assert_eq!(folder.names("out"), ["forces.csv", "increments.csv", "report.html", "run.json"]);
    assert!(csv(&Path::new(&out).join("increments.csv")).1.is_empty());

    let check = stickslip(&["check", &scene]);
    assert_exit(&check, 0);
    assert_eq!(stdout(&check).matches("NOT HELD     nothing holds the body against a ").count(), 3);
    assert!(!stdout(&check).contains("theorem") && !stdout(&check).contains("BALANCE"));
}

#[test]
fn bad_input_is_status_2_and_nothing_is_written() {
    let small = small();
    let scenes = [
        edit(&small, "[mesh]", "[mesh"),
        edit(&small, "poisson", "poison"),
        edit(&small, "0.3", "0.5"),
        edit(&small, "210e9", "nan"),
        edit(&small, "\"top\"", "\"roof\""),
        edit(&small, "gap = 1e-5", "gap = -1e-6"),
        edit(&small, "\"bn\"", "\"newton\""),
        without(&small, "[time]", "[solver]"),
        String::new(),
    ];
    let good: &[&str] = &[];
    let faults = scenes.iter().map(|text| (text, good)).chain(
        [
            &["--set", "mesh.elements"][..],
            &["--set", "contact[3].friction=1"],
            &["--set", "material.youngs=1"],
            &["--method", "newton"],
            &["--setting", "mine"],
            &["--solver", "cg"],
            &["--colour"],
        ]
        .map(|args| (&small, args)),
    );
    for (text, args) in faults {
        let (folder, scene) = Folder::with_scene(text);
        let out = folder.join("out");
        let output = stickslip(&[&["run", &scene, "--json", "--out", &out], args].concat());
        assert_exit(&output, 2);
        let failure = json(&output);
        assert_eq!((&failure["status"], count(&failure["schema_version"])), (&"bad-input".into(), 1), "{args:?}");
        assert!(!failure["message"].as_str().unwrap().is_empty(), "{failure}");
        assert!(stderr(&output).contains("help"), "no remedy: {}", stderr(&output));
        assert_eq!(folder.names(""), ["scene.toml"], "{args:?}");
    }
    for args in [
        &["run", "/dev/zero"][..],
        &["run", "."],
        &["run", "no such scene.toml"],
        &["check", "no such scene.toml"],
        &["run"],
        &["walk"],
        &[],
    ] {
        assert_exit(&stickslip(args), 2);
    }
}

/// If the result is to be JSON, so is the error: message, position and cure.
#[test]
fn a_fault_as_json_has_its_place() {
    let text = edit(&small(), "\"top\"", "\"roof\"");
    let line = text[..text.find("\"roof\"").unwrap()].lines().count();
    let (_folder, scene) = Folder::with_scene(&text);
    let failure = json(&stickslip(&["run", &scene, "--json"]));
    assert!(failure["file"].as_str().unwrap().ends_with("scene.toml"), "{failure}");
    assert_eq!(count(&failure["line"]) as usize, line);
    assert!(failure["message"].as_str().unwrap().contains("the mesh has no boundary `roof`"), "{failure}");
    assert!(failure["help"].as_str().unwrap().contains("top"), "{failure}");
}

/// Before the first long wait, the program prints what it reads and does; here an invalid mesh file.
#[test]
fn the_title_comes_before_the_set_up() {
    let text = small();
    let mesh = "[mesh]\nkind = \"gmsh\"\nfile = \"scene.toml\"\n\n";
    let scene = [&text[..text.find("[mesh]").unwrap()], mesh, &text[text.find("[material]").unwrap()..]].concat();
    let (_folder, scene) = Folder::with_scene(&scene);
    let output = stickslip(&["run", &scene]);
    assert_exit(&output, 2);
    let lines: Vec<&str> = stdout(&output).lines().collect();
    assert_eq!(lines, ["Elastic block on a frictional foundation", "set-up       mesh, stiffness, contact"]);
}

/// A method with one tangent per node is refused before solving if nodes slide in a plane.
#[test]
fn a_method_of_the_plane_in_space_is_status_2() {
    let cube = edit(include_str!("../../../../data/scenes/cube.toml"), "[10, 10, 10]", "[2, 2, 2]");
    let solver = |keys: &str| format!("{cube}\n[solver]\nmethod = \"ip\"\n{keys}\n");
    for keys in ["setting = \"paper\"", "setting = \"paper\"\npartition = \"cone\""] {
        let text = solver(keys);
        let line = text[..text.find(keys).unwrap()].lines().count() + 1;
        let (folder, scene) = Folder::with_scene(&text);
        for command in ["check", "run"] {
            let output = stickslip(&[command, &scene]);
            assert_exit(&output, 2);
            assert!(!stdout(&output).contains("unknowns"), "{}", stdout(&output));
            assert!(stderr(&output).contains(&format!("scene.toml:{line}:")), "{}", stderr(&output));
            assert!(stderr(&output).contains("use the method \"bn\""), "{}", stderr(&output));
        }
        assert_eq!(folder.names(""), ["scene.toml"]);
        // Without friction no node has a tangent.
        assert_exit(&stickslip(&["check", &scene, "--set", "contact.friction=0"]), 0);
    }
    let (_folder, scene) = Folder::with_scene(&solver("setting = \"default\""));
    assert_exit(&stickslip(&["check", &scene]), 0);
}

#[test]
fn a_folder_that_cannot_be_made_is_status_2() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene, "--out", &format!("{scene}/out")]);
    assert_exit(&output, 2);
    assert!(!stdout(&output).contains("unknowns"), "{}", stdout(&output));
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&scene).unwrap(), small());
}

/// A full disk for standard output or standard error does not stop a run. All files of the run exist.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_or_error_does_not_stop_a_run() {
    let full = || fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let run = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(args);
        command
    };
    for json in [&[][..], &["--json"]] {
        let (folder, scene) = Folder::with_scene(&small());
        let out = folder.join("out");
        let args = [&["run", &scene, "--out", &out], json].concat();
        let output = run(&args).stdout(full()).output().unwrap();
        assert_exit(&output, 3);
        assert_eq!(stderr(&output).matches("standard output cannot be written").count(), 1, "{}", stderr(&output));
        let report = fs::read_to_string(folder.join("out/run.json")).unwrap();
        let report: Value = serde_json::from_str(&report).unwrap();
        assert_eq!(report["status"], "converged");
        assert_eq!(csv(&folder.0.join("out/increments.csv")).1.len(), 4);

        assert_exit(&run(&args).stderr(full()).output().unwrap(), 0);
    }
    let (_folder, scene) = Folder::with_scene("nonsense");
    assert_exit(&run(&["run", &scene]).stderr(full()).output().unwrap(), 2);
    assert_exit(&run(&["run", &scene, "--json"]).stderr(full()).stdout(full()).output().unwrap(), 3);
}

/// Files that no run wrote are not replaced, whatever their names.
#[test]
fn foreign_files_are_left_alone() {
    let (folder, scene) = Folder::with_scene(&small());
    fs::write(folder.join("run.json"), "mine").unwrap();
    let output = stickslip(&["run", &scene, "--out", &folder.join("")]);
    assert_exit(&output, 2);
    assert_eq!(fs::read_to_string(folder.join("run.json")).unwrap(), "mine");
    assert_eq!(folder.names(""), ["run.json", "scene.toml"]);
}

/// Ctrl-C ends the run after the current iteration, with the results so far on disk.
#[test]
fn an_interrupted_run_keeps_its_increments() {
    let (folder, scene) = Folder::with_scene(&small());
    let results = folder.join("results");
    let child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["run", &scene, "--out", &results, "--setting", "default"])
        .args(["--set", "mesh.elements=[60,60]", "--set", "time.increments=4000"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines = || fs::read_to_string(folder.join("results/increments.csv")).map_or(0, |text| text.lines().count());
    while lines() < 4 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    send("INT", child.id());
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    assert!(stdout(&output).contains("verdict      interrupted"), "{}", stdout(&output));
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("results/run.json")).unwrap()).unwrap();
    assert_eq!(report["status"], "interrupted");
    // Every increment except the last line has converged.
    let text = fs::read_to_string(folder.join("results/increments.csv")).unwrap();
    let verdicts: Vec<&str> = text.lines().skip(1).map(|line| line.split(',').nth(2).unwrap()).collect();
    let (last, before) = verdicts.split_last().unwrap();
    assert!(before.iter().all(|verdict| *verdict == "converged"), "{verdicts:?}");
    assert!(["converged", "interrupted"].contains(last));
    // Increments that were not reached have no forces and no contact table.
    let converged = verdicts.iter().filter(|verdict| **verdict == "converged").count();
    let forces = fs::read_to_string(folder.join("results/forces.csv")).unwrap();
    assert_eq!(forces.lines().filter(|line| line.contains(",contact,")).count(), converged);
    assert_eq!(report["forces"].as_array().unwrap().len(), converged);
    assert!(!folder.names("results").contains(&format!("contact_{:04}.csv", converged + 1)));
}

/// A verdict other than "converged" names the law, the node and the cure.
#[test]
fn a_failure_names_the_law_and_the_place() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene, "--set", "solver.max_iterations=1", "--json"]);
    assert_exit(&output, 1);
    let report = json(&output);
    let worst = &report["worst"];
    assert!(number(&worst["error"]) > 1e-10 && worst["law"].is_string() && worst["position"].is_array(), "{worst}");
    let reason = report["reason"].as_str().unwrap();
    for words in [worst["law"].as_str().unwrap(), "relative error", "at the node (", "try"] {
        assert!(reason.contains(words), "`{words}` is not in: {reason}");
    }
}

/// The run is refused before the work if its results cannot be written.
#[test]
fn where_results_cannot_go_is_told_before_the_work() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    fs::create_dir_all(folder.join("out/run.json")).unwrap();
    let output = stickslip(&["run", &scene, "--out", &out]);
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("run.json is a folder"), "{}", stderr(&output));
    assert_eq!(folder.names("out"), ["run.json"]);
    let output = stickslip(&["run", &scene, "--out", &scene]);
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("results cannot be written: not a"), "{}", stderr(&output));
    let output = stickslip(&["compare", &scene, "--out", &scene]);
    assert_exit(&output, 2);
    assert!(stdout(&output).is_empty() && stderr(&output).contains("--out"), "{}", stderr(&output));
}

/// Some editors write a byte order mark before the text.
#[test]
fn a_byte_order_mark_is_no_text() {
    let (_folder, scene) = Folder::with_scene(&format!("\u{feff}{}", small()));
    assert_exit(&stickslip(&["check", &scene]), 0);
}

/// Titles and names come from files, and may contain control characters for terminals.
#[test]
fn what_a_scene_says_does_not_steer_the_terminal() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["check", &scene, "--set", r#"title="a\u001b[31mb\u0007""#]);
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("a\u{fffd}[31mb\u{fffd}"), "{}", stdout(&output));
}

/// A missing scene file is named in the place where a program looks for it.
#[test]
fn the_file_that_cannot_be_read_is_named_in_json() {
    assert_eq!(json(&stickslip(&["run", "no such scene.toml", "--json"]))["file"], "no such scene.toml");
}

/// An error names the missing cargo feature and the available alternatives.
#[cfg(not(feature = "umfpack"))]
#[test]
fn a_backend_that_is_not_built_in() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["check", &scene, "--set", "solver.linear=\"umfpack\""]);
    assert_exit(&output, 2);
    let message = stderr(&output).replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ");
    for words in ["this build has no UMFPACK", "use \"faer\" or \"condensed\""] {
        assert!(message.contains(words), "{message}");
    }
}

/// The default solvers of a comparison are those of this build.
#[test]
fn compare_takes_what_is_built_in() {
    let (_folder, scene) = Folder::with_scene(&small());
    let compare = ["compare", &scene, "--meshes", "2", "--increments", "2", "--reference", "2", "--methods", "bn"];
    let output = stickslip(&compare);
    assert_exit(&output, 0);
    assert_eq!(stdout(&output).contains("umfpack"), cfg!(feature = "umfpack"), "{}", stdout(&output));
    if cfg!(not(feature = "umfpack")) {
        let output = stickslip(&[&compare[..], &["--solvers", "umfpack"]].concat());
        assert_exit(&output, 2);
        assert!(stderr(&output).contains("--solvers") && stderr(&output).contains("help"), "{}", stderr(&output));
    }
}

/// A request to stop is seen between increments, too: an exact path without changes of status has no iterations.
#[test]
fn an_interrupted_exact_path_ends_with_its_results() {
    let (folder, scene) = Folder::with_scene(&small());
    let child = Command::new(env!("CARGO_BIN_EXE_stickslip"))
        .args(["run", &scene, "--out", &folder.join("results"), "--method", "events", "--setting", "default"])
        .args(["--set", "mesh.elements=[4,4]", "--set", "time.increments=1000000"])
        .args(["--set", "contact.obstacle.gap=1", "--threads", "1"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    let lines = || fs::read_to_string(folder.join("results/increments.csv")).map_or(0, |text| text.lines().count());
    while lines() < 4 {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    send("INT", child.id());
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    assert!(stdout(&output).contains("verdict      interrupted"), "{}", stdout(&output));
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("results/run.json")).unwrap()).unwrap();
    assert_eq!(report["status"], "interrupted");
}

/// `compare` refuses what `run` refuses, before anything is solved.
#[test]
fn an_exact_path_that_does_not_exist_is_refused() {
    let (_folder, scene) = Folder::with_scene(include_str!("../../../../data/scenes/cube.toml"));
    let output = stickslip(&["compare", &scene, "--methods", "bn,events", "--meshes", "2", "--increments", "2"]);
    assert_exit(&output, 2);
    assert!(stderr(&output).contains("slide along lines") && stderr(&output).contains("\"bn\""), "{}", stderr(&output));
}

/// A missing file is told at the key that names it, in an inline table and in a list too.
#[test]
fn missing_files_are_told_at_their_keys() {
    let plane = "{ kind = \"plane\", gap = 1e-5 }";
    for (obstacle, key) in [
        ("{ kind = \"surface\", file = \"absent.stl\" }", "obstacle ="),
        ("[{ kind = \"plane\" }, { kind = \"table\", file = \"absent.csv\" }]", "obstacle ="),
    ] {
        let text = edit(&small(), plane, obstacle);
        let line = 1 + text.lines().position(|line| line.starts_with(key)).unwrap();
        let (_folder, scene) = Folder::with_scene(&text);
        for command in ["check", "run"] {
            let output = stickslip(&[command, &scene]);
            assert_exit(&output, 2);
            assert!(stderr(&output).contains(&format!(".toml:{line}:")), "{line}: {}", stderr(&output));
        }
    }
}
