//! Cargo.lock: every package of every platform.

use serde::Deserialize;

pub const REGISTRY: &str = "registry+https://github.com/rust-lang/crates.io-index";

/// The packages of this workspace, which come from nowhere.
const OWN: [&str; 8] = [
    "stickslip",
    "stickslip-cli",
    "stickslip-distributed",
    "stickslip-exchange",
    "stickslip-fuzz",
    "stickslip-output",
    "stickslip-python",
    "stickslip-studies",
];

#[derive(Deserialize)]
struct Lock {
    package: Vec<Package>,
}

#[derive(Deserialize)]
pub struct Package {
    pub name: String,
    pub version: String,
    source: Option<String>,
    checksum: Option<String>,
}

impl Package {
    /// Whether it is of this workspace.
    pub fn is_own(&self) -> bool {
        self.source.is_none() && OWN.contains(&self.name.as_str())
    }
}

pub fn text() -> String {
    std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.lock")).unwrap()
}

pub fn packages(text: &str) -> Vec<Package> {
    toml::from_str::<Lock>(text).unwrap().package
}

/// Packages that are neither of this workspace nor from the registry with a checksum.
pub fn faults(packages: &[Package]) -> Vec<String> {
    let fault = |package: &Package| {
        let Package { name, version, source, checksum } = package;
        let pinned = source.as_deref() == Some(REGISTRY) && checksum.is_some() && !OWN.contains(&name.as_str());
        (!pinned && !package.is_own()).then(|| format!("{name} {version} is from {source:?}, checksum {checksum:?}"))
    };
    packages.iter().filter_map(fault).collect()
}
