//! Binds and links PETSc and MPI.

#![allow(clippy::print_stdout, clippy::print_stderr)] // This is how a build script speaks.

#[path = "../../ffi/bindings.rs"]
mod bindings;
#[path = "ffi/petsc.rs"]
mod petsc;
#[path = "ffi/ranks.rs"]
mod ranks;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../../ffi/bindings.rs");
    petsc::petsc();
    ranks::ranks();
}
