//! The JSON Schema of a scene.

use schemars::transform::{RecursiveTransform, Transform};
use schemars::{Schema, schema_for};
use serde_json::{Value, json};

use super::read::Document;

/// Returns the JSON Schema (draft 2020-12) of a scene, for editors that complete and check TOML. What depends on several
/// keys at once only the reader of scenes checks.
pub fn schema() -> Value {
    let mut schema = schema_for!(Document);
    RecursiveTransform(simplify).transform(&mut schema);
    RecursiveTransform(without_links).transform(&mut schema);
    schema.to_value()
}

/// Removes null, which TOML does not have, and formats of numbers; makes one list of the words of a key.
fn simplify(schema: &mut Schema) {
    let Some(schema) = schema.as_object_mut() else { return };
    schema.remove("format");
    schema.retain(|key, of| key != "default" || !of.is_null());
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [only] = &types[..] {
            schema["type"] = only.clone();
        }
    }
    if let Some(Value::Array(mut parts)) = schema.remove("anyOf") {
        parts.retain(|part| *part != json!({"type": "null"}));
        match &parts[..] {
            [Value::Object(only)] => only.clone().into_iter().for_each(|(key, of)| _ = schema.entry(key).or_insert(of)),
            _ => _ = schema.insert("anyOf".to_string(), parts.into()),
        }
    }
    if let Some(Value::Array(parts)) = schema.get("oneOf") {
        let words: Option<Vec<_>> = parts.iter().map(|part| part.get("const").or(part.get("enum")).cloned()).collect();
        if let Some(words) = words {
            let others = schema.remove("enum");
            schema.remove("oneOf");
            let words = words.into_iter().chain(others).flat_map(|words| match words {
                Value::Array(words) => words,
                word => vec![word],
            });
            schema.insert("enum".to_string(), words.collect());
        }
    }
    if let Some(Value::String(text)) = schema.get_mut("description") {
        let paragraphs = text.split("\n\n").map(|paragraph| paragraph.replace('\n', " "));
        *text = paragraphs.collect::<Vec<_>>().join("\n\n");
    }
}

/// Leaves the words of the links in descriptions, whose targets are those of the pages below doc/reference/scene.
fn without_links(schema: &mut Schema) {
    let Some(Value::String(text)) = schema.get_mut("description") else { return };
    while let Some((before, (_, after))) = text.split_once("](").and_then(|(b, a)| Some((b, a.split_once(')')?))) {
        let (before, word) = before.rsplit_once('[').unwrap_or(("", before));
        *text = format!("{before}{word}{after}");
    }
}

/// The rows of the pages below doc/reference/scene are those of the schema.
#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::fs;
    use std::path::Path;

    use super::*;

    /// A row of a table of keys.
    struct Row {
        key: String,
        /// The kinds that alone have the key, such as `cylinder, sphere`; empty if all do.
        kinds: String,
        example: String,
        value: String,
        default: String,
        meaning: String,
    }

    /// Returns the rows of the table called `table`: one for each paragraph of a description that has an example.
    ///
    /// A paragraph is a text, then `Example: …. Value: …. Default: ….`, of which the last two may be missing. It begins
    /// with the kinds that alone have the key, if any: `cylinder, sphere: …`.
    fn rows(schema: &Value, table: &str) -> Vec<Row> {
        let of = &schema["$defs"][table];
        let required = of["required"].as_array().cloned().unwrap_or_default();
        let properties = of["properties"].as_object().unwrap_or_else(|| panic!("no table {table}"));
        let row = |key: &str, of: &Value, paragraph: &str| {
            let (text, example) = paragraph.split_once("Example: ")?;
            let (example, default) = example.trim_end_matches('.').split_once(". Default: ").unwrap_or((example, ""));
            let (example, value) = example.trim_end_matches('.').split_once(". Value: ").unwrap_or((example, ""));
            let is_kind = |word: &str| word.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-');
            let (kinds, meaning) =
                text.split_once(": ").filter(|(kinds, _)| kinds.split(", ").all(is_kind)).unwrap_or(("", text));
            let words = (value.is_empty()).then(|| words(schema, of)).flatten();
            let parts = [words.unwrap_or_default(), value.to_string(), limits(of)];
            let default = match default {
                "" if required.contains(&key.into()) => "required",
                "" => "–",
                default => default,
            };
            let value = parts.into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
            assert!(!value.is_empty(), "{table}.{key}: the description lacks `Value: …`");
            Some(Row {
                key: key.to_string(),
                kinds: kinds.to_string(),
                example: example.trim_end_matches('.').to_string(),
                value,
                default: default.to_string(),
                meaning: meaning.trim().to_string(),
            })
        };
        let rows_of = |(key, of): (&String, &Value)| {
            let text = of["description"].as_str().unwrap_or_default();
            text.split("\n\n").filter_map(|paragraph| row(key, of, paragraph)).collect::<Vec<_>>()
        };
        properties.iter().flat_map(rows_of).collect()
    }

    /// Returns the words that a key may have as value.
    fn words(schema: &Value, of: &Value) -> Option<String> {
        let of = reference(of).map_or(of, |name| &schema["$defs"][name]);
        if of["type"] == "boolean" {
            return Some("`true`, `false`".to_string());
        }
        let words: Vec<String> = of["enum"].as_array()?.iter().map(|word| format!("`{word}`")).collect();
        Some(words.join(", "))
    }

    /// Returns the name of the definition that a key refers to.
    fn reference(of: &Value) -> Option<&str> {
        of["$ref"].as_str()?.strip_prefix("#/$defs/")
    }

    /// Returns the limits of a number.
    fn limits(of: &Value) -> String {
        if let (Some(least), Some(most)) = (of.get("minimum"), of.get("maximum")) {
            return format!("{least} to {most}");
        }
        let signs = [("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"), ("exclusiveMaximum", "<")];
        let limits = signs.iter().filter_map(|(name, sign)| Some(format!("{sign} {}", of.get(name)?)));
        limits.collect::<Vec<_>>().join(" and ")
    }

    /// Returns the table of a page after the line `<!-- keys of TABLE, …: KINDS -->`, which has the rows for these kinds, or
    /// those for all kinds. A table with a column of kinds has the rows for some.
    fn table(schema: &Value, of: &str, head: &str) -> String {
        let (tables, kinds) = of.split_once(": ").unwrap_or((of, ""));
        let with_kinds = head.starts_with("| kind |");
        let mut text = String::new();
        for row in tables.split(", ").flat_map(|table| rows(schema, table)) {
            let Row { kinds: own, example, value, default, meaning, .. } = row;
            if with_kinds && !own.is_empty() {
                let own = own.split(", ").map(|kind| format!("`{kind}`")).collect::<Vec<_>>().join(", ");
                text.extend(["| ", &own, " "]);
            } else if with_kinds || own != kinds {
                continue;
            }
            text.extend(["| ", &example, " | ", &value, " | ", &default, " | ", &meaning, " |\n"]);
        }
        text
    }

    /// Returns a page with the rows of its tables of keys from the schema; adds the tables to `known`.
    fn page(schema: &Value, text: &str, known: &mut BTreeSet<String>) -> String {
        let mut parts = text.split_inclusive("<!-- keys of ");
        let mut page = parts.next().unwrap_or_default().to_string();
        for part in parts {
            let (of, rest) = part.split_once(" -->\n\n").expect("a blank line");
            let (head, rest) = rest.split_once('\n').expect("a head");
            let (line, rest) = rest.split_once('\n').expect("a line");
            let after = rest.split_inclusive('\n').skip_while(|line| line.starts_with('|')).collect::<String>();
            known.extend(of.split(": ").next().iter().flat_map(|tables| tables.split(", ")).map(str::to_string));
            page.extend([of, " -->\n\n", head, "\n", line, "\n", &table(schema, of, head), &after]);
        }
        page
    }

    /// The keys are described in one place, the tables of a scene. With `PAGES=write` this test writes the pages.
    #[test]
    fn the_pages_have_the_rows_of_the_schema() {
        let mut schema = schema_for!(Document);
        RecursiveTransform(simplify).transform(&mut schema);
        let schema = schema.to_value();
        let (mut known, mut differ) = (BTreeSet::new(), Vec::new());
        for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("doc/reference/scene")).unwrap() {
            let path = entry.unwrap().path();
            let text = fs::read_to_string(&path).unwrap();
            let page = page(&schema, &text, &mut known);
            if std::env::var("PAGES").is_ok_and(|word| word == "write") {
                fs::write(&path, &page).unwrap();
            } else if page != text {
                differ.push(path);
            }
        }
        assert!(differ.is_empty(), "PAGES=write writes {differ:?}");
        // Each table is on a page, and each key has a row or is a table itself.
        for (table, of) in schema["$defs"].as_object().unwrap() {
            let Some(properties) = of["properties"].as_object() else { continue };
            assert!(known.contains(table), "no page has the keys of {table}");
            let rows: BTreeSet<String> = rows(&schema, table).into_iter().map(|row| row.key).collect();
            for (key, of) in properties.iter().filter(|(key, _)| !rows.contains(*key)) {
                let of = of["anyOf"].get(0).unwrap_or(of);
                let inner = reference(of).or_else(|| reference(&of["items"]));
                assert!(inner.is_some_and(|inner| known.contains(inner)), "{table}.{key} has no example");
            }
        }
    }
}
