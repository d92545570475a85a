//! The origin of a result: the text of the scene, the files that the scene names, and the program.

use std::io;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Scene;
use crate::base::input;

/// The offset and the prime of the hash FNV-1a of 128 bits.
const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

/// The scene, files and program that a result was computed from.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    program: String,
    /// The scene, overrides included.
    text: String,
    /// The files that the scene names, each with a hash of its content.
    files: Vec<(PathBuf, String)>,
}

impl Provenance {
    /// Creates the origin of results of `scene` computed by `program`.
    ///
    /// # Errors
    /// The file that cannot be read, and the reason.
    pub fn new(scene: &Scene, program: &str) -> Result<Self, (PathBuf, io::Error)> {
        let hashed = |file: PathBuf| match input::read_bytes(&file) {
            Ok(bytes) => Ok((file, hash([&bytes[..]]))),
            Err(error) => Err((file, error)),
        };
        let files = scene.files().into_iter().map(hashed).collect::<Result<_, _>>()?;
        Ok(Provenance { program: program.to_string(), text: scene.text().to_string(), files })
    }

    /// Returns 32 hexadecimal digits that change with any part of the origin.
    pub fn fingerprint(&self) -> String {
        let files = self.files.iter().map(|(_, hash)| hash.as_bytes());
        hash([self.program.as_bytes(), self.text.as_bytes()].into_iter().chain(files))
    }

    /// Returns the fingerprint of the named `part` of the results.
    pub fn fingerprint_of(&self, part: &str) -> String {
        hash([self.fingerprint().as_bytes(), part.as_bytes()])
    }

    /// Describes the changes since `earlier`, one entry for each; empty without changes.
    pub fn changes_since(&self, earlier: &Provenance) -> Vec<String> {
        let mut changes = Vec::new();
        if self.program != earlier.program {
            changes.push(format!("stickslip was {}, and is {}", earlier.program, self.program));
        }
        // Empty lines come and go with tables that overrides add.
        let [before, after] = [earlier, self].map(|of| {
            let lines = of.text.lines().map(str::trim).enumerate();
            lines.filter(|(_, line)| !line.is_empty()).collect::<Vec<_>>()
        });
        let k = before.iter().zip(&after).take_while(|(before, after)| before.1 == after.1).count();
        let lines = [before.get(k), after.get(k)];
        if let Some((number, _)) = lines[1].or(lines[0]) {
            let quoted =
                |line: Option<&(usize, &str)>| line.map_or("nothing".to_string(), |(_, line)| format!("`{line}`"));
            let [before, after] = lines.map(quoted);
            changes.push(format!("line {} of the scene was {before}, and is {after}", number + 1));
        }
        for (file, hash) in &self.files {
            if !earlier.files.iter().any(|(_, before)| before == hash) {
                changes.push(format!("the content of {} is another", file.display()));
            }
        }
        changes
    }
}

/// Computes the hash of a list of byte strings. The length of each is hashed before its content, so that different
/// lists of strings are different inputs.
fn hash<'a>(of: impl IntoIterator<Item = &'a [u8]>) -> String {
    let mut hash = OFFSET;
    for bytes in of {
        for &byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(PRIME);
        }
    }
    format!("{hash:032x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "mesh = { kind = 'gmsh', file = 'bar.msh' }
        material = { young = 1e9, poisson = 0.3 }
        support = [{ boundary = 'left', fix = ['x', 'y'] }]
        time = { end = 1, increments = 1 }";

    #[test]
    fn it_changes_with_all_that_it_is_of() {
        let folder = std::env::temp_dir().join(format!("stickslip-origin-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = folder.join("scene.toml").display().to_string();
        let of =
            |text: &str, program: &str| Provenance::new(&Scene::parse(&name, text, &[]).unwrap(), program).unwrap();
        let mesh = |content: &str| std::fs::write(folder.join("bar.msh"), content).unwrap();
        mesh("one");
        let first = of(TEXT, "0.1");
        assert_eq!((of(TEXT, "0.1").fingerprint(), first.fingerprint().len()), (first.fingerprint(), 32));
        assert!(of(TEXT, "0.1").changes_since(&first).is_empty());
        let changed = |now: &Provenance, words: &[&str]| {
            assert_ne!(now.fingerprint(), first.fingerprint());
            let changes = now.changes_since(&first);
            assert_eq!(changes.len(), words.len(), "{changes:?}");
            assert!(changes.iter().zip(words).all(|(change, words)| change.contains(words)), "{changes:?}");
        };
        changed(
            &of(&TEXT.replace("0.3", "0.2"), "0.1"),
            &["line 2 of the scene was `material = { young = 1e9, poisson = 0.3 }`"],
        );
        changed(&of(TEXT, "0.2"), &["stickslip was 0.1, and is 0.2"]);
        mesh("two");
        changed(&of(TEXT, "0.1"), &["bar.msh is another"]);
        mesh("one");
        assert_eq!(of(TEXT, "0.1"), first);
        std::fs::remove_dir_all(&folder).unwrap();
        assert_eq!(
            Provenance::new(&Scene::parse(&name, TEXT, &[]).unwrap(), "0.1").unwrap_err().0,
            folder.join("bar.msh")
        );
    }
}
