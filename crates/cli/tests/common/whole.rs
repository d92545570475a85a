//! Checks that the files of result folders are complete, and that two folders have the same results.
#![allow(dead_code, clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde_json::Value;

/// Values that differ between runs of the same scene: times, and counts that include the additional factorisations of a
/// resumed run.
const OF_THE_RUN: [&str; 9] = [
    "cpu_seconds",
    "wall_seconds",
    "setup_seconds",
    "peak_rss_bytes",
    "factorizations",
    "symbolic_analyses",
    "seconds",
    "blas",
    "solver_choice",
];

/// Returns the visible files of a folder, by name.
pub fn files(folder: &Path) -> BTreeMap<String, String> {
    let entries = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.unwrap());
    let named = entries.map(|entry| (entry.file_name().into_string().unwrap(), entry.path()));
    let visible = named.filter(|(name, _)| !name.starts_with('.'));
    visible.map(|(name, path)| (name, fs::read_to_string(path).unwrap())).collect()
}

/// Panics unless each file is complete: tables end with a whole line, pictures and reports with their end. The report,
/// if it exists, and the table of increments must agree.
#[track_caller]
pub fn assert_whole(folder: &Path) {
    are_whole(&files(folder));
}

/// Checks the same after a power cut during a write, which may leave part of a table's last line.
#[track_caller]
pub fn assert_whole_but_for_a_line(folder: &Path) {
    let mut files = files(folder);
    for (_, table) in files.iter_mut().filter(|(name, _)| Path::new(name).extension() == Some("csv".as_ref())) {
        table.truncate(table.rfind('\n').map_or(0, |end| end + 1));
    }
    are_whole(&files);
}

#[track_caller]
fn are_whole(files: &BTreeMap<String, String>) {
    for (name, text) in files {
        match name.rsplit_once('.').map(|(_, kind)| kind) {
            Some("csv") => {
                let columns = |line: &str| line.split(',').count();
                let header = text.lines().next().map_or(0, columns);
                assert!(text.ends_with('\n') && text.lines().all(|line| columns(line) == header), "{name}: {text}");
            }
            Some("svg") => assert!(text.trim_end().ends_with("</svg>"), "{name} ends in the middle"),
            Some("pvd" | "pvtu" | "vtu") => {
                assert!(text.trim_end().ends_with("</VTKFile>"), "{name} ends in the middle");
                for other in ["file=\"", "Source=\""].into_iter().flat_map(|mark| text.split(mark).skip(1)) {
                    let other = other.split('"').next().unwrap();
                    assert!(files.contains_key(other), "{name} names {other}");
                }
            }
            Some("json") => {
                let report: Value = serde_json::from_str(text).unwrap_or_else(|error| panic!("{name}: {error}"));
                let listed = report["increments"].as_array().unwrap().len();
                assert_eq!(listed + 1, files["increments.csv"].lines().count(), "{name} and increments.csv");
            }
            Some("html") => assert!(text.trim_end().ends_with("</html>"), "{name} ends in the middle"),
            _ => panic!("what is {name}?"),
        }
    }
}

/// Returns the results of a folder, without values that differ from run to run.
pub fn results(folder: &Path) -> BTreeMap<String, String> {
    let mut files = files(folder);
    // The page repeats what is in the other files.
    files.remove("report.html");
    for (name, text) in &mut files {
        *text = match name.as_str() {
            "run.json" => {
                let mut report: Value = serde_json::from_str(text).unwrap();
                leave_out(&mut report);
                serde_json::to_string_pretty(&report).unwrap()
            }
            "increments.csv" => {
                // Drops the four times.
                let is_wanted = |line: &str| {
                    let fields = line.split(',').enumerate().filter(|(k, _)| !(16..20).contains(k));
                    fields.map(|(_, field)| field).collect::<Vec<_>>().join(",")
                };
                assert_eq!(text.lines().next().unwrap().split(',').nth(16), Some("seconds_assembly"));
                text.lines().map(is_wanted).collect::<Vec<_>>().join("\n")
            }
            _ => continue,
        }
    }
    files
}

fn leave_out(value: &mut Value) {
    match value {
        Value::Object(keys) => {
            keys.retain(|key, _| !OF_THE_RUN.contains(&key.as_str()));
            keys.values_mut().for_each(leave_out);
        }
        Value::Array(values) => values.iter_mut().for_each(leave_out),
        _ => {}
    }
}

/// Panics unless both folders have identical results.
#[track_caller]
pub fn assert_same(one: &Path, other: &Path) {
    let (one, other) = (results(one), results(other));
    assert_eq!(one.keys().collect::<Vec<_>>(), other.keys().collect::<Vec<_>>());
    for (name, text) in &one {
        let differs = text.lines().zip(other[name].lines()).find(|(a, b)| a != b);
        assert!(*text == other[name], "{name}: {differs:?}");
    }
}
