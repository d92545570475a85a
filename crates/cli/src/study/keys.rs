//! The keys of a report, from its schema.

use std::sync::LazyLock;

use serde_json::Value;
use stickslip_output::run_schema;

/// The kind of the value of a key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Number,
    /// A text, or `true` or `false`.
    Word,
    /// A list of numbers.
    Vector,
    /// Several keys, or a list of anything but numbers.
    Several,
}

/// A key of a report, in which `[]` stands for the elements of a list.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Key {
    pub name: String,
    pub kind: Kind,
}

/// All keys.
static KEYS: LazyLock<Vec<Key>> = LazyLock::new(|| {
    let schema = run_schema();
    let mut keys = Vec::new();
    below(&schema, &schema, "", &mut keys);
    keys
});

/// Adds the keys below `node`, whose own key is `name`.
fn below(schema: &Value, node: &Value, name: &str, keys: &mut Vec<Key>) {
    if let Some(properties) = node["properties"].as_object() {
        for (key, value) in properties {
            let name = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            add(schema, value, &name, keys);
        }
    }
}

fn add(schema: &Value, node: &Value, name: &str, keys: &mut Vec<Key>) {
    let node = resolved(schema, node);
    let is = |node: &Value, kinds: &[&str]| {
        let named = |kind: &Value| kind.as_str().is_some_and(|kind| kinds.contains(&kind));
        named(&node["type"]) || node["type"].as_array().is_some_and(|all| all.iter().any(named))
    };
    let numbers = ["number", "integer"];
    let kind = match node {
        node if node["properties"].is_object() => Kind::Several,
        node if is(node, &["array"]) && is(resolved(schema, &node["items"]), &numbers) => Kind::Vector,
        node if is(node, &["array"]) => Kind::Several,
        node if is(node, &numbers) => Kind::Number,
        _ => Kind::Word,
    };
    keys.push(Key { name: name.to_string(), kind });
    if is(node, &["array"]) {
        add(schema, &node["items"], &format!("{name}[]"), keys);
    }
    below(schema, node, name, keys);
}

/// Follows references and the choice between a value and null.
fn resolved<'a>(schema: &'a Value, node: &'a Value) -> &'a Value {
    let is_null = |one: &&Value| one["type"] == "null";
    if let Some(path) = node["$ref"].as_str().and_then(|path| path.strip_prefix('#')) {
        return schema.pointer(path).map_or(node, |found| resolved(schema, found));
    }
    let choice = node["anyOf"].as_array().and_then(|all| all.iter().find(|one| !is_null(one)));
    choice.map_or(node, |one| resolved(schema, one))
}

/// Returns the key of this name, with `[]` for each index.
pub(super) fn find(name: &str) -> Option<&'static Key> {
    KEYS.iter().find(|key| key.name == name)
}

/// Returns the keys directly below `name`; those of the report if it is empty.
pub(super) fn children(name: &str) -> Vec<&'static str> {
    let under = |key: &'static Key| {
        let rest = if name.is_empty() {
            &key.name
        } else {
            key.name.strip_prefix(name)?.trim_start_matches("[]").strip_prefix('.')?
        };
        (!rest.contains(['.', '['])).then_some(rest)
    };
    KEYS.iter().filter_map(under).collect()
}

/// Returns the most similar keys with one value, the most similar first: those whose last part is equal, then others of a
/// similar spelling. Among equally similar ones, keys of the report itself precede keys of lists.
pub(super) fn similar(name: &str) -> Vec<&'static str> {
    const MOST: usize = 3;
    const ALIKE: f64 = 0.75;
    let last = |name: &str| name.rsplit('.').next().unwrap_or_default().trim_end_matches("[]").to_string();
    let plain = |name: &str| name.replace("[]", "");
    let likeness = |key: &&'static Key| {
        let whole = strsim::normalized_damerau_levenshtein(&plain(&key.name), &plain(name));
        let parts = strsim::normalized_damerau_levenshtein(&last(&key.name), &last(name));
        if parts == 1.0 { 1.0 + whole } else { whole.max(parts) }
    };
    let ends = KEYS.iter().filter(|key| matches!(key.kind, Kind::Number | Kind::Word));
    let mut found: Vec<(f64, &str)> =
        ends.map(|key| (likeness(&key), key.name.as_str())).filter(|(alike, _)| *alike >= ALIKE).collect();
    found.sort_by(|(a, _), (b, _)| b.total_cmp(a));
    found.into_iter().map(|(_, name)| name).take(MOST).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_have_their_kinds() {
        for (name, kind) in [
            ("largest_pressure", Kind::Several),
            ("largest_pressure.pressure", Kind::Number),
            ("largest_pressure.singular", Kind::Word),
            ("largest_force.force", Kind::Vector),
            ("largest_force.force[]", Kind::Number),
            ("boundaries", Kind::Several),
            ("boundaries[].sum_p_n", Kind::Number),
            ("estimates.contact[].stick.ratio", Kind::Number),
            ("cycle.regime", Kind::Word),
            ("totals.peak_rss_bytes", Kind::Number),
            ("status", Kind::Word),
        ] {
            assert_eq!(find(name).map(|key| key.kind), Some(kind), "{name}");
        }
        assert_eq!(children("friction"), ["friction_work", "mesh_error", "time_error"]);
        assert!(children("boundaries").contains(&"force"));
        assert!(children("").contains(&"totals"));
    }

    #[test]
    fn similar_keys_are_found() {
        assert!(similar("friction_work").contains(&"friction.friction_work"));
        assert_eq!(similar("largest_presure.pressure")[0], "largest_pressure.pressure");
        assert_eq!(similar("cycle.friction_wrok")[0], "cycle.friction_work");
        assert_eq!(similar("boundaries.force")[0], "boundaries[].force[]");
        assert!(similar("zzzzzz").is_empty());
    }
}
