//! `--set key=value`: changes of a scene before it is read, made in its text so that every message
//! still points at the right line.

use std::str::FromStr;

use toml_edit::{DocumentMut, Item, Table, Value};

use super::SceneError;
use super::error::Source;

/// The tables that a scene may hold several of.
const LISTS: [&str; 3] = ["support", "contact", "load"];

/// One override, parsed from `key=value`.
///
/// The key is a path such as `mesh.elements`; in a list of tables it means all of them
/// (`contact.friction`) or one, counted from 0 (`contact[1].friction`). The value is TOML; bare
/// words are strings.
#[derive(Debug, Clone)]
pub struct Override {
    text: String,
    path: Vec<Segment>,
    value: Value,
}

#[derive(Debug, Clone)]
struct Segment {
    name: String,
    index: Option<usize>,
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
        let value = value.parse().unwrap_or_else(|_| Value::from(value));
        Ok(Override { text: text.to_string(), path, value })
    }
}

impl Override {
    /// Sets the key at a plain path, such as `time.increments`, to `value`.
    pub fn value(key: &str, value: impl Into<Value>) -> Self {
        let path = key.split('.').map(|name| Segment { name: name.to_string(), index: None }).collect();
        let value = value.into();
        Override { text: format!("{key}={value}"), path, value }
    }

    fn error(&self, message: String, help: &str) -> SceneError {
        SceneError::Override { text: self.text.clone(), message, help: help.to_string() }
    }

    /// Follows the path below `item` and sets the value.
    fn set(&self, item: &mut Item, path: &[Segment]) -> Result<(), SceneError> {
        let Some((Segment { name, index }, rest)) = path.split_first() else { return Ok(()) };
        let Some(table) = item.as_table_like_mut() else {
            return self.error_at_value(name);
        };
        if rest.is_empty() && index.is_none() {
            match table.get_mut(name) {
                Some(Item::Value(old)) => {
                    // Keeps the spaces and the comment around the old value.
                    let decor = old.decor().clone();
                    *old = self.value.clone();
                    *old.decor_mut() = decor;
                }
                Some(_) => return Err(self.error(format!("`{name}` is a table"), "set one of its keys")),
                None => drop(table.insert(name, Item::Value(self.value.clone()))),
            }
            return Ok(());
        }
        if table.get(name).is_none() {
            if LISTS.contains(&name.as_str()) {
                return Err(self.error(format!("the scene has no [[{name}]]"), "add one to the scene file"));
            }
            table.insert(name, Item::Table(Table::new()));
        }
        let Some(child) = table.get_mut(name) else { return self.error_at_value(name) };
        match (child, index) {
            (Item::ArrayOfTables(list), index) => {
                let count = list.len();
                if let Some(k) = index.filter(|&k| k >= count) {
                    let message = format!("the scene has {count} [[{name}]], so there is no {name}[{k}]");
                    return Err(self.error(message, "count from 0"));
                }
                for (_, table) in list.iter_mut().enumerate().filter(|(k, _)| index.is_none_or(|index| index == *k)) {
                    let mut item = Item::Table(std::mem::take(table));
                    let result = self.set(&mut item, rest);
                    if let Item::Table(changed) = item {
                        *table = changed;
                    }
                    result?;
                }
                Ok(())
            }
            (child, None) => self.set(child, rest),
            (_, Some(_)) => Err(self.error(format!("`{name}` is not a list of tables"), "leave the [index] out")),
        }
    }

    fn error_at_value(&self, name: &str) -> Result<(), SceneError> {
        Err(self.error(format!("there is no table that could hold `{name}`"), "look the key up in the scene file"))
    }
}

impl Segment {
    /// `name` or `name[index]`.
    fn parse(text: &str) -> Option<Self> {
        let (name, index) = match text.strip_suffix(']').map(|text| text.split_once('[')) {
            None => (text, None),
            Some(parts) => {
                let (name, index) = parts?;
                (name, Some(index.parse().ok()?))
            }
        };
        let sound = !name.is_empty() && name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
        sound.then(|| Segment { name: name.to_string(), index })
    }
}

/// The scene's text with all overrides in place.
pub(super) fn apply(name: &str, text: &str, overrides: &[Override]) -> Result<Source, SceneError> {
    let source = Source { name: name.to_string(), text: text.to_string() };
    if overrides.is_empty() {
        return Ok(source);
    }
    let document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| {
        source.error(error.span().unwrap_or(0..0), error.message().trim().replace('\n', ", "), "mend the TOML here")
    })?;
    let mut root = Item::Table(document.as_table().clone());
    for change in overrides {
        change.set(&mut root, &change.path)?;
    }
    let text = root.as_table().map_or_else(String::new, |table| DocumentMut::from(table.clone()).to_string());
    Ok(Source { name: format!("{name} (with --set)"), text })
}
