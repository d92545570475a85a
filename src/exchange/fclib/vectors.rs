//! Datasets of numbers as FCLIB needs them: there, of the right length, finite.

use crate::exchange::Hdf5Error;
use crate::exchange::error::of_dataset;
use crate::fault::Fault;

/// The values of the dataset at `path`, which must be there.
pub(super) fn need<T>(path: &str, read: Result<Option<T>, Hdf5Error>) -> Result<T, Fault> {
    match read {
        Ok(Some(values)) => Ok(values),
        Ok(None) => Err(Fault::new(format!("dataset {path}"), "it is not there", "write it, as FCLIB does")),
        Err(error) => Err(of_dataset(path, &error)),
    }
}

/// The fault of the dataset at `path` that has `found` values where `expected` are needed, and why.
pub(super) fn length(path: &str, expected: usize, found: usize, why: &str) -> Fault {
    let message = format!("it has {found} values, but must have {expected}: {why}");
    Fault::new(format!("dataset {path}"), message, "mend the sizes, which contradict each other")
}

/// The `values`, if all of them are finite.
pub(super) fn finite(path: &str, values: Vec<f64>) -> Result<Vec<f64>, Fault> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(values),
        Some(place) => {
            let message = format!("value {place} is {}, but must be finite", values[place]);
            Err(Fault::new(format!("dataset {path}"), message, "give a number other than nan or inf"))
        }
    }
}
