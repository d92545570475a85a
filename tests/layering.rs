//! The layers of the library: who may use whom, and what may stand where.

#![allow(clippy::unwrap_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Every module of the library and the modules it uses: no more, and none that it does not use.
const MAY_USE: &[(&str, &[&str])] = &[
    ("fault", &[]),
    ("formula", &[]),
    ("sparse", &[]),
    ("null_space", &[]),
    ("sets", &[]),
    ("units", &[]),
    ("vector", &[]),
    ("timeline", &["fault"]),
    ("mesh", &["fault", "sets", "vector"]),
    ("problem", &["linear", "sparse", "units", "vector"]),
    ("loading", &["problem"]),
    ("solvability", &["null_space", "problem", "sets", "vector"]),
    ("fem", &["fault", "mesh", "null_space", "sparse", "vector"]),
    ("contact", &["fault", "fem", "formula", "loading", "mesh", "problem", "timeline", "vector"]),
    ("description", &["contact", "fault", "fem", "mesh", "timeline"]),
    ("formulation", &["contact", "null_space", "problem", "sparse", "units", "vector"]),
    ("linear", &["sets", "sparse", "vector"]),
    ("nonlinear", &["formulation", "linear", "sparse", "units"]),
    ("condense", &["linear", "loading", "problem", "sparse"]),
    ("uniqueness", &["contact", "formulation", "history", "linear", "problem", "units"]),
    (
        "history",
        &[
            "condense",
            "contact",
            "formulation",
            "linear",
            "loading",
            "nonlinear",
            "problem",
            "solvability",
            "sparse",
            "units",
            "vector",
        ],
    ),
    (
        "scene",
        &[
            "contact",
            "description",
            "fault",
            "fem",
            "formula",
            "formulation",
            "history",
            "linear",
            "mesh",
            "timeline",
            "vector",
        ],
    ),
    (
        "model",
        &[
            "contact",
            "description",
            "fault",
            "fem",
            "loading",
            "mesh",
            "problem",
            "scene",
            "sparse",
            "timeline",
            "units",
            "vector",
        ],
    ),
    ("auto", &["formulation", "history", "linear", "problem"]),
    (
        "report",
        &[
            "auto",
            "contact",
            "fem",
            "formulation",
            "history",
            "mesh",
            "model",
            "problem",
            "scene",
            "uniqueness",
            "vector",
        ],
    ),
    (
        "run",
        &[
            "auto",
            "contact",
            "formulation",
            "history",
            "linear",
            "model",
            "nonlinear",
            "problem",
            "report",
            "scene",
            "uniqueness",
        ],
    ),
    (
        "compare",
        &["contact", "history", "linear", "mesh", "model", "nonlinear", "problem", "report", "run", "scene", "vector"],
    ),
];

/// Where the program is, which uses the library as any other crate does.
const PROGRAM: [&str; 3] = ["main.rs", "cli.rs", "cli/"];
const MOST_LINES: usize = 400;

/// Paths below `src`, with `/`, and texts.
type Sources = BTreeMap<String, String>;

fn sources() -> Sources {
    fn collect(root: &Path, folder: &Path, into: &mut Sources) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(root, &path, into);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                into.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Sources::new();
    collect(&root, &root, &mut sources);
    sources
}

/// The lines that are compiled into the library or the program, with their numbers: neither
/// comments nor test modules, which end at the first brace in the first column.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_tests = false;
    text.lines().enumerate().filter_map(move |(k, line)| {
        let was_in_tests = in_tests;
        if line.starts_with("#[cfg(test)]") {
            in_tests = true;
        } else if in_tests && line == "}" {
            in_tests = false;
        }
        let skip = was_in_tests || in_tests || line.trim_start().starts_with("//");
        (!skip).then_some((k + 1, line))
    })
}

fn is_program(file: &str) -> bool {
    PROGRAM.iter().any(|part| file == *part || part.ends_with('/') && file.starts_with(part))
}

/// The module of the library that `file` belongs to.
fn module(file: &str) -> &str {
    file.split('/').next().unwrap().trim_end_matches(".rs")
}

/// The names that follow each `crate::` in `line`; an empty one for a group or a glob.
fn used(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices("crate::").map(|(at, prefix)| {
        let rest = &line[at + prefix.len()..];
        &rest[..rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(rest.len())]
    })
}

/// Uses of one module by another, with the place of the first, and what hides from this search.
fn uses(sources: &Sources) -> (BTreeMap<(&str, &str), String>, Vec<String>) {
    let (mut edges, mut faults) = (BTreeMap::new(), Vec::new());
    for (file, text) in sources.iter().filter(|(file, _)| *file != "lib.rs") {
        for (line, code) in code(text) {
            let place = format!("{file}:{line}");
            if is_program(file) {
                if used(code).next().is_some() {
                    faults.push(format!("{place}: the program has modules of its own for the library's"));
                }
                continue;
            }
            let up = if file.contains('/') { "super::super" } else { "super::" };
            if code.contains(up) {
                faults.push(format!("{place}: name the module by `crate::`"));
            }
            for name in used(code) {
                if name.is_empty() {
                    faults.push(format!("{place}: use one module at a time"));
                } else if name != module(file) {
                    edges.entry((module(file), name)).or_insert(place.clone());
                }
            }
        }
    }
    (edges, faults)
}

/// How `sources` and `table` differ.
fn layer_faults(sources: &Sources, table: &[(&str, &[&str])]) -> Vec<String> {
    let (edges, mut faults) = uses(sources);
    let allowed: BTreeSet<(&str, &str)> =
        table.iter().flat_map(|(user, list)| list.iter().map(move |used| (*user, *used))).collect();
    for (edge, place) in &edges {
        if !allowed.contains(edge) {
            faults.push(format!("{place}: `{}` may not use `{}`", edge.0, edge.1));
        }
    }
    for edge in allowed.iter().filter(|edge| !edges.contains_key(*edge)) {
        faults.push(format!("`{}` may use `{}`, but does not", edge.0, edge.1));
    }
    let modules: BTreeSet<&str> =
        sources.keys().filter(|file| *file != "lib.rs" && !is_program(file)).map(|file| module(file)).collect();
    let listed: BTreeSet<&str> = table.iter().map(|(user, _)| *user).collect();
    faults.extend(modules.symmetric_difference(&listed).map(|name| format!("`{name}` is only in the table or in src")));
    faults
}

/// The modules of `table` that are part of a cycle or use one that is.
fn cyclic<'a>(table: &[(&'a str, &[&str])]) -> Vec<&'a str> {
    let mut left = table.to_vec();
    loop {
        let names: Vec<&str> = left.iter().map(|(user, _)| *user).collect();
        let before = left.len();
        left.retain(|(_, list)| list.iter().any(|used| names.contains(used)));
        if left.len() == before {
            return names;
        }
    }
}

/// What stands where it must not.
fn place_faults(sources: &Sources) -> Vec<String> {
    let mut faults = Vec::new();
    for (file, text) in sources {
        if text.lines().count() > MOST_LINES {
            faults.push(format!("{file}: more than {MOST_LINES} lines"));
        }
        let linear = file.starts_with("linear/");
        for (line, code) in code(text) {
            let mut forbid = |what: &str, allowed: bool| {
                if code.contains(what) && !allowed {
                    faults.push(format!("{file}:{line}: {what}"));
                }
            };
            forbid("unsafe", linear);
            forbid("println!", is_program(file));
            forbid("print!", is_program(file));
            forbid("dbg!", false);
            forbid(".unwrap()", false);
            forbid("clap::", is_program(file));
            forbid("indicatif::", is_program(file));
            forbid("#[path", false);
        }
    }
    faults
}

#[test]
fn modules_use_what_is_below_them() {
    let faults = layer_faults(&sources(), MAY_USE);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_layers_have_no_cycle() {
    assert_eq!(cyclic(MAY_USE), [""; 0]);
    assert_eq!(cyclic(&[("a", &[]), ("b", &["a", "c"]), ("c", &["d"]), ("d", &["b"])]), ["b", "c", "d"]);
    assert_eq!(cyclic(&[("a", &["a"])]), ["a"]);
}

#[test]
fn everything_stands_where_it_may() {
    let faults = place_faults(&sources());
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_search_sees_the_whole_of_src() {
    let sources = sources();
    for file in ["lib.rs", "main.rs", "cli.rs", "cli/run.rs", "linear/umfpack.rs", "scene/read.rs"] {
        assert!(sources.contains_key(file), "{file} was not read");
    }
    // Where these are at home they are found, so their absence elsewhere means something.
    let anywhere = |what: &str| sources.values().any(|text| code(text).any(|(_, line)| line.contains(what)));
    assert!(["unsafe {", "writeln!", "clap::"].into_iter().all(anywhere));
    let declared: BTreeSet<&str> =
        sources["lib.rs"].lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert_eq!(declared, MAY_USE.iter().map(|(user, _)| *user).collect());
}

/// The search itself, on sources with one fault each.
#[test]
fn faults_are_found() {
    let source = |file: &str, text: &str| Sources::from([(file.to_string(), text.to_string())]);
    let table: &[(&str, &[&str])] = &[("a", &["b"])];
    let layers = |file: &str, text: &str| layer_faults(&source(file, text), table);
    assert_eq!(layers("a.rs", "use crate::b::{\n    B,\n};\n"), [""; 0]);
    assert_eq!(layers("a/x.rs", "use super::A;\nfn f() -> crate::b::B {}\n"), [""; 0]);
    assert_eq!(layers("a.rs", "use crate::b;\nuse crate::c::C;\n"), ["a.rs:2: `a` may not use `c`"]);
    assert_eq!(layers("a/x.rs", "let b = crate::b::f(crate::c::g());"), ["a/x.rs:1: `a` may not use `c`"]);
    assert_eq!(layers("a.rs", "use crate::{b, c};\nuse crate::b;\n"), ["a.rs:1: use one module at a time"]);
    assert_eq!(layers("a.rs", "use super::b;\nuse crate::b;\n"), ["a.rs:1: name the module by `crate::`"]);
    assert_eq!(layers("a/x.rs", "use super::super::c;\nuse crate::b;\n"), ["a/x.rs:1: name the module by `crate::`"]);
    assert_eq!(layers("a.rs", "// use crate::b;\n"), ["`a` may use `b`, but does not"]);
    assert_eq!(layers("z.rs", "").len(), 3);
    let tests = "use crate::b;\n#[cfg(test)]\nmod tests {\n    use crate::c;\n}\n";
    assert_eq!(layers("a.rs", tests), [""; 0]);
    assert_eq!(layers("a.rs", &[tests, "use crate::c;\n"].concat()), ["a.rs:6: `a` may not use `c`"]);

    for (file, text) in [
        ("mesh.rs", "unsafe { f() }"),
        ("linear.rs", "unsafe { f() }"),
        ("report/csv.rs", "    eprintln!(\"x\");"),
        ("history.rs", "print!(\"x\");"),
        ("cli/run.rs", "x.unwrap();"),
        ("scene.rs", "use clap::Parser;"),
        ("cli.rs", "#[path = \"../mesh.rs\"]"),
    ] {
        assert!(!place_faults(&source(file, text)).is_empty(), "{file}: {text}");
    }
    for (file, text) in [("linear/x.rs", "unsafe { f() }"), ("cli/run.rs", "println!();"), ("a.rs", "// unsafe")] {
        assert_eq!(place_faults(&source(file, text)), [""; 0]);
    }
    assert_eq!(place_faults(&source("a.rs", &"\n".repeat(MOST_LINES))), [""; 0]);
    assert_eq!(place_faults(&source("a.rs", &"\n".repeat(MOST_LINES + 1))), ["a.rs: more than 400 lines"]);
}
