//! Why the page of a run cannot be made.

use std::io;
use std::path::PathBuf;

/// The reason why the page of a run cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum PageError {
    /// The folder does not exist, or cannot be opened.
    #[error("the folder {} cannot be opened: {error}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The reason.
        error: io::Error,
    },
    /// The folder contains no results.
    #[error("{} contains no results of a run: both run.json and increments.csv are missing", path.display())]
    NoResults {
        /// The folder.
        path: PathBuf,
    },
    /// The report cannot be read.
    #[error("run.json is no report of a run: {0}")]
    Report(serde_json::Error),
    /// A result file cannot be read.
    #[error("{name} cannot be read: {error}")]
    Unreadable {
        /// The file.
        name: String,
        /// The reason.
        error: io::Error,
    },
    /// A result file is no text.
    #[error("{name}, line {line}: byte {byte} of the file is not UTF-8 text")]
    NoText {
        /// The file.
        name: String,
        /// The line, from 1.
        line: usize,
        /// The byte, from 1.
        byte: usize,
    },
    /// The page cannot be written, or the folder not be listed.
    #[error(transparent)]
    Disk(#[from] io::Error),
}

impl PageError {
    /// Returns the cure.
    pub fn help(&self) -> &'static str {
        match self {
            PageError::Folder { .. } => "name the folder that `stickslip run SCENE --out DIR` has filled",
            PageError::NoResults { .. } => "name the folder of `--out`; a run has results from its first increment on",
            PageError::Report(_) => "remove run.json: the page is then made from the tables; or repeat the run",
            PageError::Unreadable { .. } => "make it a file that can be read, or repeat the run",
            PageError::NoText { .. } => {
                "save the file as UTF-8, or remove it: the page is then made without it; or repeat the run"
            }
            PageError::Disk(_) => "check that the folder can be read and written, and that the disk is not full",
        }
    }
}
