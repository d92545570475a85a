//! A direct solver that is a Python object: `analyze(n, indptr, indices)`, `factorize(data)`, `solve(b) -> x`.

use std::sync::{Arc, Mutex};

use numpy::{PyArray1, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::{PyArithmeticError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyList;
use stickslip::algebra::Pattern;
use stickslip::algebra::linear::{FactorInfo, LinearError, LinearSolver};

use crate::arrays::Vector;

/// The first exception of a Python object in a run, which the errors of the library have no room for.
#[derive(Clone, Default)]
pub(crate) struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    pub fn set(&self, error: PyErr) {
        if let Ok(mut first) = self.0.lock() {
            first.get_or_insert(error);
        }
    }

    pub fn take(&self) -> Option<PyErr> {
        self.0.lock().ok().and_then(|mut first| first.take())
    }

    pub fn is_set(&self) -> bool {
        self.0.lock().is_ok_and(|first| first.is_some())
    }
}

pub(crate) struct Foreign {
    object: Py<PyAny>,
    raised: Raised,
}

impl Foreign {
    pub fn new(object: Py<PyAny>, raised: Raised) -> Self {
        Foreign { object, raised }
    }

    fn call<T>(
        &self,
        step: &'static str,
        call: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
    ) -> Result<T, LinearError> {
        let failed = LinearError::Backend { backend: "python", step, status: -1 };
        if self.raised.is_set() {
            return Err(failed);
        }
        Python::attach(|py| {
            call(self.object.bind(py)).map_err(|error| {
                if error.is_instance_of::<PyArithmeticError>(py) {
                    return LinearError::Singular { pivot_ratio: 0.0 };
                }
                self.raised.set(error);
                failed
            })
        })
    }
}

/// Copies what `solve` of a Python object has handed back: an array of float64 with the shape of `x`, or a list of numbers.
fn handed_back(found: &Bound<'_, PyAny>, x: &mut [f64]) -> PyResult<()> {
    let wanted = format!("an array of float64 with the shape ({},) expected", x.len());
    let array = match found.cast::<PyUntypedArray>() {
        Ok(array) => array.clone(),
        Err(_) if found.is_instance_of::<PyList>() => {
            let array = found.py().import("numpy")?.call_method1("asarray", (found,))?;
            array.cast_into::<PyUntypedArray>()?
        }
        Err(_) => {
            let kind = found.get_type().name()?;
            return Err(PyTypeError::new_err(format!("linear.solve: {wanted}, {kind} found")));
        }
    };
    let shape = array.shape().to_vec();
    if let [found] = shape[..]
        && found != x.len()
    {
        return Err(PyValueError::new_err(format!("linear.solve: length {} expected, {found} found", x.len())));
    }
    if shape != [x.len()] {
        return Err(PyValueError::new_err(format!("linear.solve: {wanted}, the shape {shape:?} found")));
    }
    let Ok(values) = array.extract::<Vector<'_>>() else {
        let kind = array.dtype();
        return Err(PyTypeError::new_err(format!("linear.solve: {wanted}, {kind} found")));
    };
    x.iter_mut().zip(values.as_array()).for_each(|(x, value)| *x = *value);
    Ok(())
}

impl LinearSolver for Foreign {
    fn name(&self) -> &'static str {
        "python"
    }

    fn analyze(&mut self, pattern: &Arc<Pattern>) -> Result<(), LinearError> {
        self.call("analyze", |object| {
            let py = object.py();
            let starts = PyArray1::from_slice(py, pattern.column_starts());
            let rows = PyArray1::from_slice(py, pattern.row_indices());
            object.call_method1("analyze", (pattern.columns(), starts, rows)).map(drop)
        })
    }

    fn factorize(&mut self, values: &[f64]) -> Result<FactorInfo, LinearError> {
        self.call("factorize", |object| {
            object.call_method1("factorize", (PyArray1::from_slice(object.py(), values),)).map(drop)
        })?;
        Ok(FactorInfo { pivot_ratio: 1.0, ..FactorInfo::default() })
    }

    fn solve(&mut self, b: &[f64], x: &mut [f64]) -> Result<(), LinearError> {
        self.call("solve", |object| {
            let found = object.call_method1("solve", (PyArray1::from_slice(object.py(), b),))?;
            handed_back(&found, x)
        })
    }
}
