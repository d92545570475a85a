//! Commands on the pages end with the exit status that the pages promise, and the scenes on the pages are readable.
//! Commands run in small: with few increments, and `compare` with one mesh.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::documented::pages;
use crate::program::{Folder, stderr, stdout};

/// A part of each command that does not end with status 0, and its status: Gmsh makes the meshes of the first two, which
/// are left out; in the third the block slides away, in the fourth the peak is singular, and in the last the joint
/// slips, as the pages say.
const EXCEPTIONS: [(&str, Option<i32>); 5] = [
    ("lap-joint-fine.msh", None),
    ("benchmarks/bracket.toml", None),
    ("contact.friction=0.15:0.75:5", Some(1)),
    ("--for peak --out results/punch-sharp", Some(1)),
    ("load[1].traction=[2.1e6,0]", Some(1)),
];

/// The folders that commands name, and the files beside the scenes on the pages.
const LINKS: &str = "data doc python data/tutorials/lap-joint.msh data/tutorials/die.stl data/init/roller.msh \
                     doc/howto/abaqus/two_blocks.inp";

#[test]
fn commands_and_scenes_of_the_pages_work() {
    let pages = pages();
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some((path, text)) = pages.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let page = follow(&path.display().to_string(), text);
                    done.lock().unwrap().extend(page);
                }
            });
        }
    });
    let done: Vec<(String, Option<String>)> = done.into_inner().unwrap();
    let faults: Vec<&str> = done.iter().filter_map(|(_, fault)| fault.as_deref()).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
    for (part, _) in EXCEPTIONS {
        assert_eq!(done.iter().filter(|(line, _)| line.contains(part)).count(), 1, "commands with {part}");
    }
    // There are fewer if blocks are not recognised.
    assert!(done.len() > 90, "{} commands and scenes", done.len());
}

/// Follows a page in a folder of its own. Returns each command or scene, and its fault.
fn follow(page: &str, text: &str) -> Vec<(String, Option<String>)> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let (home, mut done) = (Folder::new(), Vec::new());
    for path in LINKS.split_whitespace().map(|path| root.join(path).canonicalize().unwrap()) {
        symlink(&path, home.0.join(path.file_name().unwrap())).unwrap();
    }
    let mut folder = home.0.clone();
    for (language, block) in blocks(text) {
        let mut lines = Vec::new();
        // Other blocks show some tables of a scene.
        let has = |table: &str| toml::from_str::<toml::Table>(&block).unwrap().contains_key(table);
        if language == "toml" && has("time") && (has("mesh") || has("body")) {
            // The reader of a page with a scene, but without its file, saves it under this name.
            fs::write(folder.join("my.toml"), &block).unwrap();
            lines.push("stickslip check my.toml".to_string());
        } else if language == "sh" {
            lines.extend(block.replace("\\\n", " ").lines().map(String::from));
        }
        for line in lines {
            let mut words = split(&line);
            let first = words.first().cloned().unwrap_or_default();
            match first.as_str() {
                "cd" => folder = folder.join(&words[1]),
                "stickslip" => {
                    let exception = EXCEPTIONS.iter().find(|(part, _)| line.contains(part));
                    let mut fault = None;
                    if let Some(status) = exception.map_or(Some(0), |(_, status)| *status) {
                        let file = words.iter().position(|word| word == ">").map(|k| words.split_off(k)[1].clone());
                        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
                        command.args(reduced(words.split_off(1))).current_dir(&folder);
                        let output =
                            command.env("OMP_NUM_THREADS", "1").env("OPENBLAS_NUM_THREADS", "1").output().unwrap();
                        if output.status.code() != Some(status) {
                            fault = Some(format!("{page}: {line}\n{}{}", stdout(&output), stderr(&output)));
                        }
                        if let Some(file) = file {
                            fs::write(folder.join(file), &output.stdout).unwrap();
                        }
                    }
                    done.push((line, fault));
                }
                _ => {}
            }
        }
    }
    done
}

/// Returns the blocks of code of a page with their languages, without the indentation of their lines.
fn blocks(text: &str) -> Vec<(String, String)> {
    let (mut blocks, mut lines) = (Vec::new(), text.lines().map(str::trim));
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let block: Vec<&str> = lines.by_ref().take_while(|line| !line.starts_with("```")).collect();
            blocks.push((language.to_string(), block.join("\n")));
        }
    }
    blocks
}

/// Splits a line as a shell does: quotes of both kinds, and a comment at the end.
fn split(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quote) = (Vec::new(), String::new(), None::<char>);
    for c in line.chars() {
        match quote {
            Some(end) if end == c => quote = None,
            None if c == '#' && word.is_empty() => break,
            None if c == '\'' || c == '"' => quote = Some(c),
            None if c == ' ' => words.push(std::mem::take(&mut word)),
            _ => word.push(c),
        }
    }
    words.push(word);
    words.retain(|word| !word.is_empty());
    words
}

/// Makes a command small, and keeps its results out of the repository.
fn reduced(mut words: Vec<String>) -> Vec<String> {
    let command = words[0].clone();
    for k in 1..words.len() {
        let value = words[k].as_str();
        words[k] = match words[k - 1].as_str() {
            "--out" => value.replace("doc/", "results/"),
            "--solvers" if !cfg!(feature = "umfpack") => value.replace("umfpack,", ""),
            "--increments" => "2".to_string(),
            "--to" => "0.9".to_string(),
            // A quantity is not known on one mesh.
            "--meshes" if command != "converge" => value.split(',').take(1).collect(),
            _ => continue,
        };
    }
    let whole = !words.iter().any(|word| word == "--increments");
    let more: &[&str] = match command.as_str() {
        "run" | "sweep" if whole => &["--set", "time.increments=2"],
        "compare" if whole => &["--increments", "2", "--meshes", "4"],
        _ => &[],
    };
    words.extend(more.iter().map(|word| String::from(*word)));
    words
}
