//! A body condensed to its contact displacements: forces there, displacements back.

use crate::arrays::{Rows, rows, table};
use crate::error::of_linear;
use crate::solve::detached;
use numpy::PyArray2;
use pyo3::prelude::*;
use stickslip::algebra::linear::LinearError;
use stickslip::solver::Condensed;

/// What `Problem.condense` has condensed.
#[pyclass(frozen, module = "stickslip._core")]
pub(crate) struct CondensedBody(pub Condensed);

/// Rows of the same length, one after the other.
fn stacked(rows: impl Iterator<Item = Result<Vec<f64>, LinearError>>) -> Result<Vec<f64>, LinearError> {
    rows.collect::<Result<Vec<_>, _>>().map(|rows| rows.concat())
}

#[pymethods]
impl CondensedBody {
    /// Rows of forces on the body, N, as forces on the contact displacements.
    fn reduce<'py>(&self, py: Python<'py>, forces: Rows<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let forces = rows(&forces);
        let one = |force: &Vec<f64>| self.0.reduce(force).map(|reduced| self.0.on_contact(&reduced));
        let found = detached(py, || stacked(forces.iter().map(one))).map_err(of_linear)?;
        table(py, forces.len(), found)
    }

    /// Rows of displacements of the body, m, of those of contact and of the forces on the body, N.
    fn lift<'py>(&self, py: Python<'py>, contact: Rows<'py>, forces: Rows<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (contact, forces) = (rows(&contact), rows(&forces));
        let one = |(u, force): (&Vec<f64>, &Vec<f64>)| self.0.displacements(&self.0.reduce(force)?, u);
        let found = detached(py, || stacked(contact.iter().zip(&forces).map(one))).map_err(of_linear)?;
        table(py, forces.len(), found)
    }
}
