//! Compiles the few functions of MPI, links them, and generates their bindings.
//!
//! The C code that calls MPI is compiled by the `mpicc` in the path.

use super::bindings::{generate, stop};
use std::env;
use std::path::PathBuf;
use std::process::Command;

const INSTALL: &str = "Debian, Ubuntu: apt-get install openmpi-bin libopenmpi-dev";

/// Everything this file is for.
pub fn ranks() {
    for file in ["ffi/ranks.rs", "ffi/ranks.h", "ffi/ranks.c"] {
        println!("cargo:rerun-if-changed={file}");
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let object = out.join("ranks.o");
    run("mpicc", &["-O2", "-fPIC", "-Wall", "-c", "ffi/ranks.c", "-o", &object.to_string_lossy()]);
    run("ar", &["crs", &out.join("libranks.a").to_string_lossy(), &object.to_string_lossy()]);
    println!("cargo:rustc-link-search=native={}", out.display());
    println!("cargo:rustc-link-lib=static=ranks");
    for flag in mpicc(["--showme:link", "-link_info"]) {
        if let Some(folder) = flag.strip_prefix("-L") {
            println!("cargo:rustc-link-search=native={folder}");
        } else if let Some(library) = flag.strip_prefix("-l") {
            println!("cargo:rustc-link-lib=dylib={library}");
        }
    }
    generate("ffi/ranks.h", "ranks.rs", &[], &["mpi_shim_.*"]);
}

/// Where the headers of MPI are, for those that include them.
pub fn includes() -> Vec<String> {
    let flags = mpicc(["--showme:compile", "-compile_info"]);
    flags.into_iter().filter(|flag| flag.starts_with("-I")).collect()
}

/// Returns what `mpicc` says of itself, asked as Open MPI and as MPICH want to be.
fn mpicc(words: [&str; 2]) -> Vec<String> {
    for word in words {
        match Command::new("mpicc").arg(word).output() {
            Ok(output) if output.status.success() => {
                return String::from_utf8_lossy(&output.stdout).split_whitespace().map(str::to_owned).collect();
            }
            _ => {}
        }
    }
    stop(&format!("`mpicc` does not say how MPI is linked.\n  {INSTALL}"))
}

/// Runs a tool of the compiler, or ends the build.
fn run(program: &str, arguments: &[&str]) {
    if !Command::new(program).args(arguments).status().is_ok_and(|status| status.success()) {
        stop(&format!("`{program} {}` failed.\n  {INSTALL}", arguments.join(" ")));
    }
}
