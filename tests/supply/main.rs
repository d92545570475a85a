//! What the project is made of: where each dependency comes from, under which licence it is, and what is known against it.
//! Nothing is asked of the network; README.md in this folder says how the lists are kept.

#![allow(clippy::unwrap_used)]

mod advisories;
mod licences;
mod lock;

use std::collections::BTreeSet;

use advisories::Advisories;
use licences::Licences;
use lock::{Package, packages};

const NONE: [&str; 0] = [];

fn package(name: &str, version: &str) -> Package {
    let from_registry = format!(
        "[[package]]\nname = {name:?}\nversion = {version:?}\nsource = {:?}\nchecksum = {:?}",
        lock::REGISTRY,
        "0".repeat(64)
    );
    packages(&from_registry).remove(0)
}

#[test]
fn all_comes_from_the_registry_with_a_checksum() {
    assert_eq!(lock::faults(&packages(&lock::text())), NONE);
}

#[test]
fn what_comes_from_elsewhere_is_found() {
    let entry = |lines: &str| lock::faults(&packages(&format!("[[package]]\nversion = \"1.0.0\"\n{lines}")));
    for lines in [
        "name = \"a\"",
        "name = \"a\"\nsource = \"git+https://example.org/a#0\"",
        "name = \"a\"\nsource = \"registry+https://example.org/index\"\nchecksum = \"0\"",
        "name = \"a\"\nsource = \"registry+https://github.com/rust-lang/crates.io-index\"",
        // The name of one of ours from the registry is not ours.
        "name = \"stickslip\"\nsource = \"registry+https://github.com/rust-lang/crates.io-index\"\nchecksum = \"0\"",
    ] {
        assert_eq!(entry(lines).len(), 1, "{lines}");
    }
    assert_eq!(entry("name = \"stickslip\""), NONE);
}

#[test]
fn every_dependency_was_looked_up_and_nothing_that_is_known_is_left() {
    assert_eq!(Advisories::read().faults(&packages(&lock::text())), NONE);
}

#[test]
fn what_is_known_or_was_not_looked_up_is_found() {
    let advisories = |stays: &str| {
        let text = "looked_up = \"2026-01-01\"\nclear = [\"b\"]\n[[advisory]]\nid = \"X\"\npackage = \"a\"\npatched = [\">= 1.2.3\"]\n";
        Advisories::of(&format!("{text}unaffected = [\"< 0.3\"]\n{stays}"))
    };
    let (listed, stays) = (advisories(""), advisories("stays = \"because\""));
    let with = |advisories: &Advisories, a: &str| advisories.faults(&[package("a", a), package("b", "1.0.0")]).len();
    for (version, affected) in [("1.2.2", 1), ("0.3.0", 1), ("1.2.3", 0), ("1.2.3+meta", 0), ("0.2.9", 0), ("2.0.0", 0)]
    {
        assert_eq!(with(&listed, version), affected, "{version}");
        // An excuse has to be needed.
        assert_eq!(with(&stays, version), 1 - affected, "{version}");
    }
    // Nobody looked c up; b is no longer there; what is before a release is neither in a range nor out of it.
    assert_eq!(listed.faults(&[package("a", "2.0.0"), package("b", "1.0.0"), package("c", "1.0.0")]).len(), 1);
    assert_eq!(listed.faults(&[package("a", "2.0.0")]).len(), 1);
    assert_eq!(with(&listed, "1.3.0-rc.1"), 1);
}

/// Packages of `cargo tree` whose licence is not permitted.
fn licence_faults(options: &[&str]) -> Vec<String> {
    let packages = licences::of_dependencies(options);
    assert!(packages.len() > 50, "cargo tree lists {} packages only", packages.len());
    Licences::read().faults(&packages)
}

/// The build of this test has downloaded every package that is asked for.
#[test]
fn every_licence_may_be_passed_on_with_ours() {
    assert_eq!(licence_faults(&["--offline", "--workspace", "--exclude=stickslip-python"]), NONE);
}

#[test]
#[ignore = "downloads packages that only the Python module needs: make python runs it"]
fn every_licence_of_the_python_module_may_be_passed_on_with_ours() {
    assert_eq!(licence_faults(&["--package=stickslip-python"]), NONE);
}

#[test]
fn licences_that_bind_more_are_found() {
    let licences = Licences::of("permitted = [\"MIT\", \"Zlib\"]\nlinked = []");
    let fault = |expression: &str| !licences.faults(&[("a".to_string(), Some(expression.to_string()))]).is_empty();
    for expression in
        ["MIT", "MIT OR GPL-3.0", "GPL-3.0/MIT", "(MIT OR X) AND Zlib", "X AND Y OR MIT", "X WITH Y OR Zlib"]
    {
        assert!(!fault(expression), "{expression}");
    }
    for expression in
        ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR X) AND (Y OR X)", "MIT WITH X", "MIT MIT", "(MIT", "MIT OR", ""]
    {
        assert!(fault(expression), "{expression}");
    }
    assert_eq!(licences.faults(&[("a".to_string(), None)]).len(), 1);
}

#[test]
fn every_c_library_that_is_linked_is_named_with_its_licence() {
    let [suitesparse, ranks, petsc] = [
        include_str!("../../ffi/suitesparse.rs"),
        include_str!("../../crates/distributed/ffi/ranks.rs"),
        include_str!("../../crates/distributed/ffi/petsc.rs"),
    ];
    let names = [suitesparse, ranks].into_iter().flat_map(|script| script.split("rustc-link-lib=dylib=").skip(1));
    let names = names.map(|rest| rest.split('"').next().unwrap().to_string()).filter(|name| !name.starts_with('{'));
    let mut linked: BTreeSet<_> = names.collect();
    // What these are called is told by the installation.
    for (script, mark, name) in [(ranks, "mpicc", "mpi"), (petsc, "\"petsc\"", "petsc")] {
        linked.extend(script.contains(mark).then(|| name.to_string()));
    }
    let named: BTreeSet<_> = Licences::read().linked.into_iter().map(|linked| linked.library).collect();
    assert!(linked.contains("umfpack"));
    assert_eq!(linked, named);
}
