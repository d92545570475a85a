//! Errors of the library as exceptions of Python.

use std::io;

use pyo3::PyErr;
use pyo3::exceptions::{PyMemoryError, PyOSError, PyRuntimeError, PyValueError};
use stickslip::algebra::linear::LinearError;
use stickslip::run::RunError;
use stickslip::scene::SceneError as Refused;
use stickslip::solver::ProblemError;
use stickslip::solver::history::Error as HistoryError;

pyo3::import_exception!(stickslip._errors, SceneError);

/// A scene that is refused without a place in its text.
fn unplaced(message: String, help: String) -> PyErr {
    SceneError::new_err((message, None::<String>, None::<usize>, None::<String>, help))
}

/// A file that cannot be read or written; Python says the number of the error by itself.
pub(crate) fn of_file(error: &io::Error, path: String) -> PyErr {
    let message = error.to_string();
    let words = message.split(" (os error").next().unwrap_or_default().to_string();
    PyOSError::new_err((error.raw_os_error(), words, path))
}

pub(crate) fn of_scene(error: Refused) -> PyErr {
    let message = error.to_string();
    match error {
        Refused::Other { help, .. } => unplaced(message, help.to_string()),
        Refused::Io { path, error } => of_file(&error, path),
        Refused::Invalid(at) => {
            let at = *at;
            SceneError::new_err((at.message, Some(at.file), Some(at.line), Some(at.key), at.help))
        }
        Refused::Override { text, message, help } => {
            let key = text.split('=').next().unwrap_or_default().to_string();
            SceneError::new_err((message, None::<String>, None::<usize>, Some(key), help))
        }
    }
}

pub(crate) fn of_problem(error: ProblemError) -> PyErr {
    PyValueError::new_err(in_python(&error.to_string()))
}

pub(crate) fn of_linear(error: LinearError) -> PyErr {
    match error {
        LinearError::OutOfMemory { .. } => PyMemoryError::new_err(error.to_string()),
        LinearError::Singular { .. } => PyValueError::new_err(
            "K: a part of the body can move while its contact nodes are clamped, so that it cannot be condensed",
        ),
        error => PyRuntimeError::new_err(error.to_string()),
    }
}

/// Says the arguments of Python for the parts of a problem.
fn in_python(message: &str) -> String {
    let names = [("rigid_modes", "free_motions"), ("c_n", "C_n"), ("c_t", "C_t"), ("c_o", "C_t[1]")];
    let said = names.iter().fold(message.to_string(), |message, (part, name)| message.replace(part, name));
    said.strip_prefix("stiffness").map_or(said.clone(), |rest| format!("K{rest}"))
}

fn of_history(error: HistoryError) -> PyErr {
    match error {
        HistoryError::Linear(LinearError::OutOfMemory { .. }) => PyMemoryError::new_err(error.to_string()),
        HistoryError::Checkpoint(error) => {
            // The error names what is asked for as the program does.
            let error = error.to_string().replace("--", "").replace("the method", "the method or the linear solver");
            PyValueError::new_err(format!("checkpoint: {error}; remove it, or name another file"))
        }
        HistoryError::Linear(LinearError::NotBuiltIn { .. })
        | HistoryError::Problem(_)
        | HistoryError::NoWeight { .. } => PyValueError::new_err(error.to_string()),
        error => PyRuntimeError::new_err(error.to_string()),
    }
}

pub(crate) fn of_run(error: RunError) -> PyErr {
    match error {
        RunError::Scene(error) => of_scene(error),
        RunError::Model(error) => unplaced(error.to_string(), String::new()),
        RunError::NoRoom { .. } => PyMemoryError::new_err(error.to_string()),
        RunError::SlidesInAPlane | RunError::Unlocked(_) => PyValueError::new_err(error.to_string()),
        RunError::History(error) => of_history(error),
    }
}
