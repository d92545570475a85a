//! Generates the bindings of the MUMPS that is installed, and links it.
//!
//! `MUMPS_LIBRARY` names another build of MUMPS than Debian's with PT-SCOTCH.

use super::bindings::generate;
use super::ranks::includes;
use std::env;

/// What `mumps.rs` calls.
const ALLOWED: [&str; 3] = ["dmumps_c", "DMUMPS_STRUC_C", "MUMPS_VERSION"];

/// The library with METIS' orders handed over; Debian's without a suffix cannot order by itself at all.
const LIBRARY: &str = "dmumps_ptscotch";

/// Everything this file is for.
pub fn mumps() {
    println!("cargo:rerun-if-changed=ffi/mumps.rs");
    println!("cargo:rerun-if-changed=ffi/mumps.h");
    println!("cargo:rerun-if-env-changed=MUMPS_LIBRARY");
    println!("cargo:rustc-link-lib=dylib={}", env::var("MUMPS_LIBRARY").unwrap_or_else(|_| LIBRARY.to_string()));
    generate("ffi/mumps.h", "mumps.rs", &includes(), &ALLOWED);
}
