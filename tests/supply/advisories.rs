//! What the RustSec advisory database has on the packages of Cargo.lock, as pinned in advisories.toml.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;

use super::lock::Package;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Advisories {
    /// The day on which it was looked up.
    #[serde(rename = "looked_up")]
    _looked_up: String,
    /// Packages on which the database has nothing.
    clear: BTreeSet<String>,
    advisory: Vec<Advisory>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Advisory {
    id: String,
    package: String,
    #[serde(default)]
    patched: Vec<String>,
    #[serde(default)]
    unaffected: Vec<String>,
    /// Why an affected version stays all the same.
    stays: Option<String>,
}

impl Advisories {
    pub fn read() -> Self {
        Self::of(include_str!("advisories.toml"))
    }

    pub fn of(text: &str) -> Self {
        toml::from_str(text).unwrap()
    }

    /// Packages that were not looked up, that are affected, or whose entry here has become idle.
    pub fn faults(&self, packages: &[Package]) -> Vec<String> {
        let mut versions: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for package in packages.iter().filter(|package| !package.is_own()) {
            versions.entry(&package.name).or_default().push(&package.version);
        }
        let known: BTreeSet<_> = self.advisory.iter().map(|advisory| advisory.package.as_str()).collect();
        let listed: BTreeSet<_> = self.clear.iter().map(String::as_str).chain(known.iter().copied()).collect();
        let mut faults = Vec::new();
        for name in versions.keys().filter(|name| !listed.contains(*name)) {
            faults.push(format!("{name} was not looked up in the advisory database; see tests/supply/README.md"));
        }
        for name in listed.iter().filter(|name| !versions.contains_key(*name)) {
            faults.push(format!("{name} is no longer in Cargo.lock, but in tests/supply/advisories.toml"));
        }
        for name in self.clear.iter().filter(|name| known.contains(name.as_str())) {
            faults.push(format!("{name} is clear and has an advisory"));
        }
        for advisory in &self.advisory {
            let versions = versions.get(advisory.package.as_str()).into_iter().flatten().copied();
            let affected: Vec<_> = versions.filter(|version| advisory.affects(version)).collect();
            faults.extend(advisory.fault(&affected));
        }
        faults
    }
}

impl Advisory {
    /// What is wrong if it affects these versions.
    fn fault(&self, affected: &[&str]) -> Option<String> {
        let Self { id, package, stays, .. } = self;
        match (affected.is_empty(), stays) {
            (false, None) => Some(format!("{package} {} is affected by {id}", affected.join(", "))),
            (true, Some(_)) => Some(format!("{id} no longer affects {package}: take its `stays` away")),
            _ => None,
        }
    }

    /// A version before a release counts as affected: whether a range has it, somebody has to decide.
    fn affects(&self, version: &str) -> bool {
        let Some(version) = numbers(version) else { return true };
        !self.patched.iter().chain(&self.unaffected).any(|range| is_in(version, range))
    }
}

type Version = [u64; 3];

/// The numbers of a version, absent ones 0; none for one before a release. What comes after a `+` does not count.
fn numbers(version: &str) -> Option<Version> {
    let mut numbers = [0; 3];
    for (k, part) in version.split('+').next()?.split('.').enumerate() {
        *numbers.get_mut(k)? = part.parse().ok()?;
    }
    Some(numbers)
}

/// Whether all comparisons of a range such as `>= 0.7.4, < 0.8` hold.
fn is_in(version: Version, range: &str) -> bool {
    range.split(',').map(str::trim).all(|comparison| {
        let (operator, bound) = comparison.split_once(' ').unwrap_or_else(|| panic!("no range: {range}"));
        let bound = numbers(bound).unwrap_or_else(|| panic!("no version: {range}"));
        match operator {
            ">=" => version >= bound,
            "<=" => version <= bound,
            "<" => version < bound,
            _ => panic!("no comparison: {range}"),
        }
    })
}
