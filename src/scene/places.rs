//! The place of each key of a scene in its text.

use std::collections::BTreeSet;
use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

/// The places of the keys of a text, such as `contact[0].friction`. For each key: the place of its value, then the
/// places of the keys below it, then the place of its name. The only element of a list is also listed under the list's
/// key.
pub(super) struct Places(Vec<(String, Range<usize>)>);

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
        if let Some(span) = item.span() {
            self.0.push((key.to_string(), span));
        }
        match item {
            Item::ArrayOfTables(tables) => {
                for (k, table) in tables.iter().enumerate() {
                    let key = format!("{key}[{k}]");
                    self.0.extend(table.span().map(|span| (key.clone(), span)));
                    self.take_table(table, &key);
                }
                if let (1, Some(one)) = (tables.len(), tables.get(0)) {
                    self.take_table(one, key);
                }
            }
            Item::Value(Value::Array(values)) => {
                for (k, value) in values.iter().enumerate() {
                    let key = format!("{key}[{k}]");
                    self.0.extend(value.span().map(|span| (key.clone(), span)));
                    if let Some(table) = value.as_inline_table() {
                        self.take_table(table, &key);
                    }
                }
                if let (1, Some(Value::InlineTable(one))) = (values.len(), values.get(0)) {
                    self.take_table(one, key);
                }
            }
            _ => {
                if let Some(table) = item.as_table_like() {
                    self.take_table(table, key);
                }
            }
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
