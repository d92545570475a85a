//! `stickslip._core`: what the Python package `stickslip` stands on. Arrays in, arrays out; the words are in Python.
//!
//! | what | file |
//! | --- | --- |
//! | a problem of matrices, and the judge of anybody's answer | `problem.rs` |
//! | a scene, discretised | `scene.rs` |
//! | an increment of a result: fields, pictures, files | `step.rs` |
//! | scenes to start from | `examples.rs` |
//! | problems in files of other programs | `exchange.rs` |
//! | histories of forces and gaps from tables | `loading.rs` |
//! | a body condensed to its contact displacements | `condensed.rs` |
//! | many histories side by side | `many.rs` |
//! | one increment after the other | `stepper.rs` |
//! | a run: its linear algebra, signals and panics | `solve.rs` |
//! | what is kept of a run | `recorder.rs` |
//! | a run that is saved as it goes | `saver.rs` |
//! | a linear solver that is a Python object | `foreign.rs` |
//! | finer meshes until a quantity is known | `converge.rs` |
//! | the factor by which a load may grow until a joint slips | `capacity.rs` |
//! | the program `stickslip` | `program.rs` |
//! | arrays in and out; errors out | `arrays.rs`, `error.rs` |

#![allow(clippy::needless_pass_by_value)] // What Python hands over is handed over.

mod arrays;
mod capacity;
mod condensed;
mod converge;
mod error;
mod examples;
mod exchange;
mod foreign;
mod loading;
mod many;
mod problem;
mod program;
mod recorder;
mod saver;
mod scene;
mod solve;
mod step;
mod stepper;

use pyo3::prelude::*;

/// Freed memory stays in the process: for programs that do nothing but solve.
#[pyfunction]
fn keep_freed_memory() {
    stickslip::algebra::linear::process::keep_freed_memory();
}

#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use super::capacity::find_capacity;
    #[pymodule_export]
    use super::condensed::CondensedBody;
    #[pymodule_export]
    use super::converge::converge;
    #[pymodule_export]
    use super::examples::{example, examples, toml_to_json};
    #[pymodule_export]
    use super::exchange::{read_problem, solve_problem};
    #[pymodule_export]
    use super::keep_freed_memory;
    #[pymodule_export]
    use super::many::solve_many;
    #[pymodule_export]
    use super::problem::Problem;
    #[pymodule_export]
    use super::program::program;
    #[pymodule_export]
    use super::scene::SceneModel;
    #[pymodule_export]
    use super::stepper::{SavedSteps, Stepper};

    #[pymodule_export]
    const UMFPACK: bool = cfg!(feature = "umfpack");

    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}
