//! With the feature `umfpack`, binds and links the SuiteSparse that is installed; otherwise nothing.

#[cfg(feature = "umfpack")]
#[path = "ffi/link.rs"]
mod link;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    #[cfg(feature = "umfpack")]
    link::suitesparse();
}
