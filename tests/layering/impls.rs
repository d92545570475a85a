//! Inherent methods stand in the module of their type.

use std::collections::BTreeSet;

use crate::source::{Kind, Sources, code, module, named};

/// Inherent `impl`s for types of another top-level module.
pub fn foreign_impls(sources: &Sources) -> Vec<String> {
    let declared: BTreeSet<(&str, &str)> = sources
        .iter()
        .flat_map(|(file, text)| code(text).filter_map(move |(_, line)| Some((module(file), declares(line)?))))
        .collect();
    let mut faults = Vec::new();
    for (file, text) in sources {
        let paths = named(text);
        for (line, code) in code(text) {
            let Some(path) = inherent(code) else { continue };
            let name = path.rsplit("::").next().unwrap();
            // The type may be imported beside one of this module that has the same name.
            let imported = path.contains("crate::")
                || paths.iter().filter(|path| path.kind != Kind::Inline).any(|path| {
                    let elsewhere = path.segments[0] == "crate" && path.segments[1] != module(file);
                    elsewhere && path.segments.last().unwrap() == name
                });
            if imported || !declared.contains(&(module(file), name)) {
                faults.push(format!("{file}:{line}: methods of `{name}` outside its module"));
            }
        }
    }
    faults
}

/// The type that a line declares.
fn declares(line: &str) -> Option<&str> {
    // The visibility may be `pub(in crate::a)`.
    let bare = if line.starts_with("pub(") { line.split_once(") ")?.1 } else { line.trim_start_matches("pub ") };
    let mut words = bare.split_whitespace();
    let keyword = words.next()?;
    let name = words.next().filter(|_| ["struct", "enum", "union", "type", "trait"].contains(&keyword))?;
    name.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next()
}

/// The path of the type whose own methods begin with `line`.
fn inherent(line: &str) -> Option<&str> {
    let rest = line.strip_prefix("impl")?;
    // `impl<T: A<B>> Type`: the parameters end where their brackets close.
    let mut depth = 0;
    let end = rest.find(|c| {
        depth += i32::from(c == '<') - i32::from(c == '>');
        c == ' ' && depth == 0
    })?;
    let header = rest[end..].split(" where ").next()?.trim_start();
    let path = header.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_' || c == ':')).next()?;
    (!header.contains(" for ") && !path.is_empty()).then_some(path)
}
