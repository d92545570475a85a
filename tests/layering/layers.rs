//! The layers of the library: which module may use which.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Sources, code, is_program, module};

/// Every module of the library and the modules it uses: no more, and none that it does not use.
pub const MAY_USE: &[(&str, &[&str])] = &[
    ("checkpoint", &[]),
    ("input_error", &[]),
    ("formula", &[]),
    ("input", &[]),
    ("memory", &[]),
    ("null_space", &[]),
    ("union_find", &[]),
    ("units", &[]),
    ("vector", &[]),
    ("sparse", &["vector"]),
    ("timeline", &["input_error"]),
    ("mesh", &["input_error", "input", "union_find", "vector"]),
    ("problem", &["linear", "union_find", "sparse", "units", "vector"]),
    ("loading", &["problem", "timeline"]),
    ("laws", &["problem"]),
    ("solvability", &["null_space", "problem", "union_find", "sparse", "vector"]),
    ("fem", &["input_error", "mesh", "null_space", "union_find", "sparse", "units", "vector"]),
    ("contact", &["input_error", "fem", "formula", "input", "loading", "mesh", "timeline", "vector"]),
    ("description", &["contact", "input_error", "fem", "formula", "mesh", "timeline", "units", "vector"]),
    ("formulation", &["laws", "null_space", "problem", "sparse", "units", "vector"]),
    ("linear", &["union_find", "sparse", "vector"]),
    ("jobs", &["linear"]),
    ("local", &["linear", "union_find", "sparse", "vector"]),
    ("nonlinear", &["formulation", "linear", "sparse", "units"]),
    ("condense", &["linear", "loading", "problem", "sparse"]),
    (
        "events",
        &[
            "formulation",
            "laws",
            "linear",
            "loading",
            "problem",
            "union_find",
            "solvability",
            "sparse",
            "units",
            "vector",
        ],
    ),
    (
        "history",
        &[
            "checkpoint",
            "condense",
            "events",
            "formulation",
            "laws",
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
    ("uniqueness", &["formulation", "history", "laws", "linear", "null_space", "problem", "units"]),
    (
        "scene",
        &[
            "contact",
            "description",
            "input_error",
            "fem",
            "formula",
            "formulation",
            "history",
            "input",
            "linear",
            "mesh",
            "timeline",
            "units",
            "vector",
        ],
    ),
    (
        "model",
        &[
            "contact",
            "description",
            "input_error",
            "fem",
            "laws",
            "linear",
            "loading",
            "mesh",
            "problem",
            "scene",
            "union_find",
            "sparse",
            "timeline",
            "units",
            "vector",
        ],
    ),
    ("initial_working_set", &["linear", "loading", "problem"]),
    ("auto", &["formulation", "history", "linear", "memory", "problem", "initial_working_set"]),
    ("estimate", &["contact", "description", "fem", "laws", "mesh", "model", "problem", "union_find", "vector"]),
    (
        "report",
        &[
            "auto",
            "checkpoint",
            "contact",
            "description",
            "estimate",
            "events",
            "input_error",
            "fem",
            "formulation",
            "history",
            "laws",
            "linear",
            "memory",
            "mesh",
            "model",
            "problem",
            "scene",
            "uniqueness",
            "units",
            "vector",
        ],
    ),
    (
        "exchange",
        &[
            "input_error",
            "history",
            "input",
            "laws",
            "linear",
            "loading",
            "local",
            "memory",
            "problem",
            "report",
            "sparse",
        ],
    ),
    (
        "run",
        &[
            "auto",
            "checkpoint",
            "events",
            "formulation",
            "history",
            "laws",
            "linear",
            "memory",
            "model",
            "nonlinear",
            "problem",
            "initial_working_set",
            "report",
            "scene",
            "timeline",
            "uniqueness",
            "vector",
        ],
    ),
    ("sweep", &["report", "scene", "units"]),
    (
        "compare",
        &[
            "checkpoint",
            "contact",
            "estimate",
            "fem",
            "formulation",
            "history",
            "jobs",
            "linear",
            "mesh",
            "model",
            "nonlinear",
            "problem",
            "report",
            "run",
            "scene",
            "units",
            "vector",
        ],
    ),
];

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
            let up = if file.contains('/') { "super::super::" } else { "super::" };
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
pub fn layer_faults(sources: &Sources, table: &[(&str, &[&str])]) -> Vec<String> {
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
pub fn cyclic<'a>(table: &[(&'a str, &[&str])]) -> Vec<&'a str> {
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
