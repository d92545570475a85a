//! The program as several processes of MPI, more of them than processors: what it solves, and how it ends. A hang is the failure to be
//! expected here, so that every job has a minute.

use std::fs::{self, File};
use std::io::Write;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::common::program::Folder;
use crate::common::whole::assert_whole;
use crate::scenes::{INCREMENTS, SCENES, assert_same_forces, iterations, path, report};

const PROGRAM: &str = env!("CARGO_BIN_EXE_stickslip");
const PATIENCE: Duration = Duration::from_secs(60);

/// Jobs one after the other: ranks that wait for each other on few processors are slow enough.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A launcher with `count` processes.
struct Job {
    folder: Folder,
    launcher: Child,
    start: Instant,
    _alone: MutexGuard<'static, ()>,
}

/// How it ended.
struct Ended {
    folder: Folder,
    status: Option<i32>,
    output: String,
    error: String,
}

impl Job {
    fn start(count: usize, arguments: &[&str]) -> Self {
        Job::start_in(Folder::new(), count, PROGRAM, arguments)
    }

    /// `arguments` for `program`, and `OUT` in them stands for the folder of the results.
    fn start_in(folder: Folder, count: usize, program: &str, arguments: &[&str]) -> Self {
        let alone = alone();
        let out = folder.join("out");
        let mut command = Command::new("mpirun");
        // As root, with more processes than processors, which then make room for each other.
        for name in [
            "ALLOW_RUN_AS_ROOT",
            "ALLOW_RUN_AS_ROOT_CONFIRM",
            "MCA_rmaps_base_oversubscribe",
            "MCA_mpi_yield_when_idle",
        ] {
            command.env(format!("OMPI_{name}"), "1");
        }
        // What cargo has set for the tests is not for the launcher.
        command.env_remove("LD_LIBRARY_PATH").stdin(Stdio::null());
        command.args(["-n", &count.to_string(), program]);
        command.args(arguments.iter().map(|argument| if *argument == "OUT" { out.as_str() } else { argument }));
        command
            .stdout(File::create(folder.join("stdout")).unwrap())
            .stderr(File::create(folder.join("stderr")).unwrap());
        Job { launcher: command.spawn().unwrap(), folder, start: Instant::now(), _alone: alone }
    }

    fn output(&self) -> String {
        fs::read_to_string(self.folder.join("stdout")).unwrap()
    }

    /// Waits until `there` is something.
    fn when<T>(&mut self, there: impl Fn(&Self) -> Option<T>) -> T {
        loop {
            if let Some(there) = there(self) {
                return there;
            }
            assert!(self.launcher.try_wait().unwrap().is_none(), "ended too early: {}", self.output());
            assert!(self.start.elapsed() < PATIENCE, "{}", self.output());
            sleep(Duration::from_millis(5));
        }
    }

    /// Waits until so many increments are told.
    fn reaches(&mut self, increments: usize) {
        let mark = format!("\n{increments:5}  ");
        self.when(|job| job.output().contains(&mark).then_some(()));
    }

    /// The process numbers of the ranks.
    fn ranks(&mut self, count: usize) -> Vec<u32> {
        let launcher = self.launcher.id();
        let ranks = |_: &Job| {
            let text = fs::read_to_string(format!("/proc/{launcher}/task/{launcher}/children")).ok()?;
            let mut ranks: Vec<u32> = text.split_whitespace().map(|pid| pid.parse().unwrap()).collect();
            ranks.retain(|pid| environment(*pid, "OMPI_COMM_WORLD_RANK").is_some());
            ranks.sort_by_key(|pid| environment(*pid, "OMPI_COMM_WORLD_RANK"));
            (ranks.len() == count).then_some(ranks)
        };
        self.when(ranks)
    }

    fn end(mut self) -> Ended {
        let status = loop {
            if let Some(status) = self.launcher.try_wait().unwrap() {
                break status.code();
            }
            if self.start.elapsed() > PATIENCE {
                let _ = self.launcher.kill();
                panic!("no end after a minute: {}", self.output());
            }
            sleep(Duration::from_millis(10));
        };
        let text = |name: &str| fs::read_to_string(self.folder.join(name)).unwrap();
        Ended { status, output: text("stdout"), error: text("stderr"), folder: self.folder }
    }
}

impl Ended {
    fn out(&self) -> PathBuf {
        self.folder.0.join("out")
    }

    fn report(&self) -> Value {
        serde_json::from_str(&fs::read_to_string(self.out().join("run.json")).unwrap()).unwrap()
    }

    /// An error message without its line breaks.
    fn told(&self) -> String {
        self.error.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }
}

/// A variable of a process.
fn environment(pid: u32, name: &str) -> Option<String> {
    let all = fs::read(format!("/proc/{pid}/environ")).ok()?;
    let text = String::from_utf8_lossy(&all).into_owned();
    text.split('\0').find_map(|pair| Some(pair.strip_prefix(name)?.strip_prefix('=')?.to_string()))
}

/// CPU seconds of a process.
fn cpu(pid: u32) -> f64 {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
    let fields: Vec<&str> = stat.rsplit(") ").next().unwrap().split_whitespace().collect();
    fields[11..13].iter().map(|ticks| ticks.parse::<f64>().unwrap() / 100.0).sum()
}

fn signal(name: &str, pid: u32) {
    assert!(Command::new("kill").args([name, &pid.to_string()]).status().unwrap().success());
}

/// A run that takes some seconds: a cube in many increments.
const LONG: [&str; 13] = [
    "run",
    concat!(env!("CARGO_MANIFEST_DIR"), "/data/scenes/cube.toml"),
    "--solver",
    "mumps",
    "--set",
    "mesh.elements=[9,9,9]",
    "--set",
    "time.increments=12",
    "--checkpoint-every",
    "0",
    "--resume",
    "--out",
    "OUT",
];

/// The same, ended by nothing.
fn whole() -> Value {
    let overrides = ["mesh.elements=[9,9,9]".parse().unwrap(), "time.increments=12".parse().unwrap()];
    let scene = stickslip::scene::Scene::read(path("cube").as_ref(), &overrides).unwrap();
    let report = stickslip::run::Run::new(&scene).unwrap().solve(&mut ()).unwrap();
    serde_json::from_str(&report.to_json().unwrap()).unwrap()
}

/// What was written is whole, and the run goes on from there to its end.
fn goes_on(ended: Ended) {
    assert_whole(&ended.out());
    let ended = Job::start_in(ended.folder, 2, PROGRAM, &LONG).end();
    assert_eq!(ended.status, Some(0), "{} {}", ended.output, ended.error);
    assert_same_forces("cube", &ended.report(), &whole(), 1e-11);
}

#[test]
fn every_scene_is_the_same_on_two_and_four_ranks() {
    for (name, overrides) in SCENES {
        let expected = report(name, overrides, "umfpack");
        for count in [2, 4] {
            let scene = path(name);
            let changes: Vec<&str> =
                overrides.iter().chain(&[INCREMENTS]).flat_map(|change| ["--set", change]).collect();
            let arguments = [&["run", &scene, "--solver", "mumps", "--out", "OUT"][..], &changes].concat();
            let ended = Job::start(count, &arguments).end();
            assert_eq!(ended.status, Some(0), "{name} on {count}: {} {}", ended.output, ended.error);
            let found = ended.report();
            assert_eq!(iterations(&found), iterations(&expected), "{name} on {count}");
            assert_same_forces(name, &found, &expected, 1e-11);
            assert_eq!(found["totals"]["symbolic_analyses"], 1, "{name}");
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
        (&["run", &cube][..], "has started this program 2 times, and umfpack works in one process"),
        (&["run", &cube, "--solver", "condensed"], "and condensed works in one process"),
        (&["sweep", &cube, "--vary", "time.increments=1,2"], "has started sweep, which has no use for ranks"),
        (&["compare", &cube], "has started compare, which has no use for ranks"),
        (&["run", "nowhere.toml", "--solver", "mumps"], "the scene cannot be read"),
        (&["runs"], "unrecognized subcommand"),
    ] {
        let ended = Job::start(2, arguments).end();
        assert_eq!(ended.status, Some(2), "{arguments:?}: {}", ended.error);
        assert_eq!(ended.told().matches(words).count(), 1, "{arguments:?}: {}", ended.error);
    }
    let ended = Job::start(2, &["check", &cube]).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    assert_eq!(ended.output.matches("\nmesh").count(), 1, "{}", ended.output);
}

#[test]
fn auto_takes_what_ranks_can_share() {
    let cube = path("cube");
    let small = ["--set", "mesh.elements=[4,4,4]", "--set", "time.increments=1"];
    let ended = Job::start(2, &[&["run", &cube, "--solver", "auto", "--out", "OUT"][..], &small].concat()).end();
    assert_eq!(ended.status, Some(0), "{}", ended.error);
    let report = ended.report();
    assert_eq!(report["solver"], "mumps");
    assert!(report["solver_choice"].as_str().unwrap().contains("2 processes"), "{}", report["solver_choice"]);
}

#[test]
fn usr1_to_the_launcher_ends_a_run_in_order() {
    let mut job = Job::start(2, &LONG);
    job.reaches(2);
    signal("-USR1", job.launcher.id());
    let ended = job.end();
    assert_eq!(ended.status, Some(1), "{}", ended.error);
    assert_eq!(ended.report()["status"], "interrupted");
    goes_on(ended);
}

#[test]
fn term_to_the_launcher_ends_a_run_and_leaves_what_was_reached() {
    let mut job = Job::start(2, &LONG);
    job.reaches(2);
    signal("-TERM", job.launcher.id());
    let ended = job.end();
    assert_ne!(ended.status, Some(0), "{}", ended.error);
    goes_on(ended);
}

#[test]
fn a_rank_that_is_killed_ends_the_job_and_leaves_what_was_reached() {
    for rank in [0, 1] {
        let mut job = Job::start(2, &LONG);
        job.reaches(2);
        let pid = job.ranks(2)[rank];
        signal("-KILL", pid);
        let ended = job.end();
        assert_ne!(ended.status, Some(0), "{}", ended.error);
        goes_on(ended);
    }
}

/// Limits the memory of rank 1.
fn limited(folder: &Folder, kilobytes: u64) -> String {
    let script = folder.join("limited");
    let mut file = File::create(&script).unwrap();
    write!(file, "#!/bin/sh\n[ \"$OMPI_COMM_WORLD_RANK\" = 1 ] && ulimit -v {kilobytes}\nexec {PROGRAM} \"$@\"\n")
        .unwrap();
    fs::set_permissions(Path::new(&script), fs::Permissions::from_mode(0o755)).unwrap();
    script
}

#[test]
fn memory_that_one_rank_is_refused_is_told() {
    let mut steps = Vec::new();
    // From less than the BLAS takes for itself to enough.
    for kilobytes in [300_000, 520_000, 540_000, 560_000, 580_000, 2_000_000] {
        let folder = Folder::new();
        let program = limited(&folder, kilobytes);
        let mut arguments = LONG;
        (arguments[5], arguments[7]) = ("mesh.elements=[16,16,16]", "time.increments=1");
        let ended = Job::start_in(folder, 2, &program, &arguments).end();
        match ended.status {
            Some(3) => {
                let told = ended.told();
                assert!(told.contains("out of memory in "), "{kilobytes}: {told}");
                steps.push(told.split("out of memory in ").nth(1).unwrap()[..8].to_string());
            }
            status => assert_eq!(status, Some(0), "{kilobytes}: {}", ended.error),
        }
        assert_whole(&ended.out());
        assert!(kilobytes > 300_000 || ended.status == Some(3));
        assert!(kilobytes < 2_000_000 || ended.status == Some(0));
    }
    println!("{steps:?}");
    assert_eq!(steps[0], "the BLAS");
}

#[test]
fn who_is_not_needed_sleeps() {
    let cube = path("cube");
    let mut job = Job::start(2, &["run", &cube, "--solver", "mumps", "--set", "mesh.elements=[20,20,20]"]);
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
