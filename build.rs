//! Binds and links the C libraries that the features ask for; without any, nothing.

#![allow(clippy::print_stdout, clippy::print_stderr)] // This is how a build script speaks.

#[cfg(feature = "umfpack")]
#[path = "ffi/bindings.rs"]
mod bindings;
#[cfg(feature = "umfpack")]
#[path = "ffi/suitesparse.rs"]
mod suitesparse;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "umfpack")]
    println!("cargo:rerun-if-changed=ffi/bindings.rs");
    #[cfg(feature = "umfpack")]
    suitesparse::suitesparse();
}
