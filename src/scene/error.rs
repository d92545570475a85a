//! Errors that point into the scene's text.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};

use super::places::Places;
use crate::base::input::FileKind;
use crate::base::input_error::InputError;

/// The error of a scene that cannot be used.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{path}: the scene cannot be read: {error}")]
    #[diagnostic(help("name an existing TOML file in UTF-8; `stickslip init block` writes an example"))]
    Io {
        /// The file.
        path: String,
        /// The error of the operating system; it is not a `source` because the message already contains it.
        error: io::Error,
    },
    /// The file is of another kind, for example a mesh.
    #[error("{path}: it is {what}, not a scene")]
    #[diagnostic(help("{help}"))]
    Other {
        /// The file.
        path: String,
        /// The kind of the file.
        what: &'static str,
        /// The advice for such a file.
        help: &'static str,
    },
    /// A value or the syntax of the scene is wrong.
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
        /// The correction that the message proposes.
        help: String,
    },
}

impl SceneError {
    /// Returns the error of the file `name` if its `bytes` are of a known kind other than a scene.
    pub(super) fn other(name: &str, bytes: &[u8]) -> Option<Self> {
        let kind = FileKind::of(bytes)?;
        Some(SceneError::Other { path: name.to_string(), what: kind.name(), help: kind.as_scene() })
    }

    /// Adds to the message that the number was converted to SI units.
    pub(super) fn in_si(mut self) -> Self {
        if let SceneError::Invalid(located) = &mut self {
            located.message.insert_str(0, "in SI units ");
        }
        self
    }
}

/// An error with its place in the scene's text.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{file}:{line}: {message}")]
#[diagnostic(help("{help}"))]
pub struct Located {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The path of the wrong key, such as `contact[0].friction`; empty if the text is not TOML or a whole table is
    /// missing.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// The correction that the message proposes.
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
    /// The key of the material of each group in a scene of several bodies; otherwise empty.
    pub(super) material_keys: Vec<String>,
}

impl Source {
    /// Returns the path of a file that the scene names, relative to the directory of the scene.
    pub(super) fn beside(&self, file: &str) -> PathBuf {
        Path::new(&self.name).parent().unwrap_or(Path::new("")).join(file)
    }

    /// Returns the keys `file` with their values, in order.
    pub(super) fn files(&self) -> Vec<(String, String)> {
        Places::of(&self.text).files(&self.text)
    }

    /// Creates a source from the text `text` called `name`.
    pub(super) fn new(name: String, text: String) -> Self {
        Source { name, text, material_keys: Vec::new() }
    }

    /// Replaces the key of a `fault` in the joined mesh and material by the key of the body concerned.
    fn of_its_body(&self, fault: InputError) -> InputError {
        if self.material_keys.is_empty() {
            return fault;
        }
        let group = fault.key.strip_prefix("material.group[").and_then(|rest| {
            let (number, rest) = rest.split_once(']')?;
            Some(format!("{}{rest}", self.material_keys.get(number.parse::<usize>().ok()?)?))
        });
        let first = || {
            let rest = fault.key.strip_prefix("material").map(|rest| format!("{}{rest}", self.material_keys[0]));
            rest.or_else(|| fault.key.strip_prefix("mesh").map(|rest| format!("body[0].mesh{rest}")))
        };
        let key = group.or_else(first).unwrap_or_else(|| fault.key.clone());
        InputError { key, ..fault }
    }

    /// Locates `fault` in the text by its key.
    pub(super) fn located(&self, fault: InputError) -> SceneError {
        let fault = self.of_its_body(fault);
        let span = Places::of(&self.text).span(&fault.key);
        self.error(fault.key, span, fault.message, fault.help)
    }

    /// Locates `fault` at the bytes `part` of the string `text`, the value of its key.
    pub(super) fn located_within(&self, fault: InputError, text: &str, part: &Range<usize>) -> SceneError {
        let span = Places::of(&self.text).span(&fault.key);
        // A string with escapes differs from its text in the file.
        let start = self.text[span.clone()].find(text).map(|quote| span.start + quote);
        let span = start.map_or(span, |start| start + part.start..start + part.end);
        self.error(fault.key, span, fault.message, fault.help)
    }

    /// Returns an error at `span` and looks up its key.
    pub(super) fn at(&self, span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> SceneError {
        self.error(Places::of(&self.text).key(&span), span, message.into(), help.into())
    }

    fn error(&self, key: String, span: Range<usize>, message: String, help: String) -> SceneError {
        let start = span.start.min(self.text.len());
        let line = self.text.as_bytes()[..start].split(|&byte| byte == b'\n').count();
        SceneError::Invalid(Box::new(Located {
            file: self.name.clone(),
            line,
            key,
            message,
            help,
            source_code: NamedSource::new(&self.name, self.text.clone()).with_language("TOML"),
            span: (start..span.end.clamp(start, self.text.len())).into(),
        }))
    }
}
