//! Circles of files: within a folder the files use each other in one direction only, too.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Kind, Named, Sources, module, named};

/// The files that use each other in a circle, one line for each circle.
pub fn circles(sources: &Sources) -> Vec<String> {
    let uses = uses(sources);
    let reached: BTreeMap<&str, BTreeSet<&str>> = uses.keys().map(|file| (*file, reachable(&uses, file))).collect();
    let mut faults = BTreeSet::new();
    for (file, reaches) in &reached {
        let circle: Vec<&str> =
            reaches.iter().copied().filter(|other| reached.get(other).is_some_and(|back| back.contains(file))).collect();
        if !circle.is_empty() {
            faults.insert(format!("in a circle: {}", circle.join(", ")));
        }
    }
    faults.into_iter().collect()
}

/// The files of its own module that each file uses.
fn uses(sources: &Sources) -> BTreeMap<&str, BTreeSet<&str>> {
    let tree = Tree::new(sources);
    let mut uses: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (file, paths) in &tree.named {
        // What a file only passes on to others it does not use.
        let files = paths.iter().filter(|path| path.kind != Kind::Export).filter_map(|path| tree.file(file, path));
        uses.entry(file).or_default().extend(files.filter(|other| other != file && module(other) == module(file)));
    }
    uses
}

/// The files reached from `file` in one step or more.
fn reachable<'a>(uses: &BTreeMap<&'a str, BTreeSet<&'a str>>, file: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = uses[file].iter().copied().collect();
    while let Some(next) = open.pop() {
        if reached.insert(next) {
            open.extend(uses.get(next).into_iter().flatten());
        }
    }
    reached
}

/// The tree of modules, and what each passes on.
struct Tree<'a> {
    /// The file of each module, by the path of the module.
    files: BTreeMap<Vec<String>, &'a str>,
    named: BTreeMap<&'a str, Vec<Named>>,
}

impl<'a> Tree<'a> {
    fn new(sources: &'a Sources) -> Self {
        let files = sources.keys().map(|file| (module_path(file), file.as_str())).collect();
        Tree { files, named: sources.iter().map(|(file, text)| (file.as_str(), named(text))).collect() }
    }

    /// The file that declares what `path` names in `file`, none if that is outside.
    fn file(&self, file: &str, path: &Named) -> Option<&'a str> {
        self.declared(module_path(file), &path.segments, 0)
    }

    fn declared(&self, mut at: Vec<String>, path: &[String], depth: usize) -> Option<&'a str> {
        let mut rest = path.iter().peekable();
        match rest.peek()?.as_str() {
            "crate" => at.clear(),
            "super" | "self" => {}
            first if self.files.contains_key(&[at.as_slice(), &[first.to_string()]].concat()) => {}
            _ => return None,
        }
        for segment in rest {
            match segment.as_str() {
                "crate" | "self" => {}
                "super" => drop(at.pop()?),
                name => {
                    let child = [at.as_slice(), &[name.to_string()]].concat();
                    if self.files.contains_key(&child) {
                        at = child;
                    } else {
                        return self.passed_on(&at, name, depth).or_else(|| self.files.get(&at).copied());
                    }
                }
            }
        }
        self.files.get(&at).copied()
    }

    /// The file that declares what the module `at` passes on as `name`.
    fn passed_on(&self, at: &[String], name: &str, depth: usize) -> Option<&'a str> {
        // A circle of re-exports does not compile; the bound only ends the search of a text that is none.
        let exports = self.named.get(self.files.get(at)?)?.iter().filter(|_| depth < 8);
        let export = exports.filter(|path| path.kind != Kind::Inline).find(|path| path.segments.last().unwrap() == name);
        self.declared(at.to_vec(), &export?.segments, depth + 1)
    }
}

fn module_path(file: &str) -> Vec<String> {
    let path = file.trim_end_matches(".rs");
    if ["lib", "main"].contains(&path) { Vec::new() } else { path.split('/').map(String::from).collect() }
}
