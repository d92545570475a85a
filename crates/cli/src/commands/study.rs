//! The folder, the progress and the output of the commands with many runs.

use std::io;
use std::path::Path;

use super::progress::bar;
use super::run::write_failure;
use super::{Failure, SceneArgs};
use crate::study::StudyError;
use indicatif::ProgressBar;
use serde::Serialize;
use serde_json::Value;
use stickslip_output::{FolderLock, PlotError, write_file};

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Run(error) => error.into(),
            of_the_plan => Failure::Input(of_the_plan.into()),
        }
    }
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        Failure::Machine(miette::miette!("{error}"))
    }
}

/// The folder of the files of a study, locked against other commands as long as this value exists.
pub(super) struct StudyFolder<'a> {
    pub path: &'a Path,
    _lock: FolderLock,
}

impl<'a> StudyFolder<'a> {
    /// Takes the folder `out`, if any, for `files`. The first one is a table, whose first line contains `columns`.
    pub(super) fn open(out: Option<&'a Path>, files: &[&str], columns: &str) -> Result<Option<Self>, Failure> {
        let open = |path: &'a Path| {
            let lock = FolderLock::new(path, files, columns).map_err(|error| write_failure(path, &error))?;
            match files.iter().map(|name| path.join(name)).find(|file| file.is_dir()) {
                Some(file) => Err(write_failure(&file, &io::ErrorKind::IsADirectory.into())),
                None => Ok(StudyFolder { path, _lock: lock }),
            }
        };
        out.map(open).transpose()
    }
}

/// Prints the results of a study, as `data` alone or else as text, and writes its files, names and contents, if it has a
/// folder.
pub(super) fn print_results<N: AsRef<str>, F: IntoIterator<Item = (N, String)>>(
    folder: Option<&StudyFolder<'_>>,
    data: Option<&str>,
    text: &str,
    files: impl FnOnce() -> Result<F, Failure>,
) -> Result<(), Failure> {
    say!("{}", data.unwrap_or(text).trim_end());
    let Some(StudyFolder { path, .. }) = folder else { return Ok(()) };
    let written = files()?.into_iter().try_for_each(|(name, content)| write_file(path, name.as_ref(), content));
    written.map_err(|error| write_failure(path, &error))?;
    if data.is_none() {
        say!("results      {}", path.display());
    }
    Ok(())
}

/// Adds the command line of a study and its changes of the scene to its results.
pub(super) fn changed(mut results: Value, scene: &SceneArgs, command: &str) -> Value {
    results["command"] = command.into();
    results["overrides"] = scene.overrides().iter().map(ToString::to_string).collect();
    results
}

/// Formats results as one JSON object.
pub(super) fn pretty(results: &impl Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(results).map_err(|error| Failure::Machine(miette::miette!("{error}")))
}

/// Returns a bar of `length` runs, and what counts a run and shows its name when it begins.
pub(super) fn counted(length: usize, unit: &str) -> (ProgressBar, impl FnMut(String) + Send) {
    let bar = bar(length, unit);
    let (shown, mut begun) = (bar.clone(), 0);
    let advance = move |what: String| {
        shown.set_position(begun);
        shown.set_message(what);
        begun += 1;
    };
    (bar, advance)
}
