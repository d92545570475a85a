//! Generates the SuiteSparse bindings from the installed headers and links the shared libraries.
//!
//! `SUITESPARSE_INCLUDE_DIR` and `SUITESPARSE_LIB_DIR` override where headers and libraries are
//! looked for. The bindings are made anew on every machine, so 5.x and 7.x headers both serve.

use super::bindings::{generate, stop};
use std::env;
use std::path::PathBuf;

/// What `linear/` calls; everything else in the headers stays out of the project.
const ALLOWED: [&str; 6] = [
    "umfpack_dl_(defaults|symbolic|numeric|wsolve|free_symbolic|free_numeric)",
    "SuiteSparse_version",
    "SUITESPARSE_(MAIN|SUB|SUBSUB)_VERSION",
    "UMFPACK_.*",
    "cholmod_l_(version|start|finish|analyze|analyze_p|factorize|free_factor)",
    "CHOLMOD_.*",
];

/// Everything this file is for.
pub fn suitesparse() {
    println!("cargo:rerun-if-changed=ffi/suitesparse.rs");
    println!("cargo:rerun-if-changed=ffi/suitesparse.h");
    println!("cargo:rerun-if-env-changed=SUITESPARSE_INCLUDE_DIR");
    println!("cargo:rerun-if-env-changed=SUITESPARSE_LIB_DIR");

    let include = include_dir();
    if let Some(lib) = env::var_os("SUITESPARSE_LIB_DIR") {
        let lib = PathBuf::from(lib);
        println!("cargo:rustc-link-search=native={}", lib.display());
        // So that what is built starts without LD_LIBRARY_PATH.
        println!("cargo:rustc-link-arg=-Wl,-rpath,{}", lib.display());
    }
    println!("cargo:rustc-link-lib=dylib=umfpack");
    println!("cargo:rustc-link-lib=dylib=cholmod");
    println!("cargo:rustc-link-lib=dylib=suitesparseconfig");
    generate("ffi/suitesparse.h", "suitesparse.rs", &[format!("-I{}", include.display())], &ALLOWED);
}

/// The folder that holds `umfpack.h`, or the end of the build with the package to install.
fn include_dir() -> PathBuf {
    let candidates: Vec<PathBuf> = match env::var_os("SUITESPARSE_INCLUDE_DIR") {
        Some(dir) => vec![dir.into()],
        None => [
            "/usr/include/suitesparse",
            "/usr/local/include/suitesparse",
            "/opt/homebrew/include/suitesparse",
            "/usr/include",
        ]
        .map(PathBuf::from)
        .to_vec(),
    };
    match candidates.iter().find(|dir| dir.join("umfpack.h").is_file()) {
        Some(dir) => {
            println!("cargo:rerun-if-changed={}", dir.join("umfpack.h").display());
            dir.clone()
        }
        None => stop(&format!(
            "umfpack.h not found in {}.\n  \
             Debian, Ubuntu: apt-get install libsuitesparse-dev libopenblas-dev\n  \
             elsewhere: set SUITESPARSE_INCLUDE_DIR (and SUITESPARSE_LIB_DIR) to an installed SuiteSparse, 5.x or 7.x",
            candidates.iter().map(|dir| dir.display().to_string()).collect::<Vec<_>>().join(", ")
        )),
    }
}
