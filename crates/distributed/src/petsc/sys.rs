//! The raw bindings of PETSc, generated from the installed headers by `build.rs`.

#![allow(unsafe_code, missing_docs, non_camel_case_types, non_snake_case, non_upper_case_globals, dead_code)]
#![allow(clippy::all, clippy::pedantic, clippy::undocumented_unsafe_blocks)]

include!(concat!(env!("OUT_DIR"), "/petsc.rs"));
