//! The names of the files that a run writes.

use crate::view;

/// The checkpoint file, from which a run resumes.
pub(super) const CHECKPOINT: &str = ".checkpoint";

/// The page of the run.
pub(super) const PAGE: &str = "report.html";

/// The file that lists the fields of all increments.
pub(super) const SERIES: &str = "fields.pvd";

/// Returns the name of the file of all fields at the end of an increment.
pub(super) fn fields(index: usize) -> String {
    format!("fields_{index:04}.vtu")
}

/// Returns the name of the file of one rank's fields.
pub(super) fn piece(index: usize, rank: i32) -> String {
    format!("fields_{index:04}_{rank}.vtu")
}

/// Returns the name of the file that lists the files of all ranks.
pub(super) fn pieces(index: usize) -> String {
    format!("fields_{index:04}.pvtu")
}

/// Returns the number of the increment in any of these three names.
pub(super) fn increment_of_fields(name: &str) -> Option<&str> {
    let rest = name.strip_prefix("fields_")?;
    let (number, rank) = match rest.strip_suffix(".vtu") {
        Some(rest) => rest.split_once('_').unwrap_or((rest, "0")),
        None => (rest.strip_suffix(".pvtu")?, "0"),
    };
    (is_number(number) && is_digits(rank)).then_some(number)
}

/// Returns `true` for a file by which readers know that a result is complete, or which files belong together.
pub(super) fn is_head(name: &str) -> bool {
    ["run.json", SERIES].contains(&name) || names_pieces(name)
}

/// Returns `true` for a file that lists the files of the ranks.
pub(super) fn names_pieces(name: &str) -> bool {
    name.strip_suffix(".pvtu").is_some() && increment_of_fields(name).is_some()
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

fn is_number(text: &str) -> bool {
    text.len() >= 4 && is_digits(text)
}

/// Returns `true` for the name of a result file.
pub(super) fn is_ours(name: &str) -> bool {
    let line = |name: &str| {
        let stem = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".svg"))?;
        let (number, _boundary) = stem.split_once('_').unwrap_or((stem, ""));
        let (number, part) = number.split_once('-').unwrap_or((number, "1"));
        Some(is_number(number) && part.bytes().all(|b| b.is_ascii_digit()))
    };
    let numbered = |prefix: &str, suffix: &str| {
        name.strip_prefix(prefix).and_then(|rest| rest.strip_suffix(suffix)).is_some_and(is_number)
    };
    let names = [
        "run.json",
        PAGE,
        "increments.csv",
        "forces.csv",
        "events.csv",
        "cycle.csv",
        view::FILE,
        SERIES,
        "forces.svg",
        "iterations.svg",
    ];
    names.contains(&name)
        || name.strip_prefix("contact_").and_then(line).unwrap_or(false)
        || increment_of_fields(name).is_some()
        || numbered("deformed_", ".svg")
        || name.strip_prefix("probe_").and_then(|rest| rest.strip_suffix(".csv")).is_some()
}

#[cfg(test)]
mod tests {
    use super::{fields, increment_of_fields, is_head, is_ours, names_pieces, piece, pieces};

    #[test]
    fn what_says_that_others_are_whole_is_known() {
        assert!(["run.json", "fields.pvd", "fields_0001.pvtu"].into_iter().all(is_head));
        assert!(!["forces.csv", "fields_0001.vtu", "fields_0001_0.vtu", "mine.pvtu"].into_iter().any(is_head));
        assert!(names_pieces(&pieces(7)) && !names_pieces(&piece(7, 0)));
    }

    #[test]
    fn fields_are_known_by_their_increment() {
        for name in [fields(7), piece(7, 0), piece(7, 12), pieces(7)] {
            assert_eq!(increment_of_fields(&name), Some("0007"), "{name}");
        }
        assert_eq!(increment_of_fields("fields.pvd"), None);
    }

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
        assert!(is_ours("fields_0001.pvtu") && is_ours("fields_0001_0.vtu") && is_ours("fields_12345_17.vtu"));
        assert!(
            !["fields_0001_.vtu", "fields_0001_a.vtu", "fields_0001_0.pvtu", "fields_01.vtu"].into_iter().any(is_ours)
        );
        assert!(!["contact_.csv", "contact_0001.txt", "contact_mine.csv", "notes.md"].into_iter().any(is_ours));
    }
}
