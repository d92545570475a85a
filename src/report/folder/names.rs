//! The names of the files that a run writes.

/// The file from which a run goes on.
pub(super) const CHECKPOINT: &str = ".checkpoint";

/// Whether a run writes a file of this name.
pub(super) fn is_ours(name: &str) -> bool {
    let is_number = |text: &str| text.len() >= 4 && text.bytes().all(|b| b.is_ascii_digit());
    let line = |name: &str| {
        let stem = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".svg"))?;
        let (number, _boundary) = stem.split_once('_').unwrap_or((stem, ""));
        let (number, part) = number.split_once('-').unwrap_or((number, "1"));
        Some(is_number(number) && part.bytes().all(|b| b.is_ascii_digit()))
    };
    let numbered = |prefix: &str, suffix: &str| {
        name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(suffix)).is_some_and(is_number)
    };
    let names =
        ["run.json", "increments.csv", "forces.csv", "events.csv", "fields.pvd", "forces.svg", "iterations.svg"];
    names.contains(&name)
        || name.strip_prefix("contact_").and_then(line).unwrap_or(false)
        || numbered("fields_", ".vtu")
        || numbered("deformed_", ".svg")
        || name.strip_prefix("probe_").and_then(|rest| rest.strip_suffix(".csv")).is_some()
}

#[cfg(test)]
mod tests {
    use super::is_ours;

    #[test]
    fn only_files_of_a_run_are_replaced() {
        assert!(
            ["run.json", "increments.csv", "contact_0001.csv", "contact_12345.svg", "contact_0001_left.csv"]
                .into_iter()
                .all(is_ours)
        );
        assert!(
            ["contact_0007-3.csv", "contact_0007-12_left.csv", "deformed_0000.svg", "probe_a.csv", "forces.svg"]
                .into_iter()
                .all(is_ours)
        );
        assert!(!["contact_0007-a.csv", "deformed_x.svg", "probe_a.txt"].into_iter().any(is_ours));
        assert!(is_ours("fields_0001.vtu") && is_ours("fields.pvd") && !is_ours("fields_mine.vtu"));
        assert!(!["contact_.csv", "contact_0001.txt", "contact_mine.csv", "notes.md"].into_iter().any(is_ours));
    }
}
