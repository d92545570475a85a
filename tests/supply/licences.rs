//! The licences of what is built into the program on this platform.

use std::collections::BTreeSet;
use std::process::Command;

use serde::Deserialize;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Licences {
    /// By their SPDX names; what is under them may be passed on with what is under ours.
    permitted: BTreeSet<String>,
    /// The C libraries that the feature `umfpack` links.
    pub linked: Vec<Linked>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Linked {
    pub library: String,
    #[serde(rename = "licence")]
    _licence: String,
}

impl Licences {
    pub fn read() -> Self {
        Self::of(include_str!("licences.toml"))
    }

    pub fn of(text: &str) -> Self {
        toml::from_str(text).unwrap()
    }

    /// Packages, with their licences, none of which is permitted.
    pub fn faults(&self, packages: &[(String, Option<String>)]) -> Vec<String> {
        let fault = |(name, licence): &(String, Option<String>)| match licence {
            Some(licence) if self.permits(licence) => None,
            Some(licence) => Some(format!("{name} is under {licence}")),
            None => Some(format!("{name} does not tell its licence")),
        };
        packages.iter().filter_map(fault).collect()
    }

    /// Whether the SPDX expression leaves a choice that is permitted. A `/` is how `OR` was once written.
    fn permits(&self, expression: &str) -> bool {
        let spaced = expression.replace('/', " OR ").replace('(', " ( ").replace(')', " ) ");
        let words: Vec<_> = spaced.split_whitespace().collect();
        matches!(self.any(&words), Some((permitted, [])) if permitted)
    }

    /// Alternatives, and the words after them; none where the expression cannot be read.
    fn any<'a, 'b>(&self, words: &'a [&'b str]) -> Option<(bool, &'a [&'b str])> {
        let (mut permitted, mut rest) = self.all(words)?;
        while let ["OR", after @ ..] = rest {
            let (next, after) = self.all(after)?;
            (permitted, rest) = (permitted || next, after);
        }
        Some((permitted, rest))
    }

    fn all<'a, 'b>(&self, words: &'a [&'b str]) -> Option<(bool, &'a [&'b str])> {
        let (mut permitted, mut rest) = self.one(words)?;
        while let ["AND", after @ ..] = rest {
            let (next, after) = self.one(after)?;
            (permitted, rest) = (permitted && next, after);
        }
        Some((permitted, rest))
    }

    fn one<'a, 'b>(&self, words: &'a [&'b str]) -> Option<(bool, &'a [&'b str])> {
        match words {
            ["(", inner @ ..] => match self.any(inner)? {
                (permitted, [")", rest @ ..]) => Some((permitted, rest)),
                _ => None,
            },
            [licence, "WITH", exception, rest @ ..] => {
                Some((self.permitted.contains(&format!("{licence} WITH {exception}")), rest))
            }
            ["AND" | "OR" | "WITH" | ")", ..] | [] => None,
            [licence, rest @ ..] => Some((self.permitted.contains(*licence), rest)),
        }
    }
}

/// The packages that these packages of the workspace need on this platform, each with the licence of its manifest.
/// Cargo reads manifests of downloaded packages only, and asks nothing of the network with `--offline`.
pub fn of_dependencies(options: &[&str]) -> Vec<(String, Option<String>)> {
    let tree = ["tree", "--locked", "--prefix=none", "--no-dedupe", "--format={p}|{l}"];
    let output =
        Command::new(env!("CARGO")).args(tree).args(options).current_dir(env!("CARGO_MANIFEST_DIR")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let lines: BTreeSet<_> = std::str::from_utf8(&output.stdout).unwrap().lines().collect();
    let package = |line: &&str| {
        let (name, licence) = line.split_once('|')?;
        Some((name.to_string(), Some(licence.to_string()).filter(|licence| !licence.is_empty())))
    };
    lines.iter().filter_map(package).collect()
}
