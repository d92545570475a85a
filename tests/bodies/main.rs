//! From a scene to matrices and back: meshes, elements, obstacles, closed forms, result files.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

#[path = "../common/mod.rs"]
mod common;

mod closed_forms;
mod contact;
mod elements;
mod files;
mod refused;
mod runs;
