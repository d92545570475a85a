//! Errors that point into the scene's text.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};

use super::places::Places;
use crate::base::input::FileKind;
use crate::base::input_error::InputError;

/// Why a scene was refused.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{path}: the scene cannot be read: {error}")]
    #[diagnostic(help("name an existing TOML file in UTF-8; `stickslip init block` writes an example"))]
    Io {
        /// The file.
        path: String,
        /// What the system said; not a `source`, since the message has it already.
        error: io::Error,
    },
    /// The file is of another kind.
    #[error("{path}: it is {what}, not a scene")]
    #[diagnostic(help("{help}"))]
    Other {
        /// The file.
        path: String,
        /// What it is.
        what: &'static str,
        /// What to do with it.
        help: &'static str,
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
        /// What mends the fault.
        help: String,
    },
}

impl SceneError {
    /// The error of a file called `name` with these `bytes`, if it is of a known kind that is none of scenes.
    pub(super) fn other(name: &str, bytes: &[u8]) -> Option<Self> {
        let kind = FileKind::of(bytes)?;
        Some(SceneError::Other { path: name.to_string(), what: kind.name(), help: kind.as_scene() })
    }
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
    /// The path of what is wrong, such as `contact[0].friction`; empty where the text is no TOML or a whole table is
    /// missing.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What mends the fault.
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
    /// Where the material of each group stands, in a scene of several bodies; otherwise empty.
    pub(super) material_keys: Vec<String>,
}

impl Source {
    /// The path of a file that the scene names: relative to the scene's own.
    pub(super) fn beside(&self, file: &str) -> PathBuf {
        Path::new(&self.name).parent().unwrap_or(Path::new("")).join(file)
    }

    /// The text `text` called `name`.
    pub(super) fn new(name: String, text: String) -> Self {
        Source { name, text, material_keys: Vec::new() }
    }

    /// `fault` of the joined mesh and material of several bodies, told of the body that it is of.
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

    /// `fault` at its place.
    pub(super) fn located(&self, fault: InputError) -> SceneError {
        let fault = self.of_its_body(fault);
        let span = Places::of(&self.text).span(&fault.key);
        self.error(fault.key, span, fault.message, fault.help)
    }

    /// `fault` at the bytes `part` of the string `text`, which is the value of its key.
    pub(super) fn located_within(&self, fault: InputError, text: &str, part: &Range<usize>) -> SceneError {
        let span = Places::of(&self.text).span(&fault.key);
        // A text with escapes does not stand in the file as it is read.
        let start = self.text[span.clone()].find(text).map(|quote| span.start + quote);
        let span = start.map_or(span, |start| start + part.start..start + part.end);
        self.error(fault.key, span, fault.message, fault.help)
    }

    /// An error at `span`, whose key is looked up.
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
