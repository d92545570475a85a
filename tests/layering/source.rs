//! Sources as text: which lines count, and the paths that they name.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Paths below the folder read, with `/`, and texts.
pub type Sources = BTreeMap<String, String>;

/// The Rust files below `folder` of the project.
pub fn sources(folder: &str) -> Sources {
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut sources = Sources::new();
    collect(&root, &root, &mut sources);
    sources
}

/// A source of one file, for the tests of the searches.
pub fn source(file: &str, text: &str) -> Sources {
    Sources::from([(file.to_string(), text.to_string())])
}

/// The lines that are compiled into the library or the program, with their numbers: neither
/// comments nor test modules, which end at the first brace in the first column.
pub fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut in_tests = false;
    text.lines().enumerate().filter_map(move |(k, line)| {
        let was_in_tests = in_tests;
        if line.starts_with("#[cfg(test)]") || line.starts_with("#[cfg(all(test,") {
            in_tests = true;
        } else if in_tests && line == "}" {
            in_tests = false;
        }
        let skip = was_in_tests || in_tests || line.trim_start().starts_with("//");
        (!skip).then_some((k + 1, line))
    })
}

/// Where the programs are, which use their libraries as any other crate does.
pub fn is_program(file: &str) -> bool {
    ["main.rs", "cli.rs"].contains(&file) || file.starts_with("cli/")
}

/// The top-level module that `file` belongs to.
pub fn module(file: &str) -> &str {
    file.split('/').next().unwrap().trim_end_matches(".rs")
}

/// A path with `::` in the code, without what it is renamed to.
pub struct Named {
    pub line: usize,
    pub kind: Kind,
    pub segments: Vec<String>,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    /// `use`, for this file.
    Import,
    /// `pub use`, for others: the file itself need not use it.
    Export,
    Inline,
}

/// All paths that the code of `text` names; groups are written out.
pub fn named(text: &str) -> Vec<Named> {
    let mut found = Vec::new();
    let mut lines = code(text);
    while let Some((line, first)) = lines.next() {
        let Some((kind, start)) = import(first) else {
            let paths = inline(first).into_iter();
            found.extend(paths.map(|segments| Named { line, kind: Kind::Inline, segments }));
            continue;
        };
        let mut statement = start.to_string();
        while !statement.contains(';') {
            let Some((_, more)) = lines.next() else { break };
            statement.push_str(more.trim());
        }
        let paths = written_out(statement.split(';').next().unwrap()).into_iter();
        found.extend(paths.map(|path| Named { line, kind, segments: segments(&path) }));
    }
    found
}

/// What a line that begins a `use` declares, without its `use`.
fn import(line: &str) -> Option<(Kind, &str)> {
    let line = line.trim_start();
    if let Some(rest) = line.strip_prefix("use ") {
        return Some((Kind::Import, rest));
    }
    let (visibility, rest) = line.split_once("use ")?;
    let public = visibility == "pub " || visibility.starts_with("pub(") && visibility.ends_with(") ");
    public.then_some((Kind::Export, rest))
}

/// The paths of a `use` tree.
fn written_out(tree: &str) -> Vec<String> {
    let Some((prefix, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap().trim().to_string()];
    };
    let group = &rest[..rest.rfind('}').unwrap_or(rest.len())];
    let (mut depth, mut from, mut paths) = (0_i32, 0, Vec::new());
    for (at, c) in group.char_indices().chain([(group.len(), ',')]) {
        depth += i32::from(c == '{') - i32::from(c == '}');
        if c == ',' && depth == 0 {
            let part = group[from..at].trim();
            from = at + 1;
            if !part.is_empty() {
                paths.extend(written_out(part).into_iter().map(|path| format!("{}{path}", prefix.trim())));
            }
        }
    }
    paths
}

/// The segments of `path`; `a::self` is `a`.
fn segments(path: &str) -> Vec<String> {
    let mut segments: Vec<String> = path.split("::").filter(|segment| !segment.is_empty()).map(String::from).collect();
    if segments.len() > 1 && segments.last().is_some_and(|last| last == "self") {
        segments.pop();
    }
    segments
}

/// The paths of two segments or more in a line that is no `use`.
fn inline(line: &str) -> Vec<Vec<String>> {
    let part_of_path = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == ':';
    // `a::<T>` and `a: T` leave colons at an end.
    let words = line.split(|c: char| !part_of_path(c)).map(|word| word.trim_end_matches(':'));
    words.filter(|word| word.contains("::")).map(segments).collect()
}
