//! Errors that point into the scene's text, and the place of each key in it.

use std::collections::BTreeSet;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};
use toml_edit::{Document, Item, TableLike, Value};

use crate::base::formula::Formula;
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

    /// Locates `fault` in the text by its key, and that of a formula at the wrong part of it.
    pub(super) fn located(&self, fault: InputError) -> SceneError {
        let fault = self.of_its_body(fault);
        let mut span = Places::of(&self.text).span(&fault.key);
        if let Ok(Value::String(formula)) = self.text[span.clone()].parse()
            && let Err(why) = Formula::parse(formula.value())
            && fault.message.ends_with(&why.to_string())
            // A string with escapes differs from its text in the file.
            && let Some(start) = self.text[span.clone()].find(formula.value())
        {
            span = span.start + start + why.span.start..span.start + start + why.span.end;
        }
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

/// The places of the keys of a text, such as `contact[0].friction`. For each key: the place of its value, then the
/// places of the keys below it, then the place of its name. The only element of a list is also listed under the list's
/// key.
pub(super) struct Places(Vec<(String, Range<usize>)>);

/// The place of an entry of a list, and the entry itself if it is a table.
type Entry<'a> = (Option<Range<usize>>, Option<&'a dyn TableLike>);

impl Places {
    /// Finds the keys of `text`; none if `text` is not TOML.
    pub(super) fn of(text: &str) -> Self {
        let mut places = Places(Vec::new());
        if let Ok(document) = Document::parse(text) {
            places.take_table(document.as_table(), "");
        }
        places
    }

    /// Returns the bytes of the value at `key`, or of the nearest enclosing table that has a place.
    pub(super) fn span(&self, key: &str) -> Range<usize> {
        let mut key = key;
        loop {
            if let Some((_, span)) = self.0.iter().find(|(known, _)| known == key) {
                return span.clone();
            }
            match key.rfind(['.', '[']) {
                Some(end) => key = &key[..end],
                None => return 0..0,
            }
        }
    }

    /// Returns the key of the smallest value that contains `span`; empty if none does.
    pub(super) fn key(&self, span: &Range<usize>) -> String {
        let holds = |place: &Range<usize>| place.start <= span.start && span.end <= place.end;
        let holding = self.0.iter().filter(|(_, place)| holds(place));
        // If two places have the same length, the longer key is nested more deeply.
        let smallest = holding.min_by_key(|(key, place)| (place.len(), std::cmp::Reverse(key.len())));
        smallest.map_or(String::new(), |(key, _)| key.clone())
    }

    /// Returns the keys `file` of `text`, whose places these are, with their values, in order.
    pub(super) fn files(&self, text: &str) -> Vec<(String, String)> {
        let mut files: Vec<(&String, &Range<usize>, String)> = Vec::new();
        let mut keys = BTreeSet::new();
        for (key, span) in self.0.iter().filter(|(key, _)| key.rsplit('.').next() == Some("file")) {
            // The place of the name comes after that of the value, and both places in the only table of a list twice.
            let is_new = keys.insert(key) && files.iter().all(|(_, place, _)| *place != span);
            if let Some(Ok(Value::String(file))) = is_new.then(|| text[span.clone()].parse()) {
                files.push((key, span, file.into_value()));
            }
        }
        files.into_iter().map(|(key, _, file)| (key.clone(), file)).collect()
    }

    fn take_table(&mut self, table: &dyn TableLike, above: &str) {
        for (name, item) in table.iter() {
            let key = if above.is_empty() { name.to_string() } else { format!("{above}.{name}") };
            let name = table.key(name).and_then(|name| Some((key.clone(), name.span()?)));
            self.take(item, &key);
            self.0.extend(name);
        }
    }

    fn take(&mut self, item: &Item, key: &str) {
        self.0.extend(item.span().map(|span| (key.to_string(), span)));
        let entries: Vec<Entry<'_>> = match item {
            Item::ArrayOfTables(tables) => tables.iter().map(|table| (table.span(), Some(table as _))).collect(),
            Item::Value(Value::Array(values)) => {
                values.iter().map(|value| (value.span(), value.as_inline_table().map(|table| table as _))).collect()
            }
            _ => return item.as_table_like().into_iter().for_each(|table| self.take_table(table, key)),
        };
        for (k, (span, table)) in entries.iter().enumerate() {
            let key = format!("{key}[{k}]");
            self.0.extend(span.clone().map(|span| (key.clone(), span)));
            if let Some(table) = table {
                self.take_table(*table, &key);
            }
        }
        if let [(_, Some(only))] = entries[..] {
            self.take_table(only, key);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Places;

    const TEXT: &str = r#"
title = "x"
[mesh]
size = [1, [2, 3]]
[[contact]]
friction = 0.1
obstacle = { kind = "plane", motion.rotation.axis = [0, 1] }
[[contact]]
friction = 0.2
[contact.obstacle]
gap = 3
[[load]]
history = [[0, 1], [1, 2]]
"#;

    #[test]
    fn files_wherever_they_stand() {
        let text = "mesh.file = 'a.msh'\ntitle = 'file'\n[[contact]]\nobstacle = { kind = 'table', file = \"b.csv\" }\n\
                    [[contact]]\n[contact.obstacle]\nfile = 'c.csv'\n";
        let found =
            [("mesh.file", "a.msh"), ("contact[0].obstacle.file", "b.csv"), ("contact[1].obstacle.file", "c.csv")];
        assert_eq!(Places::of(text).files(text), found.map(|(key, file)| (key.to_string(), file.to_string())));
        let only = "[[body]]\nmesh = { \"file\" = 'a.msh' }";
        assert_eq!(Places::of(only).files(only), [("body[0].mesh.file".to_string(), "a.msh".to_string())]);
        assert!(Places::of("file = ").files("file = ").is_empty());
    }

    #[test]
    fn keys_and_places_belong_to_each_other() {
        let places = Places::of(TEXT);
        for (key, value) in [
            ("title", "\"x\""),
            ("mesh", "[mesh]"),
            ("mesh.size", "[1, [2, 3]]"),
            ("contact[0]", "[[contact]]"),
            ("contact[0].friction", "0.1"),
            ("contact[1].friction", "0.2"),
            ("contact[0].obstacle.kind", "\"plane\""),
            ("contact[0].obstacle.motion.rotation.axis", "[0, 1]"),
            ("contact[1].obstacle", "[contact.obstacle]"),
            ("contact[1].obstacle.gap", "3"),
            ("load[0].history[1]", "[1, 2]"),
        ] {
            let span = places.span(key);
            assert_eq!(&TEXT[span.clone()], value, "{key}");
            assert_eq!(places.key(&span), key);
        }
        // A missing key has the place of its enclosing table.
        assert_eq!(&TEXT[places.span("mesh.elements")], "[mesh]");
        assert_eq!(&TEXT[places.span("contact[1].obstacle.axis")], "[contact.obstacle]");
        assert_eq!(&TEXT[places.span("load.history")], "[[0, 1], [1, 2]]");
        assert_eq!((places.span("solver.method"), places.key(&(0..0)).as_str()), (0..0, ""));
        let two = TEXT.find("2, 3").unwrap();
        assert_eq!(places.key(&(two..two + 1)), "mesh.size[1]");
        let name = TEXT.rfind("friction").unwrap();
        assert_eq!(places.key(&(name..name + 8)), "contact[1].friction");
        assert_eq!(Places::of("[mesh").key(&(0..1)), "");
    }
}
