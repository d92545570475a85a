//! Writes to standard output and standard error. A failure of either does not stop a run, whose results may also go to
//! a folder.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::sync::atomic::{AtomicBool, Ordering};

use miette::Diagnostic;
use serde::Serialize;
use stickslip::scene::SceneError;
use stickslip_output::{LABEL, paragraph};

use super::{ExitStatus, Failure};

/// Set if a line could not be written on standard output.
static FAILED: AtomicBool = AtomicBool::new(false);

/// Prints a line on standard output. A reader that closes the pipe early, as in `stickslip ... | head`, is no failure.
/// After any other failure nothing more is printed, and the program ends with status 3.
pub(super) fn line(line: Arguments<'_>) {
    if failed() {
        return;
    }
    match writeln!(stdout(), "{}", plain(&line.to_string())) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            FAILED.store(true, Ordering::Relaxed);
            note(&format!("standard output cannot be written: {error}"));
        }
        _ => {}
    }
}

/// Prints a line that begins with a label, broken to fit a screen.
pub(super) fn labelled(text: &str) {
    match text.split_at_checked(LABEL) {
        Some((label, rest)) => line(format_args!("{}", paragraph(label, rest).trim_end())),
        None => line(format_args!("{text}")),
    }
}

/// Removes control characters, which steer a terminal: names and titles come from files.
fn plain(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().map(|c| if steers(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// Prints a line on standard error. A failure to do so is ignored.
pub(super) fn note(line: &str) {
    // One write per line, because other processes may write there too.
    let _ = stderr().write_all(format!("{line}\n").as_bytes());
}

/// Returns `true` if a line could not be written on standard output.
pub(super) fn failed() -> bool {
    FAILED.load(Ordering::Relaxed)
}

/// The reason why there is no result, printed in place of a JSON result.
#[derive(Serialize)]
struct JsonFailure<'a> {
    schema_version: u32,
    status: &'a str,
    message: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    help: Option<String>,
}

impl JsonFailure<'_> {
    fn print(&self) {
        // All fields can be represented in JSON.
        if let Ok(json) = serde_json::to_string_pretty(self) {
            line(format_args!("{json}"));
        }
    }
}

/// Reports why a command ended without a result, on standard error and, with `json`, on standard output. Returns the
/// exit status.
pub(super) fn failure(failure: &Failure, json: bool) -> ExitStatus {
    let (report, status, code) = match failure {
        Failure::Input(report) => (report, "bad-input", ExitStatus::BadInput),
        Failure::Machine(report) => (report, "machine-failure", ExitStatus::MachineFailure),
    };
    note(&format!("{report:?}"));
    if json {
        let place = place(report.as_ref());
        let message = report.to_string();
        JsonFailure {
            schema_version: stickslip::run::report::SCHEMA_VERSION,
            status,
            message: &message,
            file: place.as_ref().and_then(|(file, _)| file.clone()).or_else(|| unread(report)),
            line: place.map(|(_, line)| line),
            help: report.help().map(|help| help.to_string()),
        }
        .print();
    }
    code
}

/// Returns the path of the scene file if it could not be read.
fn unread(report: &miette::Report) -> Option<String> {
    match report.downcast_ref::<SceneError>()? {
        SceneError::Io { path, .. } => Some(path.clone()),
        _ => None,
    }
}

/// Prints a failure that has no position in a file, on standard output only.
pub(super) fn failure_as_json(status: &str, message: &str) {
    let schema_version = stickslip::run::report::SCHEMA_VERSION;
    JsonFailure { schema_version, status, message: message.trim_end(), file: None, line: None, help: None }.print();
}

/// Returns the file and the line (from 1) of an error.
fn place(error: &dyn Diagnostic) -> Option<(Option<String>, usize)> {
    let label = error.labels()?.next()?;
    let text = error.source_code()?.read_span(label.inner(), 0, 0).ok()?;
    Some((text.name().map(str::to_string), text.line() + 1))
}
