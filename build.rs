//! Binds and links the C libraries that the features ask for; without any, nothing.

#![allow(clippy::print_stdout, clippy::print_stderr)] // This is how a build script speaks.

#[cfg(any(feature = "umfpack", feature = "mpi"))]
#[path = "ffi/bindings.rs"]
mod bindings;
#[cfg(feature = "mumps")]
#[path = "ffi/mumps.rs"]
mod mumps;
#[cfg(feature = "petsc")]
#[path = "ffi/petsc.rs"]
mod petsc;
#[cfg(feature = "mpi")]
#[path = "ffi/ranks.rs"]
mod ranks;
#[cfg(feature = "umfpack")]
#[path = "ffi/suitesparse.rs"]
mod suitesparse;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(any(feature = "umfpack", feature = "mpi"))]
    println!("cargo:rerun-if-changed=ffi/bindings.rs");
    #[cfg(feature = "umfpack")]
    suitesparse::suitesparse();
    #[cfg(feature = "mumps")]
    mumps::mumps();
    #[cfg(feature = "petsc")]
    petsc::petsc();
    #[cfg(feature = "mpi")]
    ranks::ranks();
}
