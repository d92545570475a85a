//! Circles of files: in a folder, too, the files use each other in one direction only.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::{Kind, Named, Sources, named};

type Uses<'a> = BTreeMap<&'a str, BTreeSet<&'a str>>;

/// The entries of one folder that use each other in a circle, one line for each circle. An entry is a file with the
/// folder of its name. The file above a folder is no part of it: it may call the files and hold what they share.
pub fn circles(sources: &Sources) -> Vec<String> {
    let mut folders: BTreeMap<&str, Uses> = BTreeMap::new();
    for (user, used) in uses(sources) {
        let Some((folder, user, used)) = entries(user, used) else { continue };
        let uses = folders.entry(folder).or_default();
        uses.entry(user).or_default().insert(used);
    }
    let mut faults = BTreeSet::new();
    for (folder, uses) in folders.iter().filter(|(folder, _)| !folder.is_empty()) {
        let reached: Uses = uses.keys().map(|entry| (*entry, reachable(uses, entry))).collect();
        for (entry, reaches) in &reached {
            let back = |other: &&&str| reached.get(*other).is_some_and(|reaches| reaches.contains(entry));
            let circle: Vec<&str> = reaches.iter().filter(back).copied().collect();
            if !circle.is_empty() {
                faults.insert(format!("{folder}: {} use each other in a circle", circle.join(", ")));
            }
        }
    }
    faults.into_iter().collect()
}

/// The innermost folder that holds both files, and the different entries of it that they belong to.
fn entries<'a>(user: &'a str, used: &'a str) -> Option<(&'a str, &'a str, &'a str)> {
    let [user, used] = [user, used].map(|file| file.trim_end_matches(".rs"));
    let same = user.split('/').zip(used.split('/')).take_while(|(a, b)| a == b);
    let length: usize = same.map(|(part, _)| part.len() + 1).sum();
    // One of the two is above the folder of the other where nothing of its path is left.
    let entry = |file: &'a str| file.get(length..)?.split('/').next();
    Some((&user[..length.saturating_sub(1)], entry(user)?, entry(used)?))
}

/// Which file uses which.
fn uses(sources: &Sources) -> Vec<(&str, &str)> {
    let tree = Tree::new(sources);
    let mut uses = Vec::new();
    for (file, paths) in &tree.named {
        // What a file only passes on to others it does not use.
        let files = paths.iter().filter(|path| path.kind != Kind::Export).filter_map(|path| tree.file(file, path));
        uses.extend(files.filter(|other| other != file).map(|other| (*file, other)));
    }
    uses
}

/// The entries reached from `entry` in one step or more.
fn reachable<'a>(uses: &Uses<'a>, entry: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = uses[entry].iter().copied().collect();
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
        let export =
            exports.filter(|path| path.kind != Kind::Inline).find(|path| path.segments.last().unwrap() == name);
        self.declared(at.to_vec(), &export?.segments, depth + 1)
    }
}

fn module_path(file: &str) -> Vec<String> {
    let path = file.trim_end_matches(".rs");
    if ["lib", "main"].contains(&path) { Vec::new() } else { path.split('/').map(String::from).collect() }
}
