//! The files that a scene names.

use toml_edit::{Item, TableLike, Value};

/// Returns the keys `file` in `text` with their values, in order; empty if `text` is not TOML.
pub(super) fn files(text: &str) -> Vec<(String, String)> {
    let mut files = Vec::new();
    if let Ok(document) = toml_edit::Document::parse(text) {
        of_table(document.as_table(), "", &mut files);
    }
    files
}

fn of_table(table: &dyn TableLike, above: &str, files: &mut Vec<(String, String)>) {
    for (name, item) in table.iter() {
        let key = format!("{above}{name}");
        match item {
            Item::Value(value) => of_value(&key, value, files),
            Item::Table(table) => of_table(table, &format!("{key}."), files),
            Item::ArrayOfTables(tables) => {
                for (k, table) in tables.iter().enumerate() {
                    of_table(table, &format!("{key}[{k}]."), files);
                }
            }
            Item::None => {}
        }
    }
}

fn of_value(key: &str, value: &Value, files: &mut Vec<(String, String)>) {
    match value {
        Value::String(name) if key.rsplit('.').next() == Some("file") => {
            files.push((key.to_string(), name.value().clone()));
        }
        Value::Array(values) => {
            for (k, value) in values.iter().enumerate() {
                of_value(&format!("{key}[{k}]"), value, files);
            }
        }
        Value::InlineTable(table) => of_table(table, &format!("{key}."), files),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn wherever_they_stand() {
        let text = "mesh.file = 'a.msh'\ntitle = 'file'\n[[contact]]\nobstacle = { kind = 'table', file = \"b.csv\" }\n\
                    [[contact]]\n[contact.obstacle]\nfile = 'c.csv'\n";
        let found =
            [("mesh.file", "a.msh"), ("contact[0].obstacle.file", "b.csv"), ("contact[1].obstacle.file", "c.csv")];
        assert_eq!(super::files(text), found.map(|(key, file)| (key.to_string(), file.to_string())));
        assert!(super::files("file = ").is_empty());
    }
}
