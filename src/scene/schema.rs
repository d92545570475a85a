//! The JSON Schema of a scene.

use schemars::transform::{RecursiveTransform, Transform};
use schemars::{Schema, schema_for};
use serde_json::{Value, json};

use super::document::Document;

/// Returns the JSON Schema (draft 2020-12) of a scene, for editors that complete and check TOML. What depends on several
/// keys at once only the reader of scenes checks.
pub fn schema() -> Value {
    let mut schema = schema_for!(Document);
    RecursiveTransform(simplify).transform(&mut schema);
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
        *text = text.replace('\n', " ");
    }
}
