//! Interrupted and resumed runs: the results agree with those of an uninterrupted run.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;
use std::thread::sleep;
use std::time::Instant;

use crate::common::random::Random;
use crate::program::{Folder, WHOLE, assert_exit, small, stderr, stdout};
use crate::whole::{assert_same, assert_whole, assert_whole_but_for_a_line, files};

/// Returns the library that makes calls fail, compiled once.
fn shim() -> &'static Path {
    static SHIM: OnceLock<PathBuf> = OnceLock::new();
    SHIM.get_or_init(|| {
        let library = std::env::temp_dir().join(format!("stickslip-faults-{}.so", std::process::id()));
        let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/program/faults/io.c");
        let mut compiler = Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-O1", "-o"]).arg(&library).arg(source).arg("-ldl");
        assert!(compiler.status().unwrap().success());
        library
    })
}

/// Returns standard error without its line breaks.
pub fn joined_message(output: &Output) -> String {
    stderr(output).replace("\n  │ ", " ")
}

/// A scene and the folders of its runs.
pub struct Case {
    folder: Folder,
    arguments: Vec<String>,
}

impl Case {
    pub fn new(scene: &str, options: &[&str]) -> Self {
        let (folder, scene) = Folder::with_scene(scene);
        let arguments = [&["run", &scene, "--threads", "1", "--checkpoint-every", "0"], options].concat();
        Case { folder, arguments: arguments.iter().map(ToString::to_string).collect() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.0.join(name)
    }

    pub fn command(&self, out: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(&self.arguments).arg("--out").arg(self.path(out)).args(more);
        command
    }

    /// Runs without interruption. Returns the number of calls that change a file.
    fn whole(&self, out: &str) -> u64 {
        let count = self.path("count");
        let output = self.command(out, &[]).env("LD_PRELOAD", shim()).env("FAULT_COUNT", &count).output().unwrap();
        assert_exit(&output, 0);
        assert_whole(&self.path(out));
        fs::read_to_string(count).unwrap().trim().parse().unwrap()
    }

    /// Runs with the failure `fault` of call `at`.
    fn failing(&self, out: &str, at: u64, fault: &str, lasts: bool) -> Output {
        let mut command = self.command(out, &[]);
        command.env("LD_PRELOAD", shim()).env("FAULT_AT", at.to_string()).env("FAULT", fault);
        if lasts {
            command.env("FAULT_LASTS", "1");
        }
        command.output().unwrap()
    }
}

/// For every call that changes a file, the run ends with it, or the call fails once, or all calls from it on fail. The
/// remaining files are complete, whether of the earlier run or of this one. The run can be resumed from them, and a new
/// run can start there.
fn all_faults(case: &Case, every: usize) -> usize {
    let calls = case.whole("whole");
    let earlier = Case::new(&small().replace("friction = 0.4", "friction = 0.2"), &[]);
    earlier.whole("earlier");
    let mut tried = 0;
    for (fault, lasts) in [("kill", false), ("torn", false), ("enospc", false), ("enospc", true), ("eio", false)] {
        for at in (1..=calls).step_by(every) {
            let out = format!("{fault}-{lasts}-{at}");
            let place = case.path(&out);
            fs::create_dir_all(&place).unwrap();
            for (name, text) in files(&earlier.path("earlier")) {
                fs::write(place.join(name), text).unwrap();
            }
            fs::copy(earlier.path("earlier/.stickslip"), place.join(".stickslip")).unwrap();

            let output = case.failing(&out, at, fault, lasts);
            let output_text = format!("{out}: {:?}\n{}{}", output.status, stdout(&output), stderr(&output));
            match output.status.code() {
                None => assert!(["kill", "torn"].contains(&fault), "{output_text}"),
                // Nothing of importance failed.
                Some(0) => assert_same(&case.path("whole"), &place),
                Some(code) => {
                    let message = self::joined_message(&output);
                    let is_told = if fault == "enospc" {
                        code == 3 && message.contains("free disk space")
                    } else {
                        [2, 3].contains(&code)
                    };
                    assert!(is_told && message.contains("cannot be written"), "{output_text}");
                }
            }
            // There is no report while old files are removed and new ones renamed.
            if fault == "torn" {
                assert_whole_but_for_a_line(&place);
            } else if place.join("run.json").exists() || fault != "kill" {
                assert_whole(&place);
            }
            assert_exit(&case.command(&out, &["--resume"]).output().unwrap(), 0);
            assert_same(&case.path("whole"), &place);
            assert_exit(&case.command(&out, &[]).output().unwrap(), 0);
            assert_same(&case.path("whole"), &place);
            fs::remove_dir_all(place).unwrap();
            tried += 1;
        }
    }
    tried
}

#[test]
fn calls_that_fail_leave_a_folder_that_the_next_run_takes_up() {
    let case = Case::new(&small(), &["--setting", "default"]);
    assert!(all_faults(&case, 18) > 25);
}

#[test]
#[ignore = "minutes"]
fn every_call_that_fails_leaves_a_folder_that_the_next_run_takes_up() {
    let exact = ["--method", "events", "--setting", "default"];
    for options in [&["--solver", WHOLE][..], &["--solver", "condensed", "--setting", "default"], &exact] {
        let tried = all_faults(&Case::new(&small(), options), 1);
        println!("{options:?}: {tried} faults");
    }
}

/// Commands that cannot resume do not speak of it after a full disk.
#[test]
fn a_full_disk_is_told_with_what_the_command_can_do() {
    let (folder, scene) = Folder::with_scene(&small());
    let out = folder.join("out");
    for arguments in [
        &["init", "block", "--out", &out][..],
        &["sweep", &scene, "--vary", "contact.friction=0.1,0.2", "--out", &out],
        &["converge", &scene, "--for", "force", "--out", &out],
        &["run", &scene, "--out", &out],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.args(arguments).env("LD_PRELOAD", shim()).env("FAULT_AT", "1").env("FAULT", "enospc");
        let output = command.env("FAULT_LASTS", "1").output().unwrap();
        assert_exit(&output, 3);
        assert!(
            joined_message(&output).contains("free disk space, and type the command again"),
            "{}",
            joined_message(&output)
        );
        assert!(!joined_message(&output).contains("--resume"), "{}", joined_message(&output));
    }
}

/// Runs again into the folder of the same run, killed at one call after the other: what it leaves is resumed, and
/// nothing but results remains.
#[test]
fn a_second_run_that_is_killed_at_any_call_is_resumed() {
    let scene = small().replace("increments = 4", "increments = 2").replace("[output]", "[output]\nfields = true");
    let case = Case::new(&scene, &["--setting", "default"]);
    let calls = case.whole("whole");
    let copy = |out: &str| {
        fs::create_dir_all(case.path(out)).unwrap();
        for entry in fs::read_dir(case.path("whole")).unwrap().map(Result::unwrap) {
            fs::copy(entry.path(), case.path(out).join(entry.file_name())).unwrap();
        }
    };
    let names = |out: &str| {
        let entries = fs::read_dir(case.path(out)).unwrap().map(|entry| entry.unwrap().file_name());
        entries.collect::<std::collections::BTreeSet<_>>()
    };
    for at in 1.. {
        copy("second");
        let output = case.failing("second", at, "kill", false);
        let done = output.status.success();
        assert!(done || output.status.code().is_none(), "{at}: {}", stderr(&output));
        let output = case.command("second", &["--resume"]).output().unwrap();
        assert_exit(&output, 0);
        assert_same(&case.path("whole"), &case.path("second"));
        assert_eq!(names("second"), names("whole"), "killed at call {at}");
        fs::remove_dir_all(case.path("second")).unwrap();
        if done {
            assert!(at > calls);
            break;
        }
    }
}

/// Returns the number of increments in the table of a folder.
fn listed(folder: &Path) -> usize {
    fs::read_to_string(folder.join("increments.csv")).map_or(0, |table| table.lines().count().saturating_sub(1))
}

/// Kills a run at random times, up to the duration of an uninterrupted run, and resumes it until it is finished.
/// Returns the number of kills. At most one increment is solved again.
fn killed_until_done(case: &Case, out: &str, random: &mut Random) -> usize {
    let start = Instant::now();
    case.whole("whole");
    let longest = start.elapsed();
    for killed in 0..200 {
        let resume: &[&str] = if killed == 0 { &[] } else { &["--resume"] };
        let listed = listed(&case.path(out));
        let mut child = case.command(out, resume).stdout(Stdio::piped()).spawn().unwrap();
        sleep(longest.mul_f64(random.next()));
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        if let Some((_, after)) = stdout(&output).split_once("resume       after ") {
            let done: usize = after.split(' ').next().unwrap().parse().unwrap();
            assert!(done <= listed && listed <= done + 1, "{listed} were there, and it went on after {done}");
        }
        if output.status.success() {
            return killed;
        }
    }
    panic!("never done")
}

#[test]
fn a_run_that_is_killed_again_and_again_ends_as_if_it_had_not_been() {
    let scene = small().replace("[4, 4]", "[20, 20]").replace("increments = 4", "increments = 30");
    let mut random = Random(20);
    let exact = ["--method", "events", "--setting", "default"];
    for options in [&["--setting", "default", "--solver", WHOLE][..], &["--method", "ip", "--solver", WHOLE], &exact] {
        let case = Case::new(&scene, options);
        let killed = killed_until_done(&case, "killed", &mut random);
        assert_same(&case.path("whole"), &case.path("killed"));
        println!("{options:?}: killed {killed} times");
    }
}

#[test]
#[ignore = "minutes"]
fn two_hundred_kills() {
    let scene = small().replace("[4, 4]", "[30, 30]").replace("increments = 4", "increments = 100");
    let mut random = Random(200);
    let (mut kills, mut runs) = (0, 0);
    while kills < 200 {
        let options: [&[&str]; 3] =
            [&["--solver", WHOLE], &["--setting", "default"], &["--method", "events", "--setting", "default"]];
        let options = options[runs % 3];
        let case = Case::new(&scene, options);
        kills += killed_until_done(&case, "killed", &mut random);
        assert_same(&case.path("whole"), &case.path("killed"));
        runs += 1;
    }
    println!("{kills} kills in {runs} runs");
}

#[test]
fn a_run_that_was_another_is_not_gone_on_with() {
    let case = Case::new(&small(), &[]);
    assert!(case.failing("left", 60, "kill", false).status.code().is_none());
    let refused = |options: &[&str], words: &str| {
        let output = case.command("left", &[options, &["--resume"]].concat()).output().unwrap();
        assert_exit(&output, 2);
        assert!(joined_message(&output).contains(words), "{}", joined_message(&output));
    };
    refused(&["--set", "contact.friction=0.5"], "friction = 0.4");
    refused(&["--set", "time.increments=5"], "line");
    refused(&["--uniqueness"], "--uniqueness");
    let output = case.command("left", &["--resume"]).output().unwrap();
    assert_exit(&output, 0);
    assert!(stdout(&output).contains("resume       after"), "{}", stdout(&output));
    // The run is complete: there is nothing to do, and the same report is printed.
    let report = fs::read_to_string(case.path("left/run.json")).unwrap();
    let output = case.command("left", &["--resume", "--json"]).output().unwrap();
    assert_exit(&output, 0);
    assert_eq!(stdout(&output), report);
}

/// A resumed run keeps its linear solver, and tells why it was chosen.
#[test]
fn the_reason_for_the_solver_outlives_a_kill() {
    let chosen = |case: &Case, out: &str| {
        let report = fs::read_to_string(case.path(out).join("run.json")).unwrap();
        serde_json::from_str::<serde_json::Value>(&report).unwrap()["solver_choice"].clone()
    };
    for (solver, has_reason) in [("auto", true), ("condensed", false)] {
        let case = Case::new(&small(), &["--setting", "default", "--solver", solver]);
        assert!(case.failing("left", 75, "kill", false).status.code().is_none());
        assert!(case.path("left/.checkpoint").exists());
        let output = case.command("left", &["--resume"]).output().unwrap();
        assert_exit(&output, 0);
        assert!(stdout(&output).contains("resume       after"), "{}", stdout(&output));
        case.whole("whole");
        assert_eq!(chosen(&case, "left"), chosen(&case, "whole"));
        assert_eq!(chosen(&case, "left").is_string(), has_reason);
    }
}

#[test]
fn checkpoints_that_are_damaged_and_tables_that_are_cut_are_told() {
    let case = Case::new(&small(), &[]);
    case.whole("whole");
    let left = |name: &str| {
        assert!(case.failing(name, 75, "kill", false).status.code().is_none());
        assert!(case.path(name).join(".checkpoint").exists());
    };
    // A damaged checkpoint is refused, so that the results beside it stay; a new run replaces them.
    left("cut");
    let bytes = fs::read(case.path("cut/.checkpoint")).unwrap();
    let increments = fs::read(case.path("cut/increments.csv")).unwrap();
    for length in [0, bytes.len() / 2] {
        fs::write(case.path("cut/.checkpoint"), &bytes[..length]).unwrap();
        let output = case.command("cut", &["--resume"]).output().unwrap();
        assert_exit(&output, 2);
        assert!(
            joined_message(&output).contains("checkpoint") && joined_message(&output).contains("damaged"),
            "{}",
            joined_message(&output)
        );
        assert_eq!(fs::read(case.path("cut/increments.csv")).unwrap(), increments);
    }
    assert_exit(&case.command("cut", &[]).output().unwrap(), 0);
    assert_same(&case.path("whole"), &case.path("cut"));
    left("table");
    fs::write(case.path("table/forces.csv"), "index\n").unwrap();
    let output = case.command("table", &["--resume"]).output().unwrap();
    assert_exit(&output, 2);
    assert!(joined_message(&output).contains("forces.csv"), "{}", joined_message(&output));
}
