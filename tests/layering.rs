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

/// The places of code with an effect outside the library: it prints nothing, writes no file, starts no process and reaches no network.
const PLACES: &[(&str, &[&str])] = &[
    ("unsafe", &["algebra/linear/"]),
    ("print!", &[]),
    ("println!", &[]),
    ("File::create", &[]),
    ("fs::write", &[]),
    ("Command::new", &[]),
    ("process::exit", &[]),
    ("std::net", &[]),
    ("File::open", &["base/input.rs"]),
    // OpenBLAS has read its settings there.
    ("std::env", &["algebra/linear/process/blas/"]),
    ("thread::", &["algebra/jobs.rs", "algebra/linear/"]),
    ("std::panic", &["algebra/jobs.rs"]),
];

/// Code that stands nowhere, in no package.
const NOWHERE: [&str; 6] = ["dbg!", ".unwrap()", "panic!(", "todo!(", "unimplemented!(", "#[path"];

/// The package whose business is to call C.
const CALLS_C: &str = "crates/distributed/src";

/// The other packages, and where they print.
const PACKAGES: &[(&str, &[&str])] = &[
    ("crates/output/src", &[]),
    (CALLS_C, &[]),
    ("crates/exchange/src", &[]),
    ("crates/cli/src", &["main.rs", "commands.rs", "commands/"]),
    ("studies/src", &["main.rs", "cli.rs", "cli/"]),
    ("fuzz/src", &["main.rs", "cli.rs"]),
];

/// One idea a file.
const MAX_LINES: usize = 700;

/// The text of every Rust file below `folder` of the repository, by its path there.
fn sources_in(folder: &str) -> BTreeMap<String, String> {
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut sources = BTreeMap::new();
    collect(&root, &root, &mut sources);
    sources
}

fn sources() -> BTreeMap<String, String> {
    sources_in("src")
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

/// The modules that a file names by `crate::` and `super::`, in braces, too, as paths below `src` without `.rs`.
fn named(file: &str, text: &str) -> BTreeSet<String> {
    let here: Vec<&str> = file.trim_end_matches(".rs").split('/').filter(|part| *part != "lib").collect();
    let text = code(text).map(|(_, line)| line).collect::<Vec<_>>().join("\n");
    let is_path = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    let mut named = BTreeSet::new();
    for (start, _) in text.match_indices("crate::").chain(text.match_indices("super::")) {
        if !text[..start].ends_with(is_path) {
            paths("", &text[start..], &mut |path| {
                let mut at = if path.starts_with("crate") { Vec::new() } else { here.clone() };
                for part in path.split("::") {
                    match part {
                        "crate" | "self" | "" => {}
                        "super" => drop(at.pop()),
                        part => at.push(part),
                    }
                }
                named.insert(at.join("/"));
            });
        }
    }
    named
}

/// Calls `found` with each path at the beginning of `text`, behind `prefix`, and returns its length.
fn paths(prefix: &str, text: &str, found: &mut dyn FnMut(&str)) -> usize {
    let end = text.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == ':')).unwrap_or(text.len());
    let path = format!("{prefix}{}", &text[..end]);
    if !(path.ends_with("::") && text[end..].starts_with('{')) {
        found(&path);
        return end;
    }
    let mut at = end + 1;
    while at < text.len() && !text[at..].starts_with('}') {
        let is_name = text[at..].starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        at += if is_name { paths(&path, &text[at..], found) } else { 1 };
        if let Some(renamed) = text[at..].strip_prefix(" as ") {
            at = text.len() - renamed.trim_start_matches(|c: char| c.is_ascii_alphanumeric() || c == '_').len();
        }
    }
    at + 1
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
        // Entries that use no other entry are removed, one after the other. The entries that remain have a circle.
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

/// Asserts that a package has none of [`NOWHERE`], no promise of a panic, no file that is too long, and each of `places` only there.
fn has_its_places(folder: &str, places: &[(&str, &[&str])]) {
    for (file, text) in sources_in(folder) {
        let lines = text.lines().count();
        assert!(lines <= MAX_LINES, "{folder}/{file}: {lines} lines");
        assert!(!text.contains("# Panics"), "{folder}/{file} promises a panic");
        for (line, code) in code(&text) {
            let at = line + 1;
            for what in NOWHERE {
                assert!(!code.contains(what), "{folder}/{file}:{at}: {what}");
            }
            for (what, places) in places.iter().filter(|(what, _)| code.contains(what)) {
                assert!(places.iter().any(|place| file.starts_with(place)), "{folder}/{file}:{at}: {what}");
            }
        }
    }
}

#[test]
fn everything_has_its_place() {
    has_its_places("src", PLACES);
    for (folder, printing) in PACKAGES {
        let everywhere: &[&str] = if *folder == CALLS_C { &[""] } else { &[] };
        has_its_places(
            folder,
            &[("unsafe", everywhere), ("print!", printing), ("println!", printing), ("std::net", &[])],
        );
    }
}

/// The judge of random runs shares nothing with the solvers and the error measure of the library.
#[test]
fn judges_share_nothing_with_solvers() {
    let solvers = ["algebra::linear", "solver::formulation", "solver::laws", "solver::events"];
    let names = ["Bn", "Condensed", "ConeSystem", "PredictorCorrector"];
    for (file, text) in sources_in("fuzz/src") {
        for (line, code) in code(&text) {
            let uses = solvers.iter().any(|solver| code.contains(&format!("stickslip::{solver}")));
            let named = code.split(|c: char| !c.is_alphanumeric()).any(|word| names.contains(&word));
            assert!(!uses && !named, "fuzz/src/{file}:{}: {code}", line + 1);
        }
    }
}

/// The searches see what they must: where these are at home they are found.
#[test]
fn the_searches_see() {
    let sources = sources();
    let circle = "use super::y::Y;\n// use crate::z;\n#[cfg(test)]\nmod tests {\n    use crate::w;\n}\nfn f() -> crate::a::B {}\n";
    assert_eq!(named("a/x.rs", circle), BTreeSet::from(["a/B".to_string(), "a/y/Y".to_string()]));
    let braces = "use super::{\n    b::{self, C as D},\n    e,\n};\n";
    assert_eq!(named("a/x.rs", braces), BTreeSet::from(["a/b", "a/b/C", "a/e"].map(String::from)));
    assert!(sources["algebra/linear/umfpack.rs"].contains("unsafe {"));
    assert!(sources.len() > 200 && ROOMS.iter().all(|(room, _)| sources.contains_key(&format!("{room}.rs"))));
}
