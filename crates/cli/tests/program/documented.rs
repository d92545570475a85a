//! Commands in the documentation and the help can be typed as printed.

#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use crate::program::{stdout, stickslip};

/// Returns the pages of the root and of doc.
pub fn pages() -> Vec<(PathBuf, String)> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut pages = Vec::new();
    add_pages(&root.join("doc"), &mut pages);
    let pages = pages.into_iter().chain(["README.md", "CONTRIBUTING.md", "SECURITY.md"].map(|page| root.join(page)));
    pages.map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// Adds the pages of a folder.
fn add_pages(folder: &Path, pages: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if path.is_dir() {
            add_pages(&path, pages);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            pages.push(path);
        }
    }
}

/// A shell such as zsh takes brackets for a file name pattern, and stops if there is no such file.
#[test]
fn brackets_are_quoted() {
    let helps = ["run", "check", "compare"].map(|command| {
        let output = stickslip(&[command, "--help"]);
        (PathBuf::from(command), stdout(&output).to_string())
    });
    for (page, text) in pages().into_iter().chain(helps) {
        for line in text.lines().filter(|line| line.contains("--set ") || line.contains("e.g. ")) {
            let bare = line.split(' ').find(|word| {
                let word = word.trim_start_matches('`');
                word.contains('=') && word.contains('[') && word.starts_with(|c: char| c.is_ascii_alphabetic())
            });
            assert_eq!(bare, None, "{}: {line}", page.display());
        }
    }
}

/// Links to pages, scenes and pictures are valid.
#[test]
fn links_lead_to_files() {
    for (page, text) in pages() {
        for link in text.split("](").skip(1).filter_map(|rest| rest.split([')', '#', ' ']).next()) {
            let there = link.is_empty() || link.starts_with("http") || page.parent().unwrap().join(link).exists();
            assert!(there, "{}: {link}", page.display());
        }
    }
}

/// With `-save`, Gmsh writes its input whatever the other options: a mesh for a mesh, but no mesh for a geometry.
#[test]
fn gmsh_is_told_to_make_a_mesh() {
    let all = pages();
    let words = all.iter().flat_map(|(_, text)| text.lines()).flat_map(|line| line.split('`'));
    let said = words.filter(|words| words.contains("-format msh41"));
    assert!(
        said.clone().count() > 0 && said.clone().all(|words| !words.contains("-save") || !words.contains(".geo")),
        "{:?}",
        said.collect::<Vec<_>>()
    );
}

/// A command that a page promises has a row in the table of runs.
#[test]
fn commands_of_the_makefile_have_a_verdict() {
    let proved = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../doc/method/proved.md")).unwrap();
    let mut count = 0;
    for (page, text) in pages() {
        let spans = text.split('`').skip(1).step_by(2);
        let commands = text.lines().chain(spans).filter_map(|line| line.strip_prefix("make "));
        for command in commands.filter_map(|line| line.split([' ', '`']).next()) {
            // A part of another command, or the command that writes the table.
            let part = ["book", "wheel", "compare", "everything"].contains(&command);
            assert!(part || proved.contains(&format!("\n| `make {command}` |")), "{}: make {command}", page.display());
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}
