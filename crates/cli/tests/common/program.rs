//! Runs the program on scenes in temporary folders.
#![allow(dead_code, clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

use crate::common::edit;

pub const BLOCK: &str = include_str!("../../../../data/scenes/block.toml");

/// A folder for one test, removed when the test ends.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let name = format!("stickslip-cli-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// Creates a folder with the scene `text` in it. Returns the folder and the path of the scene.
    pub fn with_scene(text: &str) -> (Self, String) {
        let folder = Folder::new();
        let path = folder.join("scene.toml");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    pub fn join(&self, name: &str) -> String {
        self.0.join(name).display().to_string()
    }

    /// Returns all names except the hidden ones of every result folder.
    pub fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.0.join(folder)).unwrap();
        let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| ![".stickslip", ".checkpoint", ".page.jsonl"].contains(&name.as_str()));
        names.sort();
        names
    }
}

/// The solver of the whole system that this build has.
pub const WHOLE: &str = if cfg!(feature = "umfpack") { "umfpack" } else { "faer" };

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Returns the block with 4 × 4 elements and 4 increments: 40 displacements, 4 contact nodes that can move.
pub fn small() -> String {
    edit(&edit(BLOCK, "[100, 100]", "[4, 4]"), "increments = 40", "increments = 4")
}

/// Returns `text` without its tables from `from` to `to`.
pub fn without(text: &str, from: &str, to: &str) -> String {
    [&text[..text.find(from).unwrap()], &text[text.find(to).unwrap()..]].concat()
}

pub fn stickslip(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_stickslip")).args(args).output().unwrap()
}

/// Returns what a command printed with a blank for each break of a line.
pub fn flat(output: &Output) -> String {
    stdout(output).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns what a command printed, with the lines that were broken to fit a screen in one.
pub fn unbroken(output: &Output) -> String {
    let (mut whole, mut length) = (String::new(), 0);
    for line in stdout(output).lines() {
        let rest = line.strip_prefix("             ");
        let word = rest.and_then(|rest| rest.split(' ').next()).map_or(0, |word| word.chars().count());
        match rest.filter(|_| length + 1 + word > 100) {
            Some(rest) => whole += &[" ", rest].concat(),
            None => whole += &["\n", line].concat(),
        }
        length = line.chars().count();
    }
    whole[1.min(whole.len())..].to_string() + "\n"
}

/// Sends a signal, such as `INT`, by the shell, because the smallest Debian has no program `kill`.
pub fn send(signal: &str, process: u32) {
    assert!(Command::new("sh").args(["-c", &format!("kill -{signal} {process}")]).status().unwrap().success());
}

/// Returns the running children of `parent`.
pub fn children(parent: u32) -> Vec<u32> {
    let is_child = |id: &u32| {
        let stat = fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
        // The state and the parent follow the name, which is in parentheses.
        let fields = stat.rsplit_once(") ").map(|(_, fields)| fields);
        fields.and_then(|fields| fields.split(' ').nth(1)).is_some_and(|id| id == parent.to_string())
    };
    let names = fs::read_dir("/proc").unwrap().filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
    names.filter(is_child).collect()
}

pub fn stdout(output: &Output) -> &str {
    std::str::from_utf8(&output.stdout).unwrap()
}

pub fn stderr(output: &Output) -> &str {
    std::str::from_utf8(&output.stderr).unwrap()
}

#[track_caller]
pub fn assert_exit(output: &Output, code: i32) {
    assert_eq!(output.status.code(), Some(code), "{}{}", stdout(output), stderr(output));
}

/// Parses standard output, which must be one JSON object.
pub fn json(output: &Output) -> Value {
    let values: Vec<Value> =
        serde_json::Deserializer::from_str(stdout(output)).into_iter().collect::<Result<_, _>>().unwrap();
    let [value] = values.as_slice() else { panic!("{} JSON values", values.len()) };
    assert!(value.is_object());
    value.clone()
}

/// Runs the scene `text` with `--json`, expects exit status `code`, and returns the report.
pub fn report(text: &str, code: i32) -> Value {
    let (_folder, scene) = Folder::with_scene(text);
    let output = stickslip(&["run", &scene, "--json"]);
    assert_exit(&output, code);
    json(&output)
}

pub fn count(value: &Value) -> u64 {
    value.as_u64().unwrap_or_else(|| panic!("not a count: {value}"))
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("not a finite number: {value}"))
}

/// Returns the header and the rows of a CSV file, and checks that every row is as long as the header.
pub fn csv(path: &Path) -> (String, Vec<Vec<String>>) {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'));
    let mut lines = text.lines();
    let header = lines.next().unwrap().to_string();
    let rows: Vec<Vec<String>> = lines.map(|line| line.split(',').map(str::to_string).collect()).collect();
    assert!(rows.iter().all(|row| row.len() == header.split(',').count()), "{text}");
    (header, rows)
}
