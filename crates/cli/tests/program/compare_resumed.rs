//! Interrupted comparisons are resumed: finished histories are not computed again.
#![allow(clippy::unwrap_used)]

use std::collections::HashMap;
use std::sync::Mutex;
use stickslip::scene::Scene;
use stickslip::solver::Checkpoint;
use stickslip::solver::history::Method;
use stickslip_cli::compare::{self, Cells, Comparison, MeshSize, Plan, SolverPath};

/// A store that keeps histories in memory, as bytes, and counts them.
#[derive(Default)]
struct Kept {
    of: Mutex<HashMap<String, Vec<u8>>>,
    computed: Mutex<usize>,
}

impl Cells for Kept {
    fn stored(&self, name: &str) -> Option<Checkpoint> {
        self.of.lock().unwrap().get(name).and_then(|bytes| Checkpoint::from_bytes(bytes).ok())
    }

    fn keep(&self, name: &str, history: &Checkpoint) {
        *self.computed.lock().unwrap() += 1;
        self.of.lock().unwrap().insert(name.to_string(), history.to_bytes().unwrap());
    }
}

impl Kept {
    /// Returns the number of histories computed since the last call.
    fn computed(&self) -> usize {
        std::mem::take(&mut self.computed.lock().unwrap())
    }
}

fn compared(text: &str, meshes: &[usize], increments: &[usize], cells: &Kept) -> Comparison {
    let set = ["mesh.elements=[8,8]".parse().unwrap()];
    let scene = Scene::parse("block.toml", text, &set).unwrap();
    let paths = [Method::BN, Method::Ip].map(|method| SolverPath { method: method.into(), linear: None });
    let plan = Plan {
        paths: paths.to_vec(),
        meshes: meshes.iter().map(|&n| MeshSize::Elements(n).into()).collect(),
        increments: increments.to_vec(),
        reference: 4,
        jobs: 2,
    };
    compare::compute(&scene, &plan, cells, &mut |_| (), || false).unwrap()
}

#[test]
fn what_is_kept_is_not_computed_again() {
    let text = include_str!("../../../../data/scenes/block.toml");
    let stored = Kept::default();
    let whole = compared(text, &[4, 8], &[2, 4], &stored);
    assert_eq!(stored.computed(), 2 + 2 * 2 * 2);
    // Times agree too, although they differ between computations; only the time for building meshes is new.
    let again = compared(text, &[4, 8], &[2, 4], &stored);
    assert_eq!((stored.computed(), &again), (0, &whole));
    // Damaged or missing histories are computed again.
    let mut names: Vec<String> = stored.of.lock().unwrap().keys().cloned().collect();
    names.sort();
    stored.of.lock().unwrap().remove(&names[0]);
    stored.of.lock().unwrap().get_mut(&names[3]).unwrap()[60] ^= 1;
    let mended = compared(text, &[4, 8], &[2, 4], &stored);
    assert_eq!(stored.computed(), 2, "{names:?}");
    for (one, other) in mended.runs.iter().zip(&whole.runs) {
        assert_eq!(
            (one.errors, one.course.kkt, one.course.iterations),
            (other.errors, other.course.kkt, other.course.iterations)
        );
    }
    for (one, other) in mended.meshes.iter().zip(&whole.meshes) {
        assert_eq!((&one.end, one.errors, &one.estimates), (&other.end, other.errors, &other.estimates));
    }
    // A larger comparison computes only new histories. Another reference is a new history.
    compared(text, &[4, 8], &[1, 2, 4], &stored);
    assert_eq!(stored.computed(), 4);
    compared(text, &[4, 8], &[8], &stored);
    assert_eq!(stored.computed(), 2 + 4);
}

#[cfg(target_os = "linux")]
mod program {
    use std::fs;
    use std::process::{Command, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    use crate::program::{Folder, assert_exit, send, stderr, stdout};

    /// A comparison killed after some histories is resumed with the others. A changed scene is computed anew.
    #[test]
    fn a_comparison_that_is_killed_goes_on() {
        ended_by("KILL");
    }

    /// A comparison that is stopped shows what is complete.
    #[test]
    fn a_comparison_that_is_stopped_shows_what_is_there() {
        ended_by("INT");
    }

    fn ended_by(signal: &str) {
        let (folder, scene) = Folder::with_scene(include_str!("../../../../data/scenes/block.toml"));
        let out = folder.0.join("out");
        let command = |more: &[&str]| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_stickslip"));
            command.args(["compare", &scene, "--meshes", "4,16", "--increments", "2,8,40", "--jobs", "1"]);
            command.args(["--solvers", "faer"]).args(more).arg("--out").arg(&out);
            command.stdout(Stdio::piped()).stderr(Stdio::piped());
            command
        };
        let kept = || fs::read_dir(out.join(".cells")).map_or(0, Iterator::count);
        let child = command(&[]).spawn().unwrap();
        let begun = Instant::now();
        while kept() < 4 && begun.elapsed() < Duration::from_secs(60) {
            sleep(Duration::from_millis(2));
        }
        send(signal, child.id());
        let output = child.wait_with_output().unwrap();
        let left = kept();
        if signal == "INT" {
            assert_exit(&output, 1);
            let last = format!("interrupted  {left} of 14 histories are complete; repeat the command with --resume");
            assert!(stdout(&output).contains(&last), "{}", stdout(&output));
            let runs = fs::read_to_string(out.join("compare.csv")).unwrap();
            assert_eq!(runs.lines().count() + 1, left, "{runs}");
        }
        assert!((4..2 + 2 * 2 * 3).contains(&left), "{left}");
        let output = command(&["--resume"]).output().unwrap();
        assert_exit(&output, 0);
        assert!(stderr(&output).is_empty());
        assert!(out.join("compare.csv").exists() && !out.join(".cells").exists());
    }
}
