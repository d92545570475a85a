//! Arrays of numpy and what they are here.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stickslip::algebra::{Csr, MatrixError, Symmetric};

/// A vector of numbers, contiguous.
pub(crate) type Vector<'py> = PyReadonlyArray1<'py, f64>;

/// A table of numbers.
pub(crate) type Rows<'py> = PyReadonlyArray2<'py, f64>;

/// A sparse matrix as scipy has it: data, indices, starts.
pub(crate) type Compressed<'py> = (Vector<'py>, PyReadonlyArray1<'py, i64>, PyReadonlyArray1<'py, i64>);

/// The same on the way out.
pub(crate) type Exported<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>);

fn unsound(name: &str, error: MatrixError) -> PyErr {
    PyValueError::new_err(format!("{name}: {error}"))
}

/// The rows (or columns) of a compressed matrix, as pairs of an index and a number.
fn lines(name: &str, matrix: &Compressed<'_>) -> PyResult<Vec<Vec<(usize, f64)>>> {
    let (data, indices, starts) = (matrix.0.as_slice()?, matrix.1.as_slice()?, matrix.2.as_slice()?);
    let bad = || PyValueError::new_err(format!("{name}: indices, indptr and data do not belong together"));
    let line = |ends: &[i64]| -> Option<Vec<(usize, f64)>> {
        let ends = usize::try_from(ends[0]).ok()?..usize::try_from(ends[1]).ok()?;
        let (indices, data) = (indices.get(ends.clone())?, data.get(ends)?);
        indices.iter().zip(data).map(|(&j, &value)| Some((usize::try_from(j).ok()?, value))).collect()
    };
    starts.windows(2).map(|ends| line(ends).ok_or_else(bad)).collect()
}

/// A map with so many columns.
pub(crate) fn map(name: &str, columns: usize, matrix: &Compressed<'_>) -> PyResult<Csr> {
    Csr::from_rows(columns, lines(name, matrix)?).map_err(|error| unsound(name, error))
}

/// A symmetric matrix of its lower triangle by columns.
pub(crate) fn symmetric(name: &str, order: usize, lower: &Compressed<'_>) -> PyResult<Symmetric> {
    let columns = lines(name, lower)?;
    let entries =
        columns.iter().enumerate().flat_map(|(j, column)| column.iter().map(move |&(i, value)| (i, j, value)));
    let triplets: Vec<_> = entries.collect();
    Symmetric::from_triplets(order, &triplets).map_err(|error| unsound(name, error))
}

/// The lower triangle by columns.
pub(crate) fn export_lower<'py>(py: Python<'py>, matrix: &Symmetric) -> Exported<'py> {
    let lower = matrix.lower();
    let pattern = lower.pattern();
    (
        PyArray1::from_slice(py, lower.values()),
        PyArray1::from_slice(py, pattern.row_indices()),
        PyArray1::from_slice(py, pattern.column_starts()),
    )
}

/// A map by rows.
pub(crate) fn export_map<'py>(py: Python<'py>, map: &Csr) -> Exported<'py> {
    let (mut data, mut indices, mut starts) = (Vec::new(), Vec::new(), vec![0_i64]);
    for i in 0..map.rows() {
        for &(j, value) in map.row(i) {
            data.push(value);
            indices.push(j as i64);
        }
        starts.push(data.len() as i64);
    }
    (data.into_pyarray(py), indices.into_pyarray(py), starts.into_pyarray(py))
}

/// Numbers row after row as a table of so many rows.
pub(crate) fn table<T: numpy::Element>(
    py: Python<'_>,
    rows: usize,
    values: Vec<T>,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let columns = values.len().checked_div(rows).unwrap_or(0);
    PyArray1::from_vec(py, values).reshape([rows, columns])
}

/// The rows of a table.
pub(crate) fn rows(table: &Rows<'_>) -> Vec<Vec<f64>> {
    table.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

/// An array of another length than asked for.
pub(crate) fn expect_length(name: &str, expected: usize, found: usize) -> PyResult<()> {
    if expected == found {
        return Ok(());
    }
    Err(PyValueError::new_err(format!("{name}: length {expected} expected, {found} found")))
}
