//! The program as a user meets it: exit status, output, and the files it leaves.

#![cfg(feature = "cli")]
// Values that were given are read back exactly.
#![allow(clippy::unwrap_used, clippy::float_cmp)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

const BLOCK: &str = include_str!("../data/scenes/block.toml");

/// A folder of its own for a test, gone when the test ends.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let name = format!("stickslip-cli-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// A folder with the scene `text` in it, and the path of the scene.
    fn with_scene(text: &str) -> (Self, String) {
        let folder = Folder::new();
        let path = folder.join("scene.toml");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    fn join(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.join(folder)).unwrap();
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

/// The block with 4 × 4 elements and 4 increments: 40 displacements, 4 contact nodes that can move.
fn small() -> String {
    edit(&edit(BLOCK, "[100, 100]", "[4, 4]"), "increments = 40", "increments = 4")
}

fn edit(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "the scene has no `{from}` to edit");
    text.replacen(from, to, 1)
}

/// `text` without its tables from `from` to `to`.
fn without(text: &str, from: &str, to: &str) -> String {
    [&text[..text.find(from).unwrap()], &text[text.find(to).unwrap()..]].concat()
}

fn stickslip(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip")).args(args).output().unwrap()
}

fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

#[track_caller]
fn assert_exit(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}{}", stdout(output), stderr(output));
}

/// Standard output as the one JSON object that it must be.
fn json(output: &Output) -> Value {
    let values: Vec<Value> =
        serde_json::Deserializer::from_str(stdout(output)).into_iter().collect::<Result<_, _>>().unwrap();
    let [value] = values.as_slice() else { panic!("{} JSON values", values.len()) };
    assert!(value.is_object());
    value.clone()
}

/// Runs the scene `text` with `--json`, expects exit status `code`, and returns the report.
fn report(text: &str, code: i32) -> Value {
    let (_folder, scene) = Folder::with_scene(text);
    let output = stickslip(&["run", &scene, "--json"]);
    assert_exit(&output, code);
    json(&output)
}

fn count(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("not a count: {value}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("not a finite number: {value}"))
}

/// The header and the rows of a CSV file, every row as long as the header.
fn csv(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_string();
    let rows: Vec<Vec<String>> = lines.map(|line| line.split(',').map(str::to_string).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == header.split(',').count()), "{text}");
    (header, rows)
}

#[test]
fn a_good_run_fills_its_folder() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("new/out");
    let output = stickslip(&["run", &scene, "--json", "--out", &out]);
    assert_exit(&output, 0);
    let lines = ["contact_0002.csv", "contact_0002.svg", "contact_0004.csv", "contact_0004.svg"];
    assert_eq!(folder.names("new/out"), [&lines[..], &["increments.csv", "run.json"]].concat());

    let out = Path::new(&out);
    let (header, rows) = csv(&out.join("increments.csv"));
    assert!(header.starts_with("index,time,status,iterations,backtracks,theta,equilibrium,penetration,"), "{header}");
    assert!(header.contains(",backward_error,open,stick,slip,"), "{header}");
    assert_eq!(rows.len(), 4);
    for (k, row) in rows.iter().enumerate() {
        assert_eq!((&row[0], &row[2]), (&(k + 1).to_string(), &"converged".to_string()));
        assert_eq!(row[1].parse::<f64>().unwrap(), 0.5 * (k + 1) as f64);
    }

    for name in ["contact_0002", "contact_0004"] {
        let (header, rows) = csv(&out.join(name).with_extension("csv"));
        assert_eq!(header, "x,y,p_n,p_t,sigma_n,sigma_t,w_n,w_t,status");
        assert_eq!(rows.len(), 4);
        for row in &rows {
            assert!(["open", "stick", "slip"].contains(&row[8].as_str()), "{row:?}");
            assert!(row[..8].iter().all(|field| field.parse::<f64>().unwrap().is_finite()), "{row:?}");
        }
        let svg = fs::read_to_string(out.join(name).with_extension("svg")).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
        assert!(svg.contains("<polyline") || svg.contains("<line") || svg.contains("<path"), "{name} shows no line");
        assert_eq!(svg.matches("<text").count(), svg.matches("</text>").count());
        assert!(!svg.contains("NaN"));
    }
    let written: Value = serde_json::from_str(&fs::read_to_string(out.join("run.json")).unwrap()).unwrap();
    assert_eq!(written, json(&output));
}

#[test]
fn the_report_has_every_field() {
    let report = report(&small(), 0);
    assert!(report["scene"].as_str().unwrap().ends_with("scene.toml"));
    assert_eq!(report["title"], "Elastic block on a frictional foundation");
    for (key, value) in [
        ("method", "bn"),
        ("setting", "paper"),
        ("solver", if cfg!(feature = "umfpack") { "umfpack" } else { "faer" }),
        ("status", "converged"),
    ] {
        assert_eq!(report[key], value, "{key}");
    }
    assert_eq!(report["reason"], "");
    let unknowns = &report["unknowns"];
    assert_eq!([&unknowns["u"], &unknowns["p_t"], &unknowns["p_n"]].map(count), [40, 4, 4]);

    let increments = report["increments"].as_array().unwrap();
    assert_eq!(increments.len(), 4);
    for (k, increment) in increments.iter().enumerate() {
        assert_eq!((count(&increment["index"]), number(&increment["time"])), (k as u64 + 1, 0.5 * (k + 1) as f64));
        assert_eq!(increment["status"], "converged");
        assert!(count(&increment["iterations"]) >= 1);
        count(&increment["backtracks"]);
        assert!(number(&increment["theta"]) >= 0.0);
        for law in ["equilibrium", "penetration", "tension", "complementarity", "cone", "dissipation"] {
            assert!((0.0..=1e-10).contains(&number(&increment["kkt"][law])), "{law}: {increment}");
        }
        let contact = &increment["contact"];
        assert_eq!(count(&contact["open"]) + count(&contact["stick"]) + count(&contact["slip"]), 4);
        for part in ["assembly", "factorization", "solve", "rest"] {
            assert!(number(&increment["seconds"][part]).abs() < 600.0, "{part}");
        }
    }

    let totals = &report["totals"];
    let iterations: u64 = increments.iter().map(|increment| count(&increment["iterations"])).sum();
    assert_eq!(count(&totals["iterations"]), iterations);
    // One for the interior's answer to the loads, and one an iteration unless the last still serves;
    // one pattern serves the whole run.
    assert!((2..=iterations + 1).contains(&count(&totals["factorizations"])), "{totals}");
    assert_eq!(count(&totals["symbolic_analyses"]), 1);
    assert!(number(&totals["cpu_seconds"]) > 0.0 && number(&totals["wall_seconds"]) > 0.0);
    assert!(!cfg!(target_os = "linux") || count(&totals["peak_rss_bytes"]) > 1 << 20);
    assert!(count(&totals["nnz_factors"]) > 48);
    let end = &report["final"];
    assert!(number(&end["sum_p_n"]) > 0.0);
    assert!(number(&end["sum_p_t"]).abs() <= 0.4 * number(&end["sum_p_n"]) * (1.0 + 1e-9));
}

#[test]
fn without_friction_there_are_no_tangential_unknowns() {
    let report = report(&edit(&small(), "friction = 0.4", "friction = 0"), 0);
    assert_eq!((count(&report["unknowns"]["p_t"]), count(&report["unknowns"]["p_n"])), (0, 4));
    assert_eq!(number(&report["final"]["sum_p_t"]), 0.0);
}

#[test]
fn without_contact_an_increment_is_one_linear_solve() {
    let report = report(&without(&small(), "[[contact]]", "[[load]]"), 0);
    assert_eq!((count(&report["unknowns"]["p_t"]), count(&report["unknowns"]["p_n"])), (0, 0));
    for increment in report["increments"].as_array().unwrap() {
        assert_eq!(count(&increment["iterations"]), 1);
    }
    assert_eq!((count(&report["totals"]["iterations"]), count(&report["totals"]["factorizations"])), (4, 1));
}

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
    assert_eq!(folder.names("out"), ["increments.csv", "run.json"]);
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
        assert_eq!(stdout(&output), "", "{args:?}");
        assert!(stderr(&output).contains("help"), "no remedy: {}", stderr(&output));
        assert_eq!(folder.names(""), ["scene.toml"], "{args:?}");
    }
    for args in [&["run", "no such scene.toml"][..], &["check", "no such scene.toml"], &["run"], &["walk"], &[]] {
        assert_exit(&stickslip(args), 2);
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_status_2() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene, "--out", &format!("{scene}/out")]);
    assert_exit(&output, 2);
    assert_eq!(stdout(&output), "");
    assert!(stderr(&output).contains("--out"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&scene).unwrap(), small());
}

/// `/dev/full` refuses every byte as a full disk does; links to it stand for the files of a run.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_status_3() {
    for (file, left) in
        [("increments.csv", None), (".contact_0002.csv.partial", Some(2)), (".run.json.partial", Some(4))]
    {
        let (folder, scene) = Folder::with_scene(&small());
        fs::create_dir(folder.join("out")).unwrap();
        std::os::unix::fs::symlink("/dev/full", folder.join("out/") + file).unwrap();
        let output = stickslip(&["run", &scene, "--json", "--out", &folder.join("out")]);
        assert_exit(&output, 3);
        assert_eq!(stdout(&output), "");
        assert!(stderr(&output).contains("make room"), "{}", stderr(&output));
        // What was written before is whole, and nothing pretends to be the report.
        if let Some(rows) = left {
            assert_eq!(csv(&folder.0.join("out/increments.csv")).1.len(), rows, "{file}");
        }
        assert!(!folder.names("out").iter().any(|name| name.contains("run.json") || name.contains("partial")));
    }
}

#[test]
fn check_explains_without_solving() {
    let (folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["check", &scene]);
    assert_exit(&output, 0);
    for words in [
        "Elastic block on a frictional foundation",
        "4 x 4 bilinear quadrilaterals, 25 nodes",
        "left: x and y held",
        "bottom: plane at 1e-5 m, mu = 0.4",
        "40 displacements u",
        "4 normal forces p_n",
        "4 increments of 0.5 s",
        "held         by its supports",
        "theorem 3    holds: (a) no rigid motion leaves every obstacle; (b) contact rows independent",
    ] {
        assert!(stdout(&output).contains(words), "`{words}` is not in:\n{}", stdout(&output));
    }
    assert_eq!(folder.names(""), ["scene.toml"]);
}

#[test]
fn cells_of_table_ii() {
    let output = stickslip(&["tables", "block", "--contact-nodes", "5", "--increments", "1", "--json"]);
    assert_exit(&output, 0);
    let table = json(&output);
    let columns = table["columns"].as_array().unwrap();
    let names: Vec<_> = columns.iter().map(|column| column["method"].as_str().unwrap()).collect();
    assert_eq!(names, ["bn", "ip-safe", "ip-prev", "bn-default", "ip"]);
    for column in columns {
        for (cell, mu) in column["cells"].as_array().unwrap().iter().zip([0.1, 0.4, 0.8]) {
            assert_eq!((count(&cell["contact_nodes"]), count(&cell["increments"]), number(&cell["mu"])), (5, 1, mu));
            assert!(cell["status"] == "converged" && number(&cell["here"]["nle"]) >= 1.0);
        }
    }
    assert_eq!(count(&columns[1]["nle"]["cells"]), 3);

    let unknown = stickslip(&["tables", "block", "--contact-nodes", "7", "--json"]);
    assert_exit(&unknown, 2);
    assert_eq!(stdout(&unknown), "");
    assert!(stderr(&unknown).contains("no such cell"), "{}", stderr(&unknown));
}

#[test]
fn the_version_names_the_solver_in_use() {
    let output = stickslip(&["--version"]);
    assert_exit(&output, 0);
    let line = stdout(&output);
    let after = line.strip_prefix(concat!("stickslip ", env!("CARGO_PKG_VERSION"), " ")).unwrap();
    if cfg!(feature = "umfpack") {
        assert!(after.starts_with("(SuiteSparse ") && after.contains("UMFPACK "), "{line}");
    } else {
        assert_eq!(after.trim(), "(without UMFPACK)");
    }
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

/// Pulled away from the wall, the block is in some danger; pushed towards it, as the scene says, in none.
#[test]
fn the_uniqueness_is_told_where_it_is_asked_for() {
    let (folder, scene) = Folder::with_scene(&small());
    let pull = ["load[1].traction=[50e6,0.0]", "time.end=1.0", "output.times=[1.0]"];
    let set = pull.iter().flat_map(|text| ["--set", text]);
    let args: Vec<&str> = ["run", &scene, "--uniqueness"].into_iter().chain(set).collect();
    let output = stickslip(&args);
    assert_exit(&output, 0);
    let start = "uniqueness   rates are unique up to ";
    let line = stdout(&output).lines().find(|line| line.starts_with(start)).unwrap();
    assert!(line.contains(" times this friction along the present status (mu "), "{line}");

    let out = folder.join("out");
    for options in [&["--json"][..], &["--json", "--method", "ip", "--solver", "condensed", "--out", &out]] {
        let output = stickslip(&[&args[..], options].concat());
        assert_exit(&output, 0);
        let critical = &json(&output)["critical_friction"];
        assert!(count(&critical["slipping"]) > 0);
        assert!((6.0..7.0).contains(&number(&critical["factor"])), "{critical}");
        assert!(line.contains(&format!("{:.3}", number(&critical["factor"]))), "{line} {critical}");
    }
    let written: Value = serde_json::from_str(&fs::read_to_string(Path::new(&out).join("run.json")).unwrap()).unwrap();
    assert!((6.0..7.0).contains(&number(&written["critical_friction"]["factor"])), "{written}");

    let output = stickslip(&["run", &scene, "--json"]);
    assert!(json(&output).get("critical_friction").is_none());
    // Without friction an infinite factor, which JSON does not have; without an increment, nothing.
    let output = stickslip(&["run", &scene, "--set", "contact.friction=0.0", "--json", "--uniqueness"]);
    assert!(json(&output)["critical_friction"]["factor"].is_null());
    let output = stickslip(&["run", &scene, "--set", "solver.max_iterations=1", "--json", "--uniqueness"]);
    assert_exit(&output, 1);
    assert!(json(&output).get("critical_friction").is_none());
}

/// What is chosen is told, and solves as if it had been named.
#[test]
fn the_linear_algebra_is_chosen_where_that_is_asked_for() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene, "--solver", "auto"]);
    assert_exit(&output, 0);
    let line = stdout(&output).lines().find(|line| line.starts_with("solver       auto: ")).unwrap();
    let open = json(&stickslip(&["run", &scene, "--solver", "auto", "--json"]));
    let chosen = open["solver"].as_str().unwrap();
    assert!(line.contains(open["solver_choice"].as_str().unwrap()), "{line}");
    assert!(line.starts_with(&format!("solver       auto: {chosen} (")), "{line}");
    let named = json(&stickslip(&["run", &scene, "--solver", chosen, "--json"]));
    assert!(named.get("solver_choice").is_none());
    for field in ["solver", "final"] {
        assert_eq!(open[field], named[field]);
    }
    assert_eq!(open["totals"]["iterations"], named["totals"]["iterations"]);
}

/// Ctrl-C ends the run after the iteration at hand, with what was reached on disk.
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
    assert!(Command::new("sh").args(["-c", &format!("kill -INT {}", child.id())]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 1);
    assert!(stdout(&output).contains("verdict      interrupted"), "{}", stdout(&output));
    let report: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.join("results/run.json")).unwrap()).unwrap();
    assert_eq!(report["status"], "interrupted");
    // Every increment before the last line is a good one.
    let text = fs::read_to_string(folder.join("results/increments.csv")).unwrap();
    let verdicts: Vec<&str> = text.lines().skip(1).map(|line| line.split(',').nth(2).unwrap()).collect();
    let (last, before) = verdicts.split_last().unwrap();
    assert!(before.iter().all(|verdict| *verdict == "converged"), "{verdicts:?}");
    assert!(["converged", "interrupted"].contains(last));
}

/// A verdict that is not "converged" names the law, the node and what to try.
#[test]
fn a_failure_names_the_law_and_the_place() {
    let (_folder, scene) = Folder::with_scene(&small());
    let output = stickslip(&["run", &scene, "--set", "solver.max_iterations=1", "--json"]);
    assert_exit(&output, 1);
    let report = json(&output);
    let worst = &report["worst"];
    assert!(number(&worst["error"]) > 1e-10 && worst["law"].is_string() && worst["position"].is_array(), "{worst}");
    let reason = report["reason"].as_str().unwrap();
    for words in [worst["law"].as_str().unwrap(), "is violated by", "at the node (", "try"] {
        assert!(reason.contains(words), "`{words}` is not in: {reason}");
    }
}
