//! What the program writes on standard output and standard error. Neither is a reason to stop a run: results may go to
//! a folder all the same.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use miette::Diagnostic;
use serde::Serialize;
use stickslip::scene::SceneError;

use super::Failure;

/// Whether something that belongs on standard output could not be written there.
static FAILED: AtomicBool = AtomicBool::new(false);

/// Prints a line on standard output. A reader who has gone, as in `stickslip ... | head`, has seen enough; after any
/// other failure nothing more is printed, and the program will end with status 3.
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

/// The text without what would steer a terminal: names and titles come from files.
fn plain(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().map(|c| if steers(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// Prints a line on standard error. There is nobody to tell if that fails.
pub(super) fn note(line: &str) {
    // In one piece, as other processes may write there, too.
    let _ = stderr().write_all(format!("{line}\n").as_bytes());
}

/// Whether standard output has refused a line.
pub(super) fn failed() -> bool {
    FAILED.load(Ordering::Relaxed)
}

/// Why there is no result, where the result is to be one JSON object.
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
        // The types leave nothing that JSON does not know.
        if let Ok(json) = serde_json::to_string_pretty(self) {
            line(format_args!("{json}"));
        }
    }
}

/// Tells why a command ended without a result, on standard error and, with `json`, on standard output; gives the exit
/// status.
pub(super) fn failure(failure: &Failure, json: bool) -> ExitCode {
    let (report, status, code) = match failure {
        Failure::Input(report) => (report, "bad-input", 2),
        Failure::Machine(report) => (report, "machine-failure", 3),
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
    ExitCode::from(code)
}

/// The scene file that could not be read.
fn unread(report: &miette::Report) -> Option<String> {
    match report.downcast_ref::<SceneError>()? {
        SceneError::Io { path, .. } => Some(path.clone()),
        _ => None,
    }
}

/// The same on standard output alone, for what has no place in a file.
pub(super) fn failure_as_json(status: &str, message: &str) {
    let schema_version = stickslip::run::report::SCHEMA_VERSION;
    JsonFailure { schema_version, status, message: message.trim_end(), file: None, line: None, help: None }.print();
}

/// The file and the line (from 1) that an error points at.
fn place(error: &dyn Diagnostic) -> Option<(Option<String>, usize)> {
    let label = error.labels()?.next()?;
    let text = error.source_code()?.read_span(label.inner(), 0, 0).ok()?;
    Some((text.name().map(str::to_string), text.line() + 1))
}
