//! Datasets as FCLIB requires them: existing, of the right length, finite. Lengths are compared with the problem before
//! anything is read.

use crate::error::of_dataset;
use crate::hdf5::{Dataset, File};
use stickslip::base::InputError;

/// Returns the dataset at `path` if it exists and was written.
pub(super) fn written(file: &File, path: &str) -> Result<Option<Dataset>, InputError> {
    let dataset = file.dataset(path).map_err(|error| of_dataset(path, &error))?;
    Ok(dataset.filter(Dataset::is_written))
}

/// Returns the dataset at `path`, which must exist.
pub(super) fn need(file: &File, path: &str) -> Result<Dataset, InputError> {
    match file.dataset(path).map_err(|error| of_dataset(path, &error))? {
        Some(dataset) => Ok(dataset),
        None => Err(InputError::new(format!("dataset {path}"), "it is missing", "write it, as FCLIB does")),
    }
}

/// Returns an error unless `dataset`, at `path`, has `expected` values, for the reason `why`.
pub(super) fn has_length(dataset: &Dataset, path: &str, expected: usize, why: &str) -> Result<(), InputError> {
    if dataset.count() == expected { Ok(()) } else { Err(length(path, expected, dataset.count(), why)) }
}

/// Returns the one integer at `path`.
pub(super) fn one(file: &File, path: &str) -> Result<i64, InputError> {
    let dataset = need(file, path)?;
    has_length(&dataset, path, 1, "it is one number")?;
    match dataset.integers(1).map_err(|error| of_dataset(path, &error))?[..] {
        [value] => Ok(value),
        ref values => Err(length(path, 1, values.len(), "it is one number")),
    }
}

/// Returns all numbers of `dataset`, at `path`, which must be finite.
pub(super) fn numbers(dataset: &Dataset, path: &str) -> Result<Vec<f64>, InputError> {
    finite(path, dataset.numbers(dataset.count()).map_err(|error| of_dataset(path, &error))?)
}

/// Describes a wrong length of the dataset at `path`, with the reason `why` it must be `expected`.
pub(super) fn length(path: &str, expected: usize, found: usize, why: &str) -> InputError {
    let message = format!("it has {found} values, but must have {expected}: {why}");
    InputError::new(format!("dataset {path}"), message, "correct the sizes, which contradict each other")
}

/// Returns the `values` if all of them are finite.
pub(super) fn finite(path: &str, values: Vec<f64>) -> Result<Vec<f64>, InputError> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(values),
        Some(place) => {
            let message = format!("value {place} is {}, but must be finite", values[place]);
            Err(InputError::new(format!("dataset {path}"), message, "give a number other than nan or inf"))
        }
    }
}
