//! Where an equation is: the table of doc/method/architecture.md against the numbers in the code's own comments.

use crate::common::prelude::*;
use std::collections::BTreeSet;

/// What the paper's two algorithms are made of: from the README it takes two files to get to any of them.
const WANTED: [u32; 14] = [11, 12, 19, 20, 21, 22, 25, 26, 27, 28, 29, 30, 31, 36];

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path))
        .unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The number of a label that `text` begins with, and what follows.
fn label(text: &str) -> Option<(u32, &str)> {
    let (number, rest) = text.strip_prefix('(')?.split_once(')')?;
    let is_valid = number.len() <= 2 && number.bytes().all(|c| c.is_ascii_digit());
    Some((number.parse().ok().filter(|_| is_valid)?, rest))
}

/// The numbers of equations in `text`: `(12)`, and all of `(29)–(31)`.
fn numbers(text: &str) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    for (at, _) in text.match_indices('(') {
        let Some((first, rest)) = label(&text[at..]) else { continue };
        let last = rest.strip_prefix('–').and_then(label).map_or(first, |(last, _)| last);
        found.extend(first..=last);
    }
    found
}

/// The comments of a source file.
fn comments(text: &str) -> String {
    text.lines().filter_map(|line| Some(line.split_once("//")?.1)).collect::<Vec<_>>().join("\n")
}

/// The names in quotes.
fn quoted(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

/// The rows of the table: the first column, the files that the second names, and the tests of the last.
fn rows(page: &str) -> Vec<(&str, Vec<String>, Vec<&str>)> {
    let section = page.split_once("## Where an equation is\n").unwrap().1;
    let section = section.split("\n## ").next().unwrap();
    let files = |place| {
        let names = quoted(place).filter(|name| name.split('.').next_back() == Some("rs"));
        names.map(|name| if name.starts_with("crates/") { name.to_string() } else { format!("src/{name}") }).collect()
    };
    let rows = section.lines().filter_map(|line| line.strip_prefix("| ")?.strip_suffix(" |"));
    rows.skip(2)
        .map(|row| {
            let cells: Vec<&str> = row.split(" | ").collect();
            (cells[0], files(cells[1]), quoted(cells[cells.len() - 1]).collect())
        })
        .collect()
}

/// All Rust code below these folders.
fn code(folders: &[&str]) -> String {
    fn all(folder: &Path, into: &mut String) {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                all(&path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                into.push_str(&fs::read_to_string(&path).unwrap());
            }
        }
    }
    let (root, mut code) = (Path::new(env!("CARGO_MANIFEST_DIR")), String::new());
    for folder in folders {
        all(&root.join(folder), &mut code);
    }
    code
}

/// Each equation of the table is held by tests that exist.
#[test]
fn every_equation_is_held_by_a_test() {
    let code = code(&["src", "crates", "studies", "tests"]);
    let is_test = |name: &str| {
        let heads = code.split("#[test]\n").skip(1).map(|rest| rest.split('{').next().unwrap());
        heads.into_iter().any(|head| head.contains(&format!("fn {name}(")))
    };
    for (what, _, tests) in rows(&read("doc/method/architecture.md")) {
        assert!(!tests.is_empty(), "the row `{what}` names no test");
        for name in tests {
            assert!(is_test(name), "there is no test `{name}`, but the row `{what}` says so");
        }
    }
}

#[test]
fn every_equation_is_where_the_table_says() {
    let page = read("doc/method/architecture.md");
    let mut listed = BTreeSet::new();
    for (what, files, _) in rows(&page) {
        let equations = numbers(what);
        for file in files {
            let labels = numbers(&comments(&read(&file)));
            let missing: Vec<&u32> = equations.difference(&labels).collect();
            assert!(
                missing.is_empty(),
                "no comment of {file} has the equations {missing:?}, but the row `{what}` says so"
            );
        }
        listed.extend(equations);
    }
    let missing: Vec<u32> = WANTED.into_iter().filter(|number| !listed.contains(number)).collect();
    assert!(missing.is_empty(), "doc/method/architecture.md does not say where the equations {missing:?} are");
    assert!(read("README.md").contains("](doc/method/architecture.md#where-an-equation-is)"));
}

/// The names of the code that the glossary gives are there.
#[test]
fn the_glossary_names_what_there_is() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let code = code(&["src", "crates"]);
    let page = read("doc/reference/glossary.md").replace("\\|", "");
    let columns = page.lines().filter_map(|line| line.strip_prefix("| **")?.strip_suffix(" |")?.rsplit('|').next());
    let names: Vec<&str> = columns.flat_map(|column| column.split('`').skip(1).step_by(2)).collect();
    assert!(names.len() > 40);
    for name in names {
        let last = |name: &str| name.split([':', '.']).next_back().unwrap().to_string();
        // `kind = "value"` is a key of a scene and its value, `a/b.rs` a file, the rest a path.
        let parts = match name.split_once(" = ") {
            Some((key, value)) => vec![last(key), value.trim_matches('"').to_string()],
            None => vec![last(name)],
        };
        let there = match name.strip_suffix(".rs") {
            Some(_) => root.join("src").join(name).exists() || root.join(name).exists(),
            None => parts.iter().all(|part| code.contains(part.as_str()) || code.contains(&part.replace('-', ""))),
        };
        assert!(there, "doc/reference/glossary.md names `{name}`, which the code does not have");
    }
}

/// The types and files that the page of the architecture names are there.
#[test]
fn the_architecture_names_what_there_is() {
    fn all(folder: &Path, files: &mut Vec<String>, code: &mut String) {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                all(&path, files, code);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path.display().to_string());
                code.push_str(&fs::read_to_string(&path).unwrap());
            }
        }
    }
    let (root, mut files, mut code) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new(), String::new());
    for folder in ["src", "crates", "studies", "fuzz/src", "tests", "examples"] {
        all(&root.join(folder), &mut files, &mut code);
    }
    let words: BTreeSet<&str> = code.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let page = read("doc/method/architecture.md");
    let (mut named, mut missing) = (0, Vec::new());
    for name in page.split('`').skip(1).step_by(2) {
        if Path::new(name).extension().is_some_and(|extension| extension == "rs") && !name.contains(' ') {
            if !files.iter().any(|file| file.ends_with(&format!("/{name}"))) {
                missing.push(name);
            }
        } else {
            let parts: Vec<&str> = name.split("::").collect();
            let is_type = |part: &&str| part.chars().next().is_some_and(char::is_uppercase) && part.len() > 3;
            let is_name =
                parts.iter().all(|part| !part.is_empty() && part.chars().all(|c| c.is_alphanumeric() || c == '_'));
            if !(is_name && parts.iter().any(is_type)) || name.chars().all(|c| !c.is_lowercase()) {
                continue;
            }
            if parts.iter().any(|part| !words.contains(part)) {
                missing.push(name);
            }
        }
        named += 1;
    }
    assert_eq!(missing, [""; 0]);
    assert!(named > 80, "{named}");
}

#[test]
fn numbers_are_read_from_labels_only() {
    assert_eq!(numbers("the rows of (19), (21)–(23)"), BTreeSet::from([19, 21, 22, 23]));
    assert_eq!(numbers("(1998) (a) f(3) (12"), BTreeSet::from([3]));
}
