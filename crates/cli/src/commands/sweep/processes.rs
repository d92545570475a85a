//! Runs variants as processes of this program, several at a time.
//!
//! Separate processes are used because CPU time, peak memory and BLAS settings belong to a process, and because a
//! variant that runs out of memory then ends without the others.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::study::TableQuantity;
use crate::sweep::VariantResult;

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
    pub(super) fn stored(&self, task: &Task) -> Option<VariantResult> {
        let outcome = self.read(&self.whole(&task.fingerprint).join("run.json"))?;
        (outcome.is_final() && outcome.scene_text.as_ref() == Some(&task.text)).then_some(outcome)
    }

    /// Keeps the results of a variant if they are final. Returns the outcome.
    fn keep(&self, task: &Task, outcome: VariantResult) -> VariantResult {
        let (partial, whole) = (self.partial(&task.fingerprint), self.whole(&task.fingerprint));
        if !outcome.is_final() || !partial.join("run.json").is_file() {
            return outcome;
        }
        // A folder without a complete report is no result.
        if self.stored(task).is_none() {
            remove(&whole);
        }
        match fs::rename(&partial, &whole) {
            // Another sweep may have finished first.
            Err(error) if self.stored(task).is_none() => {
                VariantResult::failed("machine-failure", &format!("the results cannot be kept: {error}"))
            }
            _ => outcome,
        }
    }

    /// Runs a variant in a process of its own, and keeps its results if they are final and the scene is then the `same`
    /// as that of the task. Returns `None` if the user stops the sweep.
    pub(super) fn run(&self, task: &Task, same: impl FnOnce() -> bool) -> io::Result<Option<VariantResult>> {
        if interrupt::requested() {
            return Ok(None);
        }
        let partial = self.partial(&task.fingerprint);
        let printed = partial.with_extension(format!("{}.json", std::process::id()));
        let mut child = self.command(task, &partial).stdout(File::create(&printed)?).spawn()?;
        let words = loop {
            // Ctrl-C in the terminal may have ended this process too.
            if interrupt::requested() {
                // Fails harmlessly if the process has already ended.
                let _ = child.kill().and_then(|()| child.wait());
                break None;
            }
            match child.try_wait() {
                Ok(None) => thread::sleep(PAUSE),
                _ if interrupt::requested() => {}
                Ok(Some(status)) => break Some(format!("the process ended without a word, {status}")),
                Err(error) => break Some(format!("the process cannot be watched: {error}")),
            }
        };
        let outcome = words.map(|words| match self.read(&printed) {
            _ if !same() => VariantResult::failed("bad-input", "the scene, or a file of it, changed during the run"),
            Some(outcome) => self.keep(task, outcome),
            None => VariantResult::failed("machine-failure", &words),
        });
        remove(&printed);
        remove(&partial);
        Ok(outcome)
    }

    /// Returns the command that runs the scene of a task.
    fn command(&self, task: &Task, out: &Path) -> Command {
        let mut command = self.invocation.again();
        command.arg("run").arg(self.scene).arg("--json").arg("--out").arg(out);
        command.args(task.overrides.iter().flat_map(|change| ["--set".to_string(), change.to_string()]));
        command.envs(BLAS_THREADS.map(|name| (name, self.threads.to_string())));
        command.arg("--threads").arg(self.threads.to_string());
        command.stdin(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn read(&self, report: &Path) -> Option<VariantResult> {
        VariantResult::read(&fs::read_to_string(report).ok()?, self.quantities)
    }
}

/// Removes a file or a folder if it exists. Failures are ignored.
fn remove(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}
