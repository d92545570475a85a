//! Runs the program as several MPI processes, more of them than processors. The expected failure is a hang, so every
//! job is limited to a minute.

use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::program::Folder;

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_stickslip");
const PATIENCE: Duration = Duration::from_secs(60);

/// Runs jobs one after the other, because ranks waiting for each other on few processors are slow.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A launcher with `count` processes.
pub struct Job {
    pub folder: Folder,
    pub launcher: Child,
    start: Instant,
    _alone: MutexGuard<'static, ()>,
}

/// The end of a job.
pub struct Ended {
    pub folder: Folder,
    pub status: Option<i32>,
    pub output: String,
    pub error: String,
}

impl Job {
    pub fn start(count: usize, arguments: &[&str]) -> Self {
        Job::start_in(Folder::new(), count, PROGRAM, arguments)
    }

    /// Starts `program` with `arguments`, in which `OUT` is replaced by the result folder.
    pub fn start_in(folder: Folder, count: usize, program: &str, arguments: &[&str]) -> Self {
        let alone = alone();
        let out = folder.join("out");
        let mut command = Command::new("mpirun");
        without_ours(&mut command);
        // Allows to run as root, with more processes than processors, which then yield to each other.
        for name in [
            "ALLOW_RUN_AS_ROOT",
            "ALLOW_RUN_AS_ROOT_CONFIRM",
            "MCA_rmaps_base_oversubscribe",
            "MCA_mpi_yield_when_idle",
        ] {
            command.env(format!("OMPI_{name}"), "1");
        }
        command.env("OMPI_MCA_hwloc_base_binding_policy", "none");
        // Open MPI 5 has other names for this.
        command.env("PRTE_MCA_rmaps_default_mapping_policy", ":oversubscribe");
        command.env("PRTE_MCA_hwloc_default_binding_policy", "none");
        // Variables that cargo sets for the tests would affect the launcher.
        command.env_remove("LD_LIBRARY_PATH").stdin(Stdio::null());
        command.args(["-n", &count.to_string(), program]);
        command.args(arguments.iter().map(|argument| if *argument == "OUT" { out.as_str() } else { argument }));
        command
            .stdout(File::create(folder.join("stdout")).unwrap())
            .stderr(File::create(folder.join("stderr")).unwrap());
        Job { launcher: command.spawn().unwrap(), folder, start: Instant::now(), _alone: alone }
    }

    pub fn output(&self) -> String {
        fs::read_to_string(self.folder.join("stdout")).unwrap()
    }

    /// Waits until `there` returns a value.
    pub fn when<T>(&mut self, there: impl Fn(&Self) -> Option<T>) -> T {
        loop {
            if let Some(there) = there(self) {
                return there;
            }
            assert!(self.launcher.try_wait().unwrap().is_none(), "ended too early: {}", self.output());
            assert!(self.start.elapsed() < PATIENCE, "{}", self.output());
            sleep(Duration::from_millis(5));
        }
    }

    /// Waits until this number of increments is reported.
    pub fn reaches(&mut self, increments: usize) {
        let mark = format!("\n{increments:5}  ");
        self.when(|job| job.output().contains(&mark).then_some(()));
    }

    /// Returns the process numbers of the ranks, wherever the launcher has started them. The arguments must name `OUT`.
    pub fn ranks(&mut self, count: usize) -> Vec<u32> {
        let ranks = |job: &Self| {
            let out = job.folder.join("out");
            let is_ours =
                |pid: &u32| fs::read(format!("/proc/{pid}/cmdline")).is_ok_and(|line| has_argument(&line, &out));
            let all = fs::read_dir("/proc").ok()?.filter_map(|entry| entry.ok()?.file_name().to_str()?.parse().ok());
            let mut ranks: Vec<u32> = all.filter(is_ours).collect();
            ranks.retain(|pid| environment(*pid, "OMPI_COMM_WORLD_RANK").is_some());
            ranks.sort_by_key(|pid| environment(*pid, "OMPI_COMM_WORLD_RANK"));
            (ranks.len() == count).then_some(ranks)
        };
        self.when(ranks)
    }

    /// Returns `true` if the job ends with status 0 within ten seconds. Otherwise it is ended.
    pub fn ends_well(mut self) -> bool {
        while self.start.elapsed() < Duration::from_secs(10) {
            if let Some(status) = self.launcher.try_wait().unwrap() {
                return status.success();
            }
            sleep(Duration::from_millis(10));
        }
        signal("-TERM", self.launcher.id());
        sleep(Duration::from_secs(2));
        let _ = self.launcher.kill();
        false
    }

    pub fn end(mut self) -> Ended {
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
    pub fn out(&self) -> PathBuf {
        self.folder.0.join("out")
    }

    pub fn report(&self) -> Value {
        serde_json::from_str(&fs::read_to_string(self.out().join("run.json")).unwrap()).unwrap()
    }

    /// Returns the error message without its line breaks.
    pub fn message(&self) -> String {
        self.error.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
    }
}

/// Returns a script that runs the other ranks with other `arguments` than rank 0.
pub fn other_ranks_with(folder: &Folder, arguments: &str) -> String {
    let script = folder.join("differ");
    let text =
        format!("#!/bin/sh\n[ \"$OMPI_COMM_WORLD_RANK\" = 0 ] && exec {PROGRAM} \"$@\"\nexec {PROGRAM} {arguments}\n");
    fs::write(&script, text).unwrap();
    fs::set_permissions(&script, fs::Permissions::from_mode(0o755)).unwrap();
    script
}

/// Removes the variables that MPI has set in this process if other tests have used it.
pub fn without_ours(command: &mut Command) {
    for (name, _) in std::env::vars().filter(|(name, _)| ["OMPI_", "PMIX_"].iter().any(|of| name.starts_with(of))) {
        command.env_remove(name);
    }
}

/// Returns `true` if a command line, whose arguments end with a zero each, has this one.
fn has_argument(line: &[u8], argument: &str) -> bool {
    line.split(|byte| *byte == 0).any(|one| one == argument.as_bytes())
}

/// Returns an environment variable of a process.
fn environment(pid: u32, name: &str) -> Option<String> {
    let all = fs::read(format!("/proc/{pid}/environ")).ok()?;
    let text = String::from_utf8_lossy(&all).into_owned();
    text.split('\0').find_map(|pair| Some(pair.strip_prefix(name)?.strip_prefix('=')?.to_string()))
}

/// Returns the CPU time of a process, s.
pub fn cpu(pid: u32) -> f64 {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).unwrap();
    let fields: Vec<&str> = stat.rsplit(") ").next().unwrap().split_whitespace().collect();
    fields[11..13].iter().map(|ticks| ticks.parse::<f64>().unwrap() / 100.0).sum()
}

pub fn signal(name: &str, pid: u32) {
    assert!(Command::new("sh").args(["-c", &format!("kill {name} {pid}")]).status().unwrap().success());
}
