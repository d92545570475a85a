//! Overrides `--set key=value` of a scene. They change the text of the scene before it is read, so that messages point
//! at lines of the changed text. An added key moves the lines below it by one.

use std::fmt;
use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::SceneError;
use super::error::Source;

/// The tables that a scene may contain several times.
pub(super) const LISTS: [&str; 7] = ["body", "coupling", "support", "contact", "pretension", "spring", "load"];

/// The suffix of the name of a scene with overrides, in messages.
pub(super) const MARK: &str = " (with --set)";

/// Messages repeat so many characters of an override.
const LONGEST: usize = 200;

/// The largest number of parts of a key.
const DEEPEST: usize = 8;

/// One override, parsed from `key=value`.
///
/// The key is a path such as `mesh.elements`; in a list of tables it refers to all of them (`contact.friction`) or to
/// one, counted from 0 (`contact[1].friction`). An index at the end refers to one entry of a list (`mesh.elements[0]`,
/// `load[0].history[1][1]`). The value is TOML; bare words are strings.
#[derive(Debug, Clone)]
pub struct Override {
    text: String,
    path: Vec<Segment>,
    value: Value,
}

#[derive(Debug, Clone)]
struct Segment {
    name: String,
    /// The indices in brackets, from the outer list to the inner one.
    indices: Vec<usize>,
}

/// An override that is not of the form `key=value`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not of the form key=value, such as mesh.elements=[50,50] or contact[0].friction=0.3")]
pub struct OverrideSyntax(String);

impl FromStr for Override {
    type Err = OverrideSyntax;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let syntax = || OverrideSyntax(text.to_string());
        let (key, value) = text.split_once('=').ok_or_else(syntax)?;
        let path = key.trim().split('.').map(Segment::parse).collect::<Option<Vec<_>>>().ok_or_else(syntax)?;
        let value = value.trim();
        // TOML does not allow numbers such as .5, or integers beyond 64 bits.
        let number =
            || value.parse().ok().filter(|_| !value.contains(char::is_alphabetic) || value.contains(['e', 'E']));
        let word = || number().map_or_else(|| Value::from(value), |number: f64| Value::from(number));
        let value = value.parse().unwrap_or_else(|_| word());
        Ok(Override { text: text.to_string(), path, value })
    }
}

impl fmt::Display for Override {
    /// Writes `key=value` as it was given.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Override {
    /// Creates an override that sets the key at a path, such as `time.increments` or `body[1].mesh.elements`, to
    /// `value`.
    pub fn value(key: &str, value: impl Into<Value>) -> Self {
        let plain = |name: &str| Segment { name: name.to_string(), indices: Vec::new() };
        let path = key.split('.').map(|name| Segment::parse(name).unwrap_or_else(|| plain(name))).collect();
        let value = value.into();
        Override { text: format!("{key}={value}"), path, value }
    }

    fn error(&self, message: String, help: &str) -> SceneError {
        let text = self.text.chars().take(LONGEST).collect();
        SceneError::Override { text, message, help: help.to_string() }
    }

    /// Follows the path below `table` and sets the value.
    fn set(&self, table: &mut dyn TableLike, path: &[Segment]) -> Result<(), SceneError> {
        let Some((at, rest)) = path.split_first() else {
            return Err(self.error("this is a whole table".to_string(), "set one of its keys"));
        };
        let Segment { name, indices } = at;
        if rest.is_empty() && indices.is_empty() {
            match table.get_mut(name) {
                Some(Item::Value(old)) => self.replace(old),
                Some(list @ Item::ArrayOfTables(_)) if self.value.is_array() => *list = Item::Value(self.value.clone()),
                Some(_) => return Err(self.error(format!("`{name}` is a table"), "set one of its keys")),
                None => drop(table.insert(name, Item::Value(self.value.clone()))),
            }
            return Ok(());
        }
        if rest.is_empty() && !LISTS.contains(&name.as_str()) {
            return match table.get_mut(name) {
                Some(Item::Value(list)) => self.set_entry(name, list, indices),
                Some(_) => Err(self.error(format!("`{name}` is not a list"), "leave the [index] out")),
                None => {
                    let help = format!("set the whole list, {name}=[...]");
                    Err(self.error(format!("the scene has no list `{name}` there"), &help))
                }
            };
        }
        if table.get(name).is_none() {
            if LISTS.contains(&name.as_str()) {
                return Err(self.error(format!("the scene has no [[{name}]]"), "add one to the scene file"));
            }
            if ["mesh", "material"].contains(&name.as_str()) && table.contains_key("body") {
                let help = format!("set body.{name}, that of all bodies, or body[0].{name}, that of the first");
                return Err(self.error(format!("the scene has no [{name}], but [[body]]"), &help));
            }
            table.insert(name, Item::Table(Table::new()));
        }
        match table.get_mut(name) {
            Some(Item::ArrayOfTables(list)) => {
                self.set_in_list(at, list.iter_mut().map(|table| table as &mut dyn TableLike).collect(), rest)
            }
            Some(Item::Value(Value::Array(list))) if list.iter().any(Value::is_inline_table) => {
                let tables = list.iter_mut().filter_map(Value::as_inline_table_mut);
                self.set_in_list(at, tables.map(|table| table as &mut dyn TableLike).collect(), rest)
            }
            Some(_) if !indices.is_empty() => {
                Err(self.error(format!("`{name}` is not a list of tables"), "leave the [index] out"))
            }
            child => match child.and_then(Item::as_table_like_mut) {
                Some(table) => self.set(table, rest),
                None => Err(self.error(format!("`{name}` is not a table"), "look the key up in the scene file")),
            },
        }
    }

    /// Replaces a value. Keeps the spaces and the comment around it.
    fn replace(&self, old: &mut Value) {
        let decor = old.decor().clone();
        *old = self.value.clone();
        *old.decor_mut() = decor;
    }

    /// Sets the entry at `indices` of the list `name`. The entry must exist.
    fn set_entry(&self, name: &str, value: &mut Value, indices: &[usize]) -> Result<(), SceneError> {
        let Some((&index, rest)) = indices.split_first() else {
            self.replace(value);
            return Ok(());
        };
        let Some(list) = value.as_array_mut() else {
            return Err(self.error(format!("`{name}` is not a list"), "leave the [index] out"));
        };
        let count = list.len();
        let entry = format!("{name}[{index}]");
        match list.get_mut(index) {
            Some(table) if table.is_inline_table() => {
                Err(self.error("this is a whole table".to_string(), "set one of its keys"))
            }
            Some(value) => self.set_entry(&entry, value, rest),
            None => {
                let entries = if count == 1 { "entry" } else { "entries" };
                let message = format!("`{name}` has {count} {entries}, so there is no {entry}");
                Err(self.error(message, "count from 0"))
            }
        }
    }

    /// Sets the value in all `tables` of the list `at`, or in the one at its index.
    fn set_in_list(&self, at: &Segment, tables: Vec<&mut dyn TableLike>, rest: &[Segment]) -> Result<(), SceneError> {
        let (name, count) = (&at.name, tables.len());
        match at.indices[..] {
            [] => tables.into_iter().try_for_each(|table| self.set(table, rest)),
            [k] if k < count => tables.into_iter().skip(k).take(1).try_for_each(|table| self.set(table, rest)),
            [k, _, ..] => Err(self.error(format!("{name}[{k}] is a table"), "leave the second [index] out")),
            [k] => {
                let message = format!("the scene has {count} [[{name}]], so there is no {name}[{k}]");
                Err(self.error(message, "count from 0"))
            }
        }
    }
}

impl Segment {
    /// Parses `name`, `name[index]` or `name[index][index]`.
    fn parse(text: &str) -> Option<Self> {
        let (name, indices) = text.split_at(text.find('[').unwrap_or(text.len()));
        let index = |piece: &str| piece.strip_prefix('[')?.strip_suffix(']')?.parse().ok();
        let indices = indices.split_inclusive(']').map(index).collect::<Option<Vec<usize>>>()?;
        let is_valid = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
        is_valid.then(|| Segment { name: name.to_string(), indices })
    }
}

/// Returns the scene's text with all overrides applied.
pub(super) fn apply(name: &str, text: &str, overrides: &[Override]) -> Result<Source, SceneError> {
    let source = Source::new(name.to_string(), text.to_string());
    if overrides.is_empty() {
        return Ok(source);
    }
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        source.at(error.span().unwrap_or(0..0), error.message().trim().replace('\n', ", "), "mend the TOML here")
    })?;
    for change in overrides {
        if change.path.len() > DEEPEST {
            let message =
                format!("the key has {} parts, but no key of a scene has more than {DEEPEST}", change.path.len());
            return Err(change.error(message, "look the key up in the scene file"));
        }
        change.set(document.as_table_mut(), &change.path)?;
    }
    Ok(Source::new(format!("{name}{MARK}"), document.to_string()))
}
