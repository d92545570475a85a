//! Problems in the files of other programs.

use crate::arrays::Exported;
use crate::error::of_file;
use crate::solve::detached;
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use stickslip::algebra::Csc;
use stickslip_exchange::{ExchangeError, Problem, ProblemFile, Solution, solve};

fn refused(error: ExchangeError) -> PyErr {
    let cure = error.help().to_string();
    match error {
        ExchangeError::Io { file, error } => of_file(&error, file),
        error => PyValueError::new_err(format!("path: {error}; {cure}")),
    }
}

fn by_columns<'py>(py: Python<'py>, matrix: &Csc) -> Exported<'py> {
    let pattern = matrix.pattern();
    (
        PyArray1::from_slice(py, matrix.values()),
        PyArray1::from_slice(py, pattern.row_indices()),
        PyArray1::from_slice(py, pattern.column_starts()),
    )
}

fn solution<'py>(py: Python<'py>, solution: &Solution) -> PyResult<Bound<'py, PyDict>> {
    let told = PyDict::new(py);
    for (name, values) in [("v", &solution.v), ("r", &solution.r), ("u", &solution.u)] {
        told.set_item(name, PyArray1::from_slice(py, values))?;
    }
    Ok(told)
}

/// The problem in an FCLIB file or in a text of Siconos.
#[pyfunction]
pub(crate) fn read_problem(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = detached(py, || ProblemFile::read(&path)).map_err(refused)?;
    let told = PyDict::new(py);
    told.set_item("form", file.problem.form())?;
    told.set_item("dimension", file.problem.dimension())?;
    told.set_item("contacts", file.problem.contacts())?;
    told.set_item("title", file.info.title)?;
    told.set_item("description", file.info.description)?;
    if let Problem::Global(problem) = &file.problem {
        told.set_item("constraints", problem.constraints())?;
        told.set_item("M", by_columns(py, problem.m()))?;
        told.set_item("H", by_columns(py, problem.h()))?;
        for (name, values) in [("f", problem.f()), ("w", problem.w()), ("mu", problem.mu())] {
            told.set_item(name, PyArray1::from_slice(py, values))?;
        }
    }
    let known = file.solution.as_ref().map(|known| solution(py, known)).transpose()?;
    told.set_item("solution", known)?;
    Ok(told)
}

/// Solves the problem in a file; the errors are those of the judge of exchange files.
#[pyfunction]
pub(crate) fn solve_problem(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let answer = detached(py, || {
        let file = ProblemFile::read(&path).map_err(refused)?;
        solve(&file.problem, None).map_err(|error| PyValueError::new_err(format!("path: {error}")))
    })?;
    let told = solution(py, &answer.solution)?;
    told.set_item("solved", answer.is_solved())?;
    told.set_item("iterations", answer.iterations())?;
    let errors = serde_json::to_string(&answer.errors).map_err(|error| PyValueError::new_err(error.to_string()))?;
    told.set_item("errors", errors)?;
    Ok(told)
}
