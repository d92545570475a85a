//! The ownership of a result folder, and the files allowed in it.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::os::unix::fs::symlink;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::resume::{Case, joined_message};
use crate::program::{assert_exit, small, stdout, without};
use crate::whole::{assert_whole, files};

/// Returns a run that takes a while.
fn long() -> Case {
    Case::new(&small().replace("[4, 4]", "[20, 20]").replace("increments = 4", "increments = 400"), &[])
}

/// Starts a run that has written into `out`.
fn underway(case: &Case) -> Child {
    let child = case.command("out", &[]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    while !case.path("out/increments.csv").exists() {
        sleep(Duration::from_millis(5));
    }
    child
}

#[test]
fn a_folder_is_written_by_one_command_at_a_time() {
    let case = long();
    let mut first = underway(&case);
    let scene = case.path("scene.toml");
    let study = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
        command.arg(words[0]).arg(&scene).args(&words[1..]).arg("--out").arg(case.path("out"));
        command
    };
    let [mut sweep, mut compare] =
        [&["sweep", "--vary", "contact.friction=0.1,0.2"][..], &["compare", "--meshes", "2"]].map(study);
    for command in [&mut case.command("out", &[]), &mut sweep, &mut compare] {
        let second = command.output().unwrap();
        assert_exit(&second, 2);
        assert!(joined_message(&second).contains("another run is writing"), "{}", joined_message(&second));
    }
    first.kill().unwrap();
    first.wait().unwrap();
    assert_whole(&case.path("out"));
}

#[test]
fn links_are_not_followed_and_the_results_before_stay_until_there_are_others() {
    let case = Case::new(&small(), &[]);
    assert_exit(&case.command("out", &[]).output().unwrap(), 0);
    let before = files(&case.path("out"));
    // Nothing holds this body: the run fails before its first increment, and its report replaces the earlier results.
    let hopeless = Case::new("mesh = { kind = 'block', elements = [2, 2] }", &[]);
    let output = hopeless.command("x", &[]).output().unwrap();
    assert_exit(&output, 2);
    assert!(!hopeless.path("x").exists());
    let elsewhere = case.path("elsewhere");
    fs::write(&elsewhere, "mine").unwrap();
    for name in ["increments.csv", "run.json", "contact_0004.csv"] {
        fs::remove_file(case.path("out").join(name)).unwrap();
        symlink(&elsewhere, case.path("out").join(name)).unwrap();
    }
    assert_exit(&case.command("out", &[]).output().unwrap(), 0);
    assert_eq!(fs::read_to_string(&elsewhere).unwrap(), "mine");
    assert_eq!(files(&case.path("out")).len(), before.len());
}

#[test]
fn a_folder_that_is_removed_is_told() {
    let case = long();
    let child = underway(&case);
    while fs::remove_dir_all(case.path("out")).is_err() {}
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 3);
    let message = joined_message(&output);
    assert!(message.contains("removed") && !message.contains("free disk space"), "{message}");
}

#[test]
fn a_folder_that_is_moved_takes_the_results_with_it() {
    let case = long();
    let child = underway(&case);
    fs::rename(case.path("out"), case.path("moved")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_exit(&output, 0);
    assert!(stdout(&output).contains(case.path("moved").to_str().unwrap()), "{}", stdout(&output));
    assert_whole(&case.path("moved"));
}

#[test]
fn a_complete_run_is_complete_only_with_its_files() {
    let case = Case::new(&small(), &[]);
    assert_exit(&case.command("out", &[]).output().unwrap(), 0);
    assert_exit(&case.command("out", &["--resume"]).output().unwrap(), 0);
    for name in ["forces.csv", "run.json", "contact_0004.csv"] {
        let path = case.path("out").join(name);
        let bytes = fs::read(&path).unwrap();
        let refused = || {
            let output = case.command("out", &["--resume"]).output().unwrap();
            assert_exit(&output, 2);
            assert!(joined_message(&output).contains(name), "{}", joined_message(&output));
        };
        fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        refused();
        fs::remove_file(&path).unwrap();
        refused();
        fs::write(&path, bytes).unwrap();
    }
    assert_exit(&case.command("out", &["--resume"]).output().unwrap(), 0);
}

#[test]
fn what_is_no_file_is_named() {
    let case = Case::new(&small(), &[]);
    let pipe = |name: &str| assert!(Command::new("mkfifo").arg(case.path(name)).status().unwrap().success());
    for name in [".checkpoint", ".stickslip"] {
        for kind in ["link", "pipe", "folder"] {
            assert_exit(&case.command("out", &[]).output().unwrap(), 0);
            let (path, aside) = (case.path("out").join(name), case.path("aside"));
            fs::rename(&path, &aside).unwrap();
            match kind {
                "link" => symlink(&aside, &path).unwrap(),
                "pipe" => pipe(&format!("out/{name}")),
                _ => fs::create_dir(&path).unwrap(),
            }
            for more in [&[][..], &["--resume"]] {
                let output = case.command("out", more).output().unwrap();
                assert_exit(&output, 2);
                assert!(joined_message(&output).contains(name), "{kind}: {}", joined_message(&output));
            }
            fs::remove_dir_all(case.path("out")).unwrap();
            fs::remove_file(aside).unwrap();
        }
    }
    // Nothing writes into the pipe, so a reader waits for ever.
    pipe("mesh.msh");
    let mesh = format!("[mesh]\nkind = \"gmsh\"\nfile = {:?}\n\n", case.path("mesh.msh"));
    let of_a_pipe = Case::new(&[without(&small(), "[mesh]", "[material]"), mesh].concat(), &[]);
    let output = of_a_pipe.command("out", &[]).output().unwrap();
    assert_exit(&output, 2);
    assert!(joined_message(&output).contains("pipe"), "{}", joined_message(&output));
}
