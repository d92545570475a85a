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

/// All keys of a report with their kinds. In a name, `[]` stands for the elements of a list.
static KEYS: LazyLock<Vec<(String, Kind)>> = LazyLock::new(|| {
    let schema = run_schema();
    let mut keys = Vec::new();
    add(&schema, &schema, "", &mut keys);
    // The first one is the report itself.
    keys.split_off(1)
});

/// Adds the key of this name, described by `node`, and the keys below it.
fn add(schema: &Value, node: &Value, name: &str, keys: &mut Vec<(String, Kind)>) {
    let node = resolved(schema, node);
    let is = |node: &Value, kinds: &[&str]| {
        let named = |kind: &Value| kind.as_str().is_some_and(|kind| kinds.contains(&kind));
        named(&node["type"]) || node["type"].as_array().is_some_and(|all| all.iter().any(named))
    };
    let (is_list, numbers) = (is(node, &["array"]), ["number", "integer"]);
    let kind = match node["properties"].is_object() {
        false if is_list && is(resolved(schema, &node["items"]), &numbers) => Kind::Vector,
        false if is(node, &numbers) => Kind::Number,
        false if !is_list => Kind::Word,
        _ => Kind::Several,
    };
    keys.push((name.to_string(), kind));
    if is_list {
        add(schema, &node["items"], &format!("{name}[]"), keys);
    }
    for (key, value) in node["properties"].as_object().into_iter().flatten() {
        add(schema, value, format!("{name}.{key}").trim_start_matches('.'), keys);
    }
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

/// Returns the kind of the key of this name, with `[]` for each index; `None` if there is no such key.
pub(super) fn kind(name: &str) -> Option<Kind> {
    KEYS.iter().find(|(key, _)| key == name).map(|(_, kind)| *kind)
}

/// The values by which results of several keys are known, the first one that a result has.
const MAIN: [&str; 5] = ["magnitude", "pressure", "ratio", "friction_work", "length"];

/// Returns the main values of the results of a report whose descriptions have all words of `name`.
pub(super) fn described(name: &str) -> Vec<String> {
    let schema = run_schema();
    let words: Vec<&str> = name.split(['_', '.', ' ']).collect();
    let main = |key: &&str| {
        let text = schema["properties"][key]["description"].as_str()?.to_lowercase();
        let value = MAIN.iter().map(|main| format!("{key}.{main}")).find(|value| kind(value) == Some(Kind::Number))?;
        words.iter().all(|word| text.contains(word)).then_some(value)
    };
    children("").iter().filter_map(main).collect()
}

/// Returns the keys directly below `name`; those of the report if it is empty.
pub(super) fn children(name: &str) -> Vec<&'static str> {
    let under = |(key, _): &'static (String, Kind)| {
        let rest = match name {
            "" => key,
            name => key.strip_prefix(name)?.trim_start_matches("[]").strip_prefix('.')?,
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
    let likeness = |key: &str| {
        let whole = strsim::normalized_damerau_levenshtein(&plain(key), &plain(name));
        let parts = strsim::normalized_damerau_levenshtein(&last(key), &last(name));
        if parts == 1.0 { 1.0 + whole } else { whole.max(parts) }
    };
    let ends = KEYS.iter().filter(|(_, kind)| matches!(kind, Kind::Number | Kind::Word));
    let found = ends.map(|(key, _)| (likeness(key), key.as_str()));
    let mut found: Vec<(f64, &str)> = found.filter(|(alike, _)| *alike >= ALIKE).collect();
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
            assert_eq!(super::kind(name), Some(kind), "{name}");
        }
        assert_eq!(children("friction"), ["friction_work", "time_error"]);
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
        assert_eq!(described("tangential_force")[0], "holding_force.magnitude");
        assert_eq!(described("displacement"), ["largest_displacement.length"]);
        assert!(described("zzzzzz").is_empty());
    }
}
