//! The layers of the library, of the studies and of the fuzzing: who may use whom, and what may stand where.

#![allow(clippy::unwrap_used)]

mod circles;
mod impls;
mod layers;
mod outside;
mod places;
mod source;

use std::collections::BTreeSet;

use circles::circles;
use impls::foreign_impls;
use layers::{MAY_USE, cyclic, layer_faults};
use outside::{FUZZ, LIBRARY, STUDIES, dependencies, outside_faults};
use places::{MOST_LINES, place_faults};
use source::{Sources, code, source, sources};

const SRC: &str = "src";
const STUDIES_SRC: &str = "studies/src";
const FUZZ_SRC: &str = "fuzz/src";
const NONE: [&str; 0] = [];

#[test]
fn modules_use_what_is_below_them() {
    assert_eq!(layer_faults(&sources(SRC), MAY_USE), NONE);
}

#[test]
fn the_layers_have_no_cycle() {
    assert_eq!(cyclic(MAY_USE), [""; 0]);
    assert_eq!(cyclic(&[("a", &[]), ("b", &["a", "c"]), ("c", &["d"]), ("d", &["b"])]), ["b", "c", "d"]);
    assert_eq!(cyclic(&[("a", &["a"])]), ["a"]);
}

#[test]
fn no_folder_has_a_circle_of_files() {
    assert_eq!(circles(&sources(SRC)), NONE);
    assert_eq!(circles(&sources(STUDIES_SRC)), NONE);
    assert_eq!(circles(&sources(FUZZ_SRC)), NONE);
}

#[test]
fn methods_stand_with_their_types() {
    assert_eq!(foreign_impls(&sources(SRC)), NONE);
    assert_eq!(foreign_impls(&sources(STUDIES_SRC)), NONE);
    assert_eq!(foreign_impls(&sources(FUZZ_SRC)), NONE);
}

#[test]
fn other_crates_and_the_outside_have_their_places() {
    assert_eq!(outside_faults(&sources(SRC), LIBRARY), BTreeSet::new());
    assert_eq!(outside_faults(&sources(STUDIES_SRC), STUDIES), BTreeSet::new());
    assert_eq!(outside_faults(&sources(FUZZ_SRC), FUZZ), BTreeSet::new());
}

/// A new dependency needs a place in the tables.
#[test]
fn the_tables_hold_all_dependencies() {
    assert_eq!(dependencies("Cargo.toml"), outside::crates(LIBRARY));
    assert_eq!(dependencies("studies/Cargo.toml"), outside::crates(STUDIES));
    assert_eq!(dependencies("fuzz/Cargo.toml"), outside::crates(FUZZ));
}

#[test]
fn everything_stands_where_it_may() {
    assert_eq!(place_faults(&sources(SRC), &["linear/"]), NONE);
    assert_eq!(place_faults(&sources(STUDIES_SRC), &[]), NONE);
    assert_eq!(place_faults(&sources(FUZZ_SRC), &[]), NONE);
}

#[test]
fn the_search_sees_the_whole_of_src() {
    let sources = sources(SRC);
    for file in ["lib.rs", "main.rs", "cli.rs", "cli/run.rs", "linear/umfpack.rs", "scene/read.rs"] {
        assert!(sources.contains_key(file), "{file} was not read");
    }
    // Where these are at home they are found, so their absence elsewhere means something.
    let anywhere = |what: &str| sources.values().any(|text| code(text).any(|(_, line)| line.contains(what)));
    assert!(["unsafe {", "writeln!", "clap::"].into_iter().all(anywhere));
    let modules = sources["lib.rs"].lines().filter_map(|line| line.trim_start_matches("pub ").strip_prefix("mod "));
    let declared: BTreeSet<&str> = modules.filter_map(|line| line.strip_suffix(';')).collect();
    assert_eq!(declared, MAY_USE.iter().map(|(user, _)| *user).collect());
    assert!(source::sources(STUDIES_SRC).contains_key("cli/tables.rs"));
}

// The searches themselves, on sources with one fault each.

#[test]
fn faults_of_layers_are_found() {
    let table: &[(&str, &[&str])] = &[("a", &["b"])];
    let layers = |file: &str, text: &str| layer_faults(&source(file, text), table);
    assert_eq!(layers("a.rs", "use crate::b::{\n    B,\n};\n"), [""; 0]);
    assert_eq!(layers("a/x.rs", "use super::A;\nfn f() -> crate::b::B {}\n"), [""; 0]);
    assert_eq!(layers("a.rs", "use crate::b;\nuse crate::c::C;\n"), ["a.rs:2: `a` may not use `c`"]);
    assert_eq!(layers("a/x.rs", "let b = crate::b::f(crate::c::g());"), ["a/x.rs:1: `a` may not use `c`"]);
    assert_eq!(layers("a.rs", "use crate::{b, c};\nuse crate::b;\n"), ["a.rs:1: use one module at a time"]);
    assert_eq!(layers("a.rs", "use super::b;\nuse crate::b;\n"), ["a.rs:1: name the module by `crate::`"]);
    assert_eq!(layers("a/x.rs", "use super::super::c;\nuse crate::b;\n"), ["a/x.rs:1: name the module by `crate::`"]);
    assert_eq!(layers("a.rs", "// use crate::b;\n"), ["`a` may use `b`, but does not"]);
    assert_eq!(layers("z.rs", "").len(), 3);
    let tests = "use crate::b;\n#[cfg(test)]\nmod tests {\n    use crate::c;\n}\n";
    assert_eq!(layers("a.rs", tests), [""; 0]);
    assert_eq!(layers("a.rs", &[tests, "use crate::c;\n"].concat()), ["a.rs:6: `a` may not use `c`"]);
}

#[test]
fn circles_are_found() {
    let folder = |files: &[(&str, &str)]| {
        circles(&files.iter().map(|(file, text)| (file.to_string(), text.to_string())).collect::<Sources>())
    };
    let parent = "mod x;\nmod y;\npub use x::X;\npub(crate) use y::{Y, y};\n";
    let found = ["a: x, y use each other in a circle"];
    // By the file, by what the parent passes on, in a group of several lines, by a path in the code, from below.
    for x in ["use super::y::Y;", "use super::Y;", "use super::{\n    Y,\n};\n", "fn f() -> crate::a::y::Y {}"] {
        assert_eq!(folder(&[("a.rs", parent), ("a/x.rs", x), ("a/y.rs", "use crate::a::X;")]), found, "{x}");
        assert_eq!(folder(&[("a.rs", parent), ("a/x.rs", x), ("a/y.rs", "pub struct Y;")]), NONE, "{x}");
        assert_eq!(folder(&[("a.rs", parent), ("a/x.rs", x), ("a/y.rs", "#[cfg(test)]\nuse super::X;\n}")]), NONE);
    }
    let below = ("a/x/z.rs", "use super::super::y::Y;");
    assert_eq!(folder(&[("a/x.rs", "mod z;"), below, ("a/y.rs", "use super::x::X;")]), found);
    // A parent may hold what its children share, and use them.
    let child = ("a/x.rs", "use super::A;\npub struct X;");
    assert_eq!(folder(&[("a.rs", "mod x;\nuse x::X;\nstruct A(X);\n"), child]), NONE);
    let three = [("a/x.rs", "use super::y::Y;"), ("a/y.rs", "use super::z;"), ("a/z.rs", "use super::x::X;")];
    assert_eq!(folder(&three), ["a: x, y, z use each other in a circle"]);
}

#[test]
fn foreign_impls_are_found() {
    let a = |text: &str| {
        let mut sources = source("a.rs", text);
        sources.insert("b.rs".to_string(), "pub struct B;\npub struct A;\n".to_string());
        foreign_impls(&sources)
    };
    let found = ["a.rs:2: methods of `B` outside its module"];
    for foreign in ["impl B {", "impl<T> B<T> {", "impl<T: F<B>> B where T: Clone {", "impl crate::b::B {"] {
        assert_eq!(a(&format!("use crate::b::B;\n{foreign}\n")), found, "{foreign}");
    }
    assert_eq!(a("use crate::b::A;\nimpl A {\npub struct A;\n"), ["a.rs:2: methods of `A` outside its module"]);
    for own in ["struct A;\nimpl A {", "impl From<A> for B {", "impl<'a> A<'a> {\npub(super) struct A<'a>;"] {
        assert_eq!(a(own), NONE, "{own}");
    }
}

#[test]
fn the_outside_is_found_where_it_must_not_be() {
    let table: &[(&str, &[&str])] = &[("toml", &["scene/"]), ("std::fs", &["scene.rs"]), ("serde", &[])];
    let faults = |sources: &Sources| Vec::from_iter(outside_faults(sources, table));
    let mut home = source("scene/x.rs", "use toml::Value;");
    home.insert("scene.rs".to_string(), "use std::{fs, io};\nuse serde::Serialize;\n".to_string());
    assert_eq!(faults(&home), NONE);
    let with = |file: &str, text: &str| {
        let mut sources = home.clone();
        sources.insert(file.to_string(), text.to_string());
        faults(&sources)
    };
    for fs in ["use std::{io, fs::{self, File}};", "let text = std::fs::read(path);", "use std::fs;"] {
        assert_eq!(with("mesh.rs", fs), ["mesh.rs:1: `std::fs` is not for this file"], "{fs}");
    }
    assert_eq!(with("a.rs", "f(toml::from_str::<T>(text))"), ["a.rs:1: `toml` is not for this file"]);
    assert_eq!(with("a.rs", "use toml_edit::Item;\n// toml::x\nuse serde_toml::toml::X;"), NONE);
    assert_eq!(faults(&source("scene/x.rs", "use toml::Value;")), ["scene.rs may name `std::fs`, but does not"]);
}

#[test]
fn faults_of_places_are_found() {
    let places = |file: &str, text: &str| place_faults(&source(file, text), &["linear/"]);
    for (file, text) in [
        ("mesh.rs", "unsafe { f() }"),
        ("linear.rs", "unsafe { f() }"),
        ("report/csv.rs", "    eprintln!(\"x\");"),
        ("history.rs", "print!(\"x\");"),
        ("history.rs", "_ => panic!(\"x\"),"),
        ("mesh.rs", "    todo!()"),
        ("cli/run.rs", "x.unwrap();"),
        ("cli.rs", "#[path = \"../mesh.rs\"]"),
        ("mesh.rs", "/// # Panics\n/// If the lists differ.\npub fn f() {}"),
        ("mesh.rs", "    //! # Panics"),
    ] {
        assert_eq!(places(file, text).len(), 1, "{file}: {text}");
    }
    for (file, text) in [("linear/x.rs", "unsafe { f() }"), ("cli/run.rs", "println!();"), ("a.rs", "// unsafe")] {
        assert_eq!(places(file, text), NONE);
    }
    assert_eq!(places("a.rs", &"\n".repeat(MOST_LINES)), NONE);
    assert_eq!(places("a.rs", &"\n".repeat(MOST_LINES + 1)), ["a.rs: more than 700 lines"]);
}
