//! The rooms of the library: which may use which, no circle of files within a room, and what has no place in any.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Every room, and the rooms that it may use beside [`EVERYWHERE`].
const ROOMS: &[(&str, &[&str])] = &[
    ("base", &[]),
    ("algebra", &[]),
    ("solver", &["algebra"]),
    ("body", &["algebra", "solver"]),
    ("scene", &["algebra", "solver", "body"]),
    ("run", &["algebra", "solver", "body", "scene"]),
];
const EVERYWHERE: &str = "base";

/// What the library never does: it promises no panic, prints nothing, writes no file and starts no process. What is unsafe, and what reads
/// files, has its place.
const PLACES: &[(&str, &[&str])] = &[
    ("unsafe", &["algebra/linear/"]),
    ("File::create", &[]),
    ("fs::write", &[]),
    ("Command::new", &[]),
    ("print!", &[]),
    ("println!", &[]),
    ("dbg!", &[]),
    (".unwrap()", &[]),
    ("panic!(", &[]),
    ("todo!(", &[]),
    ("unimplemented!(", &[]),
    ("#[path", &[]),
    ("process::exit", &[]),
    ("File::open", &["base/input.rs"]),
];

/// One idea a file.
const MOST_LINES: usize = 700;

/// The text of every file of the library, by its path below `src`.
fn sources() -> BTreeMap<String, String> {
    fn collect(root: &Path, folder: &Path, into: &mut BTreeMap<String, String>) {
        for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                collect(root, &path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                into.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = BTreeMap::new();
    collect(&root, &root, &mut sources);
    sources
}

/// The lines that are compiled, without comments and test modules.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_tests = false;
    text.lines().enumerate().filter(move |(_, line)| {
        let was_in_tests = in_tests;
        in_tests = line.starts_with("#[cfg(test)]") || line.starts_with("#[cfg(all(test,") || in_tests && *line != "}";
        !was_in_tests && !in_tests && !line.trim_start().starts_with("//")
    })
}

/// The modules that a file names by `crate::` and `super::`, as paths below `src` without `.rs`.
fn named(file: &str, text: &str) -> BTreeSet<String> {
    let here: Vec<&str> = file.trim_end_matches(".rs").split('/').filter(|part| *part != "lib").collect();
    let mut named = BTreeSet::new();
    for (_, line) in code(text) {
        let is_path = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
        for path in
            line.split(|c| !is_path(c)).filter(|word| word.starts_with("crate::") || word.starts_with("super::"))
        {
            let mut at = if path.starts_with("crate") { Vec::new() } else { here.clone() };
            for part in path.split("::") {
                match part {
                    "crate" | "" => {}
                    "super" => drop(at.pop()),
                    part => at.push(part),
                }
            }
            named.insert(at.join("/"));
        }
    }
    named
}

fn room(path: &str) -> &str {
    path.split('/').next().unwrap().trim_end_matches(".rs")
}

#[test]
fn rooms_use_what_is_below_them() {
    for (file, text) in sources().iter().filter(|(file, _)| *file != "lib.rs") {
        let (_, may_use) = ROOMS.iter().find(|(name, _)| *name == room(file)).expect(file);
        for path in named(file, text) {
            let used = room(&path);
            let may = used == room(file) || used == EVERYWHERE || may_use.contains(&used) || used.is_empty();
            assert!(may, "{file}: `{}` may not use `{path}`", room(file));
        }
    }
}

/// In each folder the entries, files with the folders of their names, use each other in one direction.
#[test]
fn no_folder_has_a_circle() {
    let sources = sources();
    let mut uses: BTreeMap<String, BTreeMap<String, BTreeSet<String>>> = BTreeMap::new();
    for (file, text) in &sources {
        let user: Vec<&str> = file.trim_end_matches(".rs").split('/').collect();
        for path in named(file, text) {
            let used: Vec<&str> = path.split('/').collect();
            let common = user.iter().zip(&used).take_while(|(a, b)| a == b).count();
            let (Some(a), Some(b)) = (user.get(common), used.get(common)) else { continue };
            let folder = user[..common].join("/");
            let is_module =
                sources.contains_key(&format!("{folder}/{b}.rs")) || sources.contains_key(&format!("{b}.rs"));
            if is_module {
                uses.entry(folder).or_default().entry((*a).to_string()).or_default().insert((*b).to_string());
            }
        }
    }
    for (folder, mut uses) in uses {
        // What uses nothing that is left is taken away; what then is left has a circle.
        while let Some(leaf) = uses
            .iter()
            .find(|(_, used)| used.is_empty())
            .map(|(name, _)| name.clone())
            .or_else(|| uses.values().flatten().find(|used| !uses.contains_key(*used)).cloned())
        {
            uses.remove(&leaf);
            for used in uses.values_mut() {
                used.remove(&leaf);
            }
        }
        assert!(uses.is_empty(), "{folder}: a circle in {uses:?}");
    }
}

#[test]
fn everything_has_its_place() {
    for (file, text) in sources() {
        let lines = text.lines().count();
        assert!(lines <= MOST_LINES, "{file}: {lines} lines");
        assert!(!text.contains("# Panics"), "{file} promises a panic");
        for (line, code) in code(&text) {
            for (what, places) in PLACES.iter().filter(|(what, _)| code.contains(what)) {
                assert!(places.iter().any(|place| file.starts_with(place)), "{file}:{}: {what}", line + 1);
            }
        }
    }
}

/// The searches see what they must: where these are at home they are found.
#[test]
fn the_searches_see() {
    let sources = sources();
    let circle = "use super::y::Y;\n// use crate::z;\n#[cfg(test)]\nmod tests {\n    use crate::w;\n}\nfn f() -> crate::a::B {}\n";
    assert_eq!(named("a/x.rs", circle), BTreeSet::from(["a/B".to_string(), "a/y/Y".to_string()]));
    assert!(sources["algebra/linear/umfpack.rs"].contains("unsafe {"));
    assert!(sources.len() > 200 && ROOMS.iter().all(|(room, _)| sources.contains_key(&format!("{room}.rs"))));
}
