//! Errors that point into the scene's text.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};

/// Why a scene was refused.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{path}: the scene cannot be read: {error}")]
    #[diagnostic(help("name an existing TOML file in UTF-8; data/scenes/block.toml is an example"))]
    Io {
        /// The file.
        path: String,
        /// What the system said; not a `source`, since the message has it already.
        error: io::Error,
    },
    /// Something in it is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Invalid(Box<Located>),
    /// A `--set` does not fit the scene.
    #[error("--set {text}: {message}")]
    #[diagnostic(help("{help}"))]
    Override {
        /// The override as given.
        text: String,
        /// What is wrong.
        message: String,
        /// How to mend it.
        help: String,
    },
}

/// An error with its place.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{file}:{line}: {message}")]
#[diagnostic(help("{help}"))]
pub struct Located {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
    /// How to mend it.
    pub help: String,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("here")]
    span: SourceSpan,
}

/// The text of a scene and its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Source {
    pub(super) name: String,
    pub(super) text: String,
}

impl Source {
    /// The path of a file that the scene names: relative to the scene's own.
    pub(super) fn beside(&self, file: &str) -> PathBuf {
        Path::new(&self.name).parent().unwrap_or(Path::new("")).join(file)
    }

    /// An error at `span`.
    pub(super) fn error(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        let start = span.start.min(self.text.len());
        let line = self.text.as_bytes()[..start].split(|&byte| byte == b'\n').count();
        SceneError::Invalid(Box::new(Located {
            file: self.name.clone(),
            line,
            message: message.into(),
            help: help.into(),
            source_code: NamedSource::new(&self.name, self.text.clone()).with_language("TOML"),
            span: (start..span.end.clamp(start, self.text.len())).into(),
        }))
    }
}
