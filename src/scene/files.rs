//! The files that a scene names.

use toml_edit::{Item, TableLike, Value};

/// Returns the values of all keys `file` in `text`, in order; empty if `text` is not TOML.
pub(super) fn files(text: &str) -> Vec<String> {
    let mut files = Vec::new();
    if let Ok(document) = toml_edit::Document::parse(text) {
        of_table(document.as_table(), &mut files);
    }
    files
}

fn of_table(table: &dyn TableLike, files: &mut Vec<String>) {
    for (key, item) in table.iter() {
        match item {
            Item::Value(value) => of_value(key, value, files),
            Item::Table(table) => of_table(table, files),
            Item::ArrayOfTables(tables) => tables.iter().for_each(|table| of_table(table, files)),
            Item::None => {}
        }
    }
}

fn of_value(key: &str, value: &Value, files: &mut Vec<String>) {
    match value {
        Value::String(name) if key == "file" => files.push(name.value().clone()),
        Value::Array(values) => values.iter().for_each(|value| of_value(key, value, files)),
        Value::InlineTable(table) => of_table(table, files),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn wherever_they_stand() {
        let text = "mesh.file = 'a.msh'\ntitle = 'file'\n[[contact]]\nobstacle = { kind = 'table', file = \"b.csv\" }\n\
                    [[contact]]\n[contact.obstacle]\nfile = 'c.csv'\n";
        assert_eq!(super::files(text), ["a.msh", "b.csv", "c.csv"]);
        assert!(super::files("file = ").is_empty());
    }
}
