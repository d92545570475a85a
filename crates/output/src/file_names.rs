//! File names made from boundary names, which a mesh file may choose freely.

/// The longest part of a file name made from a boundary name, bytes. Together with number, suffix and the mark of a
/// partial file it stays below the limit of file systems, 255.
const LONGEST: usize = 100;

/// Returns a part of a file name for each of `boundaries`, in their order: letters, digits, `-` and `_` remain, other
/// characters become `_`, and names that would coincide (also on file systems that ignore case) are numbered.
pub(super) fn file_names<'a>(boundaries: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for boundary in boundaries {
        let safe = safe(boundary);
        let mut candidates = (1..).map(|k| if k == 1 { safe.clone() } else { format!("{safe}-{k}") });
        let new = candidates.find(|name| names.iter().all(|other| other.to_lowercase() != name.to_lowercase()));
        names.extend(new);
    }
    names
}

fn safe(boundary: &str) -> String {
    let allowed = |c: char| c.is_alphanumeric() || c == '-' || c == '_';
    let mut name = String::new();
    for c in boundary.chars().map(|c| if allowed(c) { c } else { '_' }) {
        if name.len() + c.len_utf8() > LONGEST {
            break;
        }
        name.push(c);
    }
    name
}

#[cfg(test)]
mod tests {
    use super::file_names;

    #[test]
    fn names_are_safe_and_distinct() {
        let names = |boundaries: &[&str]| file_names(boundaries.iter().copied());
        assert_eq!(names(&["left", "bore_2", "Fuß-1"]), ["left", "bore_2", "Fuß-1"]);
        assert_eq!(names(&["a/b", "../x", "le,ft", ".."]), ["a_b", "___x", "le_ft", "__"]);
        assert_eq!(names(&["a/b", "a b", "A_B", "a_b-2"]), ["a_b", "a_b-2", "A_B-3", "a_b-2-2"]);
        assert_eq!(
            names(&[&"x".repeat(300), &"ß".repeat(300)]).iter().map(String::len).collect::<Vec<_>>(),
            [100, 100]
        );
    }
}
