//! A SuiteSparse of another version than the headers is refused with a message, before any other call.

#![cfg(feature = "umfpack")]
#![allow(clippy::unwrap_used)]

use std::fs;
use std::process::{Command, Output};

use crate::program::{BLOCK, Folder, assert_exit, small, stderr};

/// Builds a library in `folder` that reports version 99.7.1 by the function `name`.
fn other_version(folder: &Folder, name: &str) -> String {
    let (source, library) = (folder.join(&format!("{name}.c")), folder.join(&format!("{name}.so")));
    fs::write(
        &source,
        format!("int {name}(int version[3]) {{ version[0] = 99; version[1] = 7; return version[2] = 1; }}"),
    )
    .unwrap();
    let built = Command::new("cc").args(["-shared", "-fPIC", "-o", &library, &source]).output().unwrap();
    assert!(built.status.success(), "{}", stderr(&built));
    library
}

#[test]
fn a_library_of_another_version_ends_the_run_in_words() {
    let (folder, scene) = Folder::with_scene(&small());
    for (name, library) in
        [("SuiteSparse_version", "SuiteSparse"), ("cholmod_l_version", "CHOLMOD"), ("umfpack_version", "UMFPACK")]
    {
        let other = other_version(&folder, name);
        let run = |solver: &str| -> Output {
            let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
            command.env("LD_PRELOAD", &other).args(["run", &scene, "--solver", solver]).output().unwrap()
        };
        for solver in ["umfpack", "condensed"] {
            let output = run(solver);
            assert_exit(&output, 3);
            let message = stderr(&output).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
            for words in [&format!("{library} 99.7.1 is loaded") as &str, "rebuild it", "the solver faer"] {
                assert!(message.contains(words), "{solver}: `{words}` is not in: {message}");
            }
        }
        // As suggested in the message.
        if cfg!(feature = "faer") {
            assert_exit(&run("faer"), 0);
        }
    }
}

/// The run is long enough for advice on a faster solver, which CHOLMOD estimates. Without CHOLMOD there is no advice,
/// but the run is complete.
#[test]
#[cfg(feature = "faer")]
fn advice_that_fails_takes_nothing_from_a_run() {
    let (folder, scene) = Folder::with_scene(BLOCK);
    let other = other_version(&folder, "cholmod_l_version");
    let long = ["--set", "mesh.elements=[40,40]", "--set", "time.increments=40"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
    command.env("LD_PRELOAD", &other).args(["run", &scene, "--solver", "faer"]).args(long);
    assert_exit(&command.output().unwrap(), 0);
}
