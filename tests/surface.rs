//! The public surface of the library: what a caller outside it can name. It changes on purpose only.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const LIST: &str = "tests/surface.txt";

/// Adds the public items of the module in `file` to `items`, and those of its public modules. `path` is its path.
fn collect(file: &Path, path: &str, items: &mut BTreeSet<String>) {
    let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
    let folder = if path.is_empty() { file.with_file_name("") } else { file.with_extension("") };
    let join = |name: &str| if path.is_empty() { name.to_string() } else { format!("{path}::{name}") };
    for statement in statements(&text) {
        if let Some(module) = statement.strip_prefix("pub mod ") {
            items.insert(format!("mod {}", join(module)));
            let inner: PathBuf = folder.join(format!("{module}.rs"));
            collect(&inner, &join(module), items);
        } else if let Some(tree) = statement.strip_prefix("pub use ") {
            let (_, names) = tree.rsplit_once("::").unwrap_or(("", tree));
            let names = names.split(['{', '}', ',']).map(str::trim).filter(|name| !name.is_empty());
            items.extend(names.map(|name| join(name.split(" as ").last().unwrap_or(name))));
        } else if let Some(item) = statement.strip_prefix("pub ") {
            let mut words = item.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
            let kinds = ["struct", "enum", "fn", "trait", "const", "static", "type"];
            let kind = words.by_ref().find(|word| kinds.contains(word));
            let name = words.find(|word| *word != "fn");
            if let (Some(_), Some(name)) = (kind, name) {
                items.insert(join(name));
            }
        }
    }
}

/// Returns the statements at the outermost level of a file, each on one line, up to its body.
fn statements(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod ").next().unwrap_or(text);
    let mut statements = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if !line.starts_with("pub ") {
            continue;
        }
        let mut statement = line.to_string();
        while line.starts_with("pub use") && !statement.ends_with(';') {
            statement.push_str(lines.next().unwrap_or(";").trim());
        }
        statements.push(statement.trim_end_matches([';', '{']).trim().to_string());
    }
    statements
}

/// The surface is the list in the file. To change it, run the test with `SURFACE=write` and look at the difference.
#[test]
fn the_public_surface_is_the_list() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut items = BTreeSet::new();
    collect(&root.join("src/lib.rs"), "", &mut items);
    let found = items.into_iter().collect::<Vec<_>>().join("\n") + "\n";
    if std::env::var("SURFACE").is_ok_and(|word| word == "write") {
        fs::write(root.join(LIST), &found).unwrap();
    }
    let listed = fs::read_to_string(root.join(LIST)).unwrap();
    let (found, listed): (BTreeSet<_>, BTreeSet<_>) = (found.lines().collect(), listed.lines().collect());
    let new: Vec<_> = found.difference(&listed).collect();
    let gone: Vec<_> = listed.difference(&found).collect();
    assert!(new.is_empty() && gone.is_empty(), "new: {new:?}, gone: {gone:?}; SURFACE=write writes {LIST}");
}
