//! Runs variants as processes of this program, several at a time.
//!
//! Separate processes are used because CPU time, peak memory and BLAS settings belong to a process, and because a
//! variant that runs out of memory then ends without the others.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::thread;
use std::time::Duration;

use crate::sweep::{TableQuantity, VariantResult};

use super::super::{Invocation, interrupt};
use super::Task;

/// The pause between two checks while all processes are busy.
const PAUSE: Duration = Duration::from_millis(10);

/// Environment variables for the number of threads that a BLAS starts when it is loaded.
const BLAS_THREADS: [&str; 4] = ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"];

/// Runs the variants of a scene.
pub(super) struct Processes<'a> {
    /// The command that starts the program again.
    pub invocation: &'a Invocation,
    /// The scene file.
    pub scene: &'a Path,
    /// The folder of all results, with a folder for each fingerprint.
    pub folder: &'a Path,
    /// The threads of each process.
    pub threads: usize,
    /// The quantities to read from the reports.
    pub quantities: &'a [TableQuantity],
}

/// A finished process.
pub(super) struct Ended {
    /// The index of its task in the orders.
    pub order: usize,
    pub outcome: VariantResult,
}

/// A running process.
struct Running {
    order: usize,
    child: Child,
    /// The file for its report or its error message.
    printed: PathBuf,
}

impl Processes<'_> {
    /// Returns the folder of a complete result.
    fn whole(&self, fingerprint: &str) -> PathBuf {
        self.folder.join(fingerprint)
    }

    /// Returns the folder of a growing result of this process. Another sweep in the same folder uses its own.
    fn partial(&self, fingerprint: &str) -> PathBuf {
        self.folder.join(format!(".{fingerprint}.{}", std::process::id()))
    }

    /// Removes incomplete results of sweeps that were killed, as far as the system can identify them.
    pub(super) fn tidy(&self) {
        let processes = Path::new("/proc");
        let entries = fs::read_dir(self.folder).into_iter().flatten().filter_map(Result::ok);
        for entry in entries.filter(|_| processes.join("self").exists()) {
            let name = entry.file_name();
            let parts: Vec<&str> = name.to_str().unwrap_or_default().split('.').collect();
            let ["", fingerprint, process, ..] = parts[..] else { continue };
            let ours = fingerprint.len() == 32 && process.bytes().all(|byte| byte.is_ascii_digit());
            if ours && !processes.join(process).exists() {
                remove(&entry.path());
            }
        }
    }

    /// Returns the result of an earlier try if it is complete and of the scene of `task`; a renamed folder may hold
    /// another scene.
    pub(super) fn kept(&self, task: &Task) -> Option<VariantResult> {
        let outcome = self.read(&self.whole(&task.fingerprint).join("run.json"))?;
        (outcome.is_final() && outcome.scene_text.as_ref() == Some(&task.text)).then_some(outcome)
    }

    /// Keeps the results of a variant if they are final. Returns the outcome.
    pub(super) fn keep(&self, task: &Task, outcome: VariantResult) -> VariantResult {
        let (partial, whole) = (self.partial(&task.fingerprint), self.whole(&task.fingerprint));
        if !outcome.is_final() || !partial.join("run.json").is_file() {
            return outcome;
        }
        // A folder without a complete report is no result.
        if self.kept(task).is_none() {
            remove(&whole);
        }
        match fs::rename(&partial, &whole) {
            // Another sweep may have finished first.
            Err(error) if self.kept(task).is_none() => {
                VariantResult::failed("machine-failure", format!("the results cannot be kept: {error}"))
            }
            _ => outcome,
        }
    }

    /// Runs the variants of all `orders`, `jobs` at a time, and calls `tell` when each has ended. Ctrl-C ends all of
    /// them at once.
    pub(super) fn run(&self, orders: &[&Task], jobs: usize, tell: &mut dyn FnMut(Ended)) -> io::Result<()> {
        let mut running: Vec<Running> = Vec::new();
        let mut next = 0;
        while next < orders.len() || !running.is_empty() {
            if interrupt::requested() {
                self.stop(running, orders);
                return Ok(());
            }
            while running.len() < jobs && next < orders.len() {
                match self.start(next, orders) {
                    Ok(process) => running.push(process),
                    Err(error) => {
                        self.stop(running, orders);
                        return Err(error);
                    }
                }
                next += 1;
            }
            let mut at_work = Vec::new();
            for mut process in running {
                let words = match process.child.try_wait() {
                    Ok(None) => {
                        at_work.push(process);
                        continue;
                    }
                    // Ctrl-C in the terminal may have ended this process too.
                    Ok(Some(_)) if interrupt::requested() => {
                        at_work.push(process);
                        continue;
                    }
                    Ok(Some(status)) => format!("the process ended without a word, {status}"),
                    Err(error) => format!("the process cannot be watched: {error}"),
                };
                let outcome =
                    self.read(&process.printed).unwrap_or_else(|| VariantResult::failed("machine-failure", words));
                tell(Ended { order: process.order, outcome });
                self.clear(&process, orders);
            }
            running = at_work;
            thread::sleep(PAUSE);
        }
        Ok(())
    }

    fn start(&self, order: usize, orders: &[&Task]) -> io::Result<Running> {
        let Task { fingerprint, overrides, .. } = orders[order];
        let partial = self.partial(fingerprint);
        let printed = partial.with_extension(format!("{}.json", std::process::id()));
        let mut command = self.invocation.again();
        command.arg("run").arg(self.scene).arg("--json").arg("--out").arg(&partial);
        command.args(overrides.iter().flat_map(|change| ["--set".to_string(), change.to_string()]));
        command.envs(BLAS_THREADS.map(|name| (name, self.threads.to_string())));
        command.arg("--threads").arg(self.threads.to_string());
        let child = command.stdin(Stdio::null()).stdout(File::create(&printed)?).stderr(Stdio::null()).spawn()?;
        Ok(Running { order, child, printed })
    }

    fn stop(&self, running: Vec<Running>, orders: &[&Task]) {
        for mut process in running {
            // Fails harmlessly if the process has already ended.
            let _ = process.child.kill().and_then(|()| process.child.wait());
            self.clear(&process, orders);
        }
    }

    fn read(&self, report: &Path) -> Option<VariantResult> {
        VariantResult::read(&fs::read_to_string(report).ok()?, self.quantities)
    }

    fn clear(&self, process: &Running, orders: &[&Task]) {
        remove(&process.printed);
        remove(&self.partial(&orders[process.order].fingerprint));
    }
}

/// Removes a file or a folder if it exists. Failures are ignored.
fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}
