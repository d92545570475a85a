//! The program as several MPI processes: its results, and how it ends.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;

use crate::job::{Ended, Job, PROGRAM, cpu, other_ranks_with, signal, without_ours};
use crate::program::Folder;
use crate::scenes::{INCREMENTS, SCENES, assert_same_forces, iterations, path, report};
use crate::whole::assert_whole;

/// The solvers that ranks share, each with the relative difference of forces allowed between runs, and the iterations
/// of an increment.
const SHARED: &[(&str, f64, u64)] = &[("mumps", 1e-11, 0), ("multigrid", 1e-10, 2)];

/// A run that takes some seconds: a cube in many increments.
///
/// The tolerance is below that of the forces: a run that goes on begins without the hierarchies that the whole run has,
/// and ends an increment at another state within the tolerance.
const LONG: [&str; 13] = [
    "run",
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/scenes/cube.toml"),
    "--set",
    "mesh.elements=[9,9,9]",
    "--set",
    "time.increments=12",
    "--set",
    "solver.tolerance=1e-12",
    "--checkpoint-every",
    "0",
    "--resume",
    "--out",
    "OUT",
];

fn long(solver: &str) -> Vec<&str> {
    [&LONG[..], &["--solver", solver]].concat()
}

/// Returns the report of an uninterrupted run.
fn whole() -> Value {
    let overrides = ["mesh.elements=[9,9,9]", "time.increments=12", "solver.tolerance=1e-12"];
    let overrides = overrides.map(|change| change.parse().unwrap());
    let scene = stickslip::scene::Scene::read(path("cube").as_ref(), &overrides).unwrap();
    let report = stickslip::run::Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    serde_json::from_str(&report.to_json().unwrap()).unwrap()
}

/// Checks that the files are complete, and that the run can be resumed to its end.
fn goes_on(ended: Ended, solver: &str, tolerance: f64) {
    assert_whole(&ended.out());
    let ended = Job::start_in(ended.folder, 2, PROGRAM, &long(solver)).end();
    assert_eq!(ended.status, Some(0), "{} {}", ended.output, ended.error);
    assert_same_forces("cube", &ended.report(), &whole(), tolerance);
}

#[test]
fn every_scene_is_the_same_on_two_and_four_ranks() {
    for (name, overrides) in SCENES {
        let expected = report(name, overrides, "umfpack");
        for (&(solver, tolerance, more), count) in SHARED.iter().flat_map(|shared| [(shared, 2), (shared, 4)]) {
            let scene = path(name);
            let changes: Vec<&str> =
                overrides.iter().chain(&[INCREMENTS]).flat_map(|change| ["--set", change]).collect();
            let arguments = [&["run", &scene, "--solver", solver, "--out", "OUT"][..], &changes].concat();
            let ended = Job::start(count, &arguments).end();
            let what = format!("{name} by {solver} on {count}");
            assert_eq!(ended.status, Some(0), "{what}: {} {}", ended.output, ended.error);
            let found = ended.report();
            let (by, expected_by) = (iterations(&found), iterations(&expected));
            println!("{what}: {by:?}, {expected_by:?}");
            assert!(by.iter().zip(&expected_by).all(|(by, expected)| by.abs_diff(*expected) <= more), "{what}: {by:?}");
            assert_same_forces(&what, &found, &expected, tolerance);
            assert_eq!(found["totals"]["symbolic_analyses"], 1, "{what}");
            let ranks = found["totals"]["ranks"].as_array().unwrap();
            assert!(ranks.iter().map(|rank| rank["rank"].as_u64().unwrap()).eq(0..count as u64));
            assert!(ranks.iter().all(|rank| rank["peak_rss_bytes"].as_u64() > Some(1 << 20)));
            assert!(ended.output.contains(&format!("\nrank {} ", count - 1)), "{}", ended.output);
        }
    }
}

#[test]
fn other_commands_and_solvers_are_told_that_they_have_no_use_for_ranks() {
    let cube = path("cube");
    for (arguments, words) in [
        (
            &["run", &cube, "--solver", "umfpack"][..],
            "has started 2 processes of this program, but umfpack uses only one",
        ),
        (&["run", &cube, "--solver", "condensed"], "but condensed uses only one"),
        (&["sweep", &cube, "--vary", "time.increments=1,2"], "has started sweep, which has no use for ranks"),
        (&["compare", &cube], "has started compare, which has no use for ranks"),
        (&["run", "nowhere.toml", "--solver", SHARED[0].0], "the scene cannot be read"),
        (&["runs"], "unrecognized subcommand"),
    ] {
        let ended = Job::start(2, arguments).end();
        assert_eq!(ended.status, Some(2), "{arguments:?}: {}", ended.error);
        assert_eq!(ended.message().matches(words).count(), 1, "{arguments:?}: {}", ended.error);
    }
    let ended = Job::start(2, &["check", &cube]).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    assert_eq!(ended.output.matches("\nmesh").count(), 1, "{}", ended.output);
}

/// Started from a job of another program, to which the launcher's variables belong.
#[test]
fn a_rank_of_another_programs_job_works_for_itself() {
    for (solver, rank) in [("umfpack", "PMI_RANK"), (SHARED[0].0, "OMPI_COMM_WORLD_RANK")] {
        let folder = Folder::new();
        let (out, cube) = (folder.join("out"), path("cube"));
        let mut command = Command::new(PROGRAM);
        without_ours(&mut command);
        command.args(["run", &cube, "--solver", solver, "--set", "mesh.elements=[3,3,3]", "--out", &out]);
        let output = command.env(rank, "1").output().unwrap();
        assert!(output.status.success(), "{solver}: {output:?}");
        assert_whole(out.as_ref());
        let mut version = Command::new(PROGRAM);
        without_ours(&mut version);
        let output = version.arg("--version").env(rank, "1").output().unwrap();
        assert!(output.status.success() && output.stdout.starts_with(b"stickslip "), "{output:?}");
    }
    let ended = Job::start(2, &["--version"]).end();
    assert_eq!((ended.status, ended.output.lines().count()), (Some(0), 1), "{}", ended.output);
}

#[test]
fn a_rank_with_another_command_helps_all_the_same() {
    let folder = Folder::new();
    let script = other_ranks_with(&folder, "check \"$2\"");
    let cube = path("cube");
    let arguments = ["run", &cube, "--solver", SHARED[0].0, "--set", "mesh.elements=[3,3,3]", "--out", "OUT"];
    let ended = Job::start_in(folder, 2, &script, &arguments).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    assert!(ended.error.contains("rank 1 was started with other arguments than rank 0"), "{}", ended.error);
    assert_eq!(ended.report()["totals"]["ranks"].as_array().unwrap().len(), 2);
}

/// Each process takes its share, and solvers that cannot be shared are not chosen.
#[test]
fn check_tells_what_ranks_take() {
    let cube = path("cube");
    let check = |count: usize, more: &[&str]| {
        let arguments = [&["check", &cube, "--set", "mesh.elements=[12,12,12]"], more].concat();
        let ended = Job::start(count, &arguments).end();
        assert_eq!(ended.status, Some(0), "{}", ended.error);
        ended.output
    };
    let megabytes = |text: &str| {
        let line = text.lines().find(|line| line.starts_with("memory")).unwrap();
        let words: Vec<_> = line.split_whitespace().collect();
        words[words.iter().position(|word| *word == "MB").unwrap() - 1].parse::<f64>().unwrap()
    };
    let named = format!("solver.linear={:?}", SHARED[0].0);
    let [one, two] = [1, 2].map(|count| check(count, &["--set", &named]));
    assert!(megabytes(&two) < megabytes(&one) && two.contains(" for the first of 2 processes"), "{one}{two}");
    let (one, two) = (check(1, &[]), check(2, &[]));
    assert!(one.contains(" condensed: ") && two.contains(&format!(" {}: 2 processes, ", SHARED[0].0)), "{one}{two}");
}

#[test]
fn auto_takes_what_ranks_can_share() {
    let cube = path("cube");
    let small = ["--set", "mesh.elements=[4,4,4]", "--set", "time.increments=1"];
    let ended = Job::start(2, &[&["run", &cube, "--solver", "auto", "--out", "OUT"][..], &small].concat()).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    let report = ended.report();
    assert_eq!(report["solver"], SHARED[0].0);
    assert!(report["solver_choice"].as_str().unwrap().contains("2 processes"), "{}", report["solver_choice"]);
}

/// The stiffness for the choice of the solver is dropped before the rows are assembled. The choice itself takes the
/// most of rank 0, 277 MB; without it rank 0 takes 230 MB.
#[test]
fn auto_shares_a_stiffness_for_multigrid() {
    let cube = path("cube");
    let fine = ["--set", "mesh.elements=[20,20,20]", "--set", "time.increments=1"];
    let ended = Job::start(2, &[&["run", &cube, "--solver", "auto", "--out", "OUT"][..], &fine].concat()).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    let report = ended.report();
    assert_eq!(report["solver"], "multigrid", "{}", report["solver_choice"]);
    let ranks = report["totals"]["ranks"].as_array().unwrap();
    assert!(ranks.iter().all(|rank| rank["peak_rss_bytes"].as_u64() < Some(290_000_000)), "{ranks:?}");
}

#[test]
fn usr1_to_the_launcher_ends_a_run_in_order() {
    for &(solver, tolerance, _) in SHARED {
        let mut job = Job::start(2, &long(solver));
        job.reaches(2);
        signal("-USR1", job.launcher.id());
        let ended = job.end();
        assert_eq!(ended.status, Some(1), "{}", ended.error);
        assert_eq!(ended.report()["status"], "interrupted");
        goes_on(ended, solver, tolerance);
    }
}

#[test]
fn term_to_the_launcher_ends_a_run_and_leaves_what_was_reached() {
    for &(solver, tolerance, _) in SHARED {
        let mut job = Job::start(2, &long(solver));
        job.reaches(2);
        signal("-TERM", job.launcher.id());
        let ended = job.end();
        assert_ne!(ended.status, Some(0), "{}", ended.error);
        goes_on(ended, solver, tolerance);
    }
}

#[test]
fn a_rank_that_is_killed_ends_the_job_and_leaves_what_was_reached() {
    for (&(solver, tolerance, _), rank) in SHARED.iter().flat_map(|shared| [(shared, 0), (shared, 1)]) {
        let mut job = Job::start(2, &long(solver));
        job.reaches(2);
        let pid = job.ranks(2)[rank];
        signal("-KILL", pid);
        let ended = job.end();
        assert_ne!(ended.status, Some(0), "{}", ended.error);
        goes_on(ended, solver, tolerance);
    }
}

/// Returns a script that limits the memory of rank 1.
fn limited(folder: &Folder, kilobytes: u64) -> String {
    let script = folder.join("limited");
    let mut file = File::create(&script).unwrap();
    write!(file, "#!/bin/sh\n[ \"$OMPI_COMM_WORLD_RANK\" = 1 ] && ulimit -v {kilobytes}\nexec {PROGRAM} \"$@\"\n")
        .unwrap();
    fs::set_permissions(Path::new(&script), fs::Permissions::from_mode(0o755)).unwrap();
    script
}

/// Returns the least memory of rank 1, kB, with which Open MPI starts; with less it is ended by a signal, or waits for
/// ever. Open MPI 5 needs more than Open MPI 4.
fn least_to_start() -> u64 {
    let starts = |kilobytes: &u64| {
        let folder = Folder::new();
        let program = limited(&folder, *kilobytes);
        Job::start_in(folder, 2, &program, &["--version"]).ends_well()
    };
    (340_000..1_000_000).step_by(40_000).find(starts).unwrap()
}

#[test]
fn memory_that_one_rank_is_refused_is_told() {
    // Enough for MPI and the mesh, not for the BLAS.
    let least = least_to_start() + 40_000;
    for &(solver, ..) in SHARED {
        let mut steps = Vec::new();
        // Up to a sufficient limit.
        for kilobytes in (100..=240).step_by(20).map(|more| least + 1000 * more).chain([least, 2_000_000]) {
            let folder = Folder::new();
            let program = limited(&folder, kilobytes);
            let mut arguments = long(solver);
            (arguments[3], arguments[5]) = ("mesh.elements=[16,16,16]", "time.increments=1");
            let ended = Job::start_in(folder, 2, &program, &arguments).end();
            match ended.status {
                Some(3) => {
                    let message = ended.message();
                    assert!(message.contains("out of memory"), "{solver} {kilobytes}: {message}");
                    steps.push(message.split("out of memory").nth(1).unwrap()[..12].to_string());
                }
                status => assert_eq!(status, Some(0), "{solver} {kilobytes}: {}", ended.error),
            }
            assert_whole(&ended.out());
            assert!(kilobytes > least || ended.status == Some(3));
            assert!(kilobytes < 2_000_000 || ended.status == Some(0));
        }
        println!("{solver}: {steps:?}");
        assert_eq!(steps.last().unwrap(), " in the BLAS");
    }
}

#[test]
fn who_is_not_needed_sleeps() {
    let cube = path("cube");
    let mut job =
        Job::start(2, &["run", &cube, "--solver", SHARED[0].0, "--set", "mesh.elements=[20,20,20]", "--out", "OUT"]);
    job.when(|job| job.output().contains("set-up       mesh").then_some(()));
    let ranks = job.ranks(2);
    signal("-STOP", ranks[0]);
    let before = cpu(ranks[1]);
    sleep(Duration::from_secs(4));
    let used = cpu(ranks[1]) - before;
    signal("-CONT", ranks[0]);
    signal("-KILL", ranks[0]);
    assert_ne!(job.end().status, Some(0));
    println!("{used} s in 4 s");
    assert!(used <= 0.05 * 4.0, "{used} s in 4 s");
}
