//! What comes from outside: other crates and the parts of `std` that reach out of the process.

use std::collections::BTreeSet;
use std::path::Path;

use crate::source::{Sources, named};

/// A crate or a part of one, and the files and folders (with `/`) that alone may name it; all, where none stands.
pub type Places = (&'static str, &'static [&'static str]);

const NOWHERE: &str = "nowhere";

/// Every crate that the library and its program depend on, and what of `std` acts on the outside.
pub const LIBRARY: &[Places] = &[
    ("base64", &["report/vtu.rs"]),
    ("clap", &["cli.rs", "cli/"]),
    ("clap_complete", &["cli/shell.rs"]),
    ("clap_mangen", &["cli/shell.rs"]),
    ("crc32fast", &["checkpoint.rs"]),
    (
        "faer",
        &[
            "events/coordinates.rs",
            "events/dictionary.rs",
            "linear/",
            "local/factors.rs",
            "problem/contact_stiffness.rs",
            "uniqueness.rs",
        ],
    ),
    ("indicatif", &["cli/progress.rs"]),
    ("libc", &["linear/blas/room.rs", "linear/process.rs", "linear/process/allocator.rs"]),
    ("libloading", &["linear/blas/loaded.rs", "linear/blas/room.rs", "linear/process.rs", "linear/versions.rs"]),
    (
        "miette",
        &[
            "cli.rs",
            "cli/",
            "compare.rs",
            "input_error.rs",
            "mesh/gmsh.rs",
            "mesh/source.rs",
            "model.rs",
            "run/error.rs",
            "scene/error.rs",
        ],
    ),
    ("miniz_oxide", &["exchange/hdf5/chunks.rs"]),
    // Cargo.toml has these three for their features only.
    ("num_complex", &[NOWHERE]),
    ("num_traits", &[NOWHERE]),
    ("once_cell", &[NOWHERE]),
    ("pulp", &["linear/cholesky/sweep.rs", "sparse/simd.rs"]),
    ("rayon", &[]),
    ("rmp_serde", &["checkpoint.rs"]),
    ("rustix", &["report/folder/directory.rs", "report/usage.rs"]),
    (
        "schemars",
        &[
            "auto.rs",
            "laws/kkt.rs",
            "contact/range.rs",
            "estimate/",
            "events.rs",
            "exchange/",
            "history/increment_error.rs",
            "history/record.rs",
            "history/working_set.rs",
            "linear/blas.rs",
            "report/",
            "uniqueness.rs",
        ],
    ),
    ("serde", &[]),
    (
        "serde_json",
        &["cli/", "exchange/schema.rs", "report/lists.rs", "report/quantities.rs", "report/run.rs", "report/schema.rs"],
    ),
    ("signal_hook", &["cli/interrupt.rs", "cli/memory.rs"]),
    ("thiserror", &[]),
    ("toml", &["scene/"]),
    ("toml_edit", &["compare/mesh.rs", "scene/"]),
    // What OpenBLAS has read there is part of what it is.
    ("std::env", &["cli.rs", "cli/", "linear/blas/loaded.rs"]),
    (
        "std::fs",
        &[
            "cli/",
            "input.rs",
            "linear/blas/loaded.rs",
            "linear/blas/room.rs",
            "memory.rs",
            "report/folder/",
            "report/lists.rs",
        ],
    ),
    ("std::net", &[NOWHERE]),
    ("std::panic", &["cli/bug.rs", "jobs.rs"]),
    ("std::process", &["main.rs", "cli.rs", "cli/"]),
    ("std::thread", &["cli/sweep/processes.rs", "cli/threads.rs", "jobs.rs", "linear/blas/room.rs"]),
];

/// The same of the studies, which use the library as any other crate does.
pub const STUDIES: &[Places] = &[
    ("clap", &["cli.rs", "cli/", "extremes.rs", "tables.rs"]),
    ("indicatif", &["cli/jobs.rs"]),
    ("miette", &["cli.rs", "cli/", "extremes.rs", "tables.rs"]),
    ("serde", &[]),
    ("serde_json", &["cli/", "warnings.rs"]),
    ("stickslip", &[]),
    ("thiserror", &[]),
    ("toml", &["extremes.rs"]),
    ("toml_edit", &["tables.rs"]),
    ("std::env", &[NOWHERE]),
    ("std::fs", &["cli.rs"]),
    ("std::net", &[NOWHERE]),
    ("std::panic", &[NOWHERE]),
    ("std::process", &["main.rs", "cli.rs"]),
    ("std::thread", &["cli/jobs.rs"]),
    // The numbers come through the door of the library, not from its solvers; few files need words of these.
    ("stickslip::condense", &[NOWHERE]),
    ("stickslip::formulation", &["extremes/vary.rs"]),
    ("stickslip::nonlinear", &["figures.rs"]),
    ("stickslip::problem", &["extremes/vary.rs"]),
    ("stickslip::sparse", &[NOWHERE]),
];

/// The same of the fuzzing. What judges a run has the numbers of the problem, and nothing of what solves it.
pub const FUZZ: &[Places] = &[
    ("clap", &["cli.rs"]),
    ("miette", &["readers.rs"]),
    ("rustix", &["pool.rs"]),
    ("serde_json", &["corpus.rs", "readers/results.rs"]),
    ("stickslip", &[]),
    ("std::env", &["readers/tables.rs"]),
    ("std::fs", &["corpus.rs", "readers/tables.rs"]),
    ("std::net", &[NOWHERE]),
    ("std::panic", &["pool.rs"]),
    ("std::process", &["main.rs", "cli.rs", "readers/tables.rs"]),
    ("std::thread", &["pool.rs", "readers/tables.rs"]),
    ("stickslip::condense", &[NOWHERE]),
    ("stickslip::formulation", &[NOWHERE]),
    ("stickslip::linear", &[NOWHERE]),
    ("stickslip::nonlinear", &[NOWHERE]),
    ("stickslip::problem", &["runs/laws.rs"]),
    ("stickslip::sparse", &["readers/tables.rs", "runs/laws.rs"]),
];

/// Where `sources` name what stands elsewhere in `table`, and what of the table no file names.
pub fn outside_faults(sources: &Sources, table: &[Places]) -> BTreeSet<String> {
    let mut faults = BTreeSet::new();
    let mut met = BTreeSet::new();
    for (file, text) in sources {
        for path in named(text) {
            let is = |what: &str| what.split("::").eq(path.segments.iter().take(what.split("::").count()));
            for (what, places) in table.iter().filter(|(what, _)| is(what)) {
                let at_home = |place: &&&str| *file == **place || place.ends_with('/') && file.starts_with(**place);
                match places.iter().find(at_home) {
                    Some(place) => drop(met.insert((*what, *place))),
                    None if places.is_empty() => {}
                    None => drop(faults.insert(format!("{file}:{}: `{what}` is not for this file", path.line))),
                }
            }
        }
    }
    for (what, places) in table {
        let idle = places.iter().filter(|place| **place != NOWHERE && !met.contains(&(*what, **place)));
        faults.extend(idle.map(|place| format!("{place} may name `{what}`, but does not")));
    }
    faults
}

/// The crates of `table`.
pub fn crates(table: &[Places]) -> BTreeSet<String> {
    table.iter().filter(|(what, _)| !what.contains("::")).map(|(what, _)| (*what).to_string()).collect()
}

/// The crates that `manifest` names for the library and the program themselves, as the code writes them.
pub fn dependencies(manifest: &str) -> BTreeSet<String> {
    let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(manifest)).unwrap();
    let lines =
        text.lines().skip_while(|line| *line != "[dependencies]").skip(1).take_while(|line| !line.starts_with('['));
    lines.filter_map(|line| Some(line.split_once(" = ")?.0.replace('-', "_"))).collect()
}
