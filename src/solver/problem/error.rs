//! The errors of arrays that do not make a contact problem, or do not fit one.

use crate::algebra::linear::LinearError;

/// The reason why arrays do not make a contact problem, or do not fit one. Messages name arrays as in
/// [`super::Parts`], [`super::Increment`], [`super::State`] and [`crate::solver::loading::Loading`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// There is no displacement to solve for.
    #[error("stiffness is of order 0: a problem needs a displacement")]
    Empty,
    /// An array has another length than the others require.
    #[error("{array} has {found} {of}, but must have {expected}, {reason}")]
    Length {
        /// The name of the array.
        array: String,
        /// The unit of the length: entries, rows or columns.
        of: &'static str,
        /// The required length.
        expected: usize,
        /// The given length.
        found: usize,
        /// The reason for the required length.
        reason: &'static str,
    },
    /// A number is out of the range of its array.
    #[error("{array} is {value}, but must be {must}")]
    Value {
        /// The name of the array, with the index.
        array: String,
        /// The given number.
        value: f64,
        /// The admissible numbers.
        must: &'static str,
    },
    /// A displacement has negative energy in the stiffness.
    #[error(
        "stiffness is not positive semidefinite: its entries ({row}, {row}) = {first:e}, ({row}, {column}) = {between:e} and ({column}, {column}) = {second:e} give a displacement negative energy"
    )]
    Indefinite {
        /// The row.
        row: usize,
        /// The column; equal to the row if the diagonal entry is negative.
        column: usize,
        /// `K_ii`.
        first: f64,
        /// `K_ij`.
        between: f64,
        /// `K_jj`.
        second: f64,
    },
    /// A displacement has negative energy, although no 2 × 2 block shows it.
    #[error(
        "stiffness is not positive semidefinite: some displacement takes energy out of it; look for a wrong sign in what it was assembled from"
    )]
    NotSemidefinite,
    /// The stiffness resists a motion that is given as a rigid mode.
    #[error(
        "rigid_modes[{motion}] is no rigid mode: the stiffness resists it with a force in row {row}, {share:.1e} of the sizes of its terms"
    )]
    Resisted {
        /// The index of the mode.
        motion: usize,
        /// The row with the largest force.
        row: usize,
        /// The force relative to the sum of the sizes of the products behind it.
        share: f64,
    },
    /// A rigid mode is a linear combination of those before it.
    #[error("rigid_modes[{motion}] is zero or a combination of the modes before it: a basis has independent modes")]
    Dependent {
        /// The index of the mode.
        motion: usize,
    },
    /// The points or ends of a history do not increase.
    #[error("{array} goes from {before} to {after}, but must increase")]
    Order {
        /// The name of the array, with the index.
        array: String,
        /// A time, s.
        before: f64,
        /// The next time, s.
        after: f64,
    },
    /// An array is empty.
    #[error("{array} is empty")]
    Nothing {
        /// The name of the array.
        array: String,
    },
    /// The rigid modes could not be computed from the stiffness, or a rank that shares the stiffness has failed.
    #[error("the stiffness cannot be worked with: {0}")]
    Linear(#[from] LinearError),
}

/// Returns an error unless an array has the expected length.
pub(crate) fn expect_length(
    array: impl Into<String>,
    expected: usize,
    found: usize,
    reason: &'static str,
) -> Result<(), ProblemError> {
    if expected == found {
        return Ok(());
    }
    Err(ProblemError::Length { array: array.into(), of: "entries", expected, found, reason })
}

/// Returns an error for the first of `values` that is not `is_valid`; `array` is their name.
pub(crate) fn expect_each(
    array: &str,
    values: &[f64],
    must: &'static str,
    is_valid: impl Fn(f64) -> bool,
) -> Result<(), ProblemError> {
    match values.iter().position(|&value| !is_valid(value)) {
        Some(k) => Err(ProblemError::Value { array: format!("{array}[{k}]"), value: values[k], must }),
        None => Ok(()),
    }
}

/// Returns an error unless the `value` called `name` `is_valid`.
pub(crate) fn expect_value(
    name: &str,
    value: f64,
    must: &'static str,
    is_valid: impl Fn(f64) -> bool,
) -> Result<(), ProblemError> {
    if is_valid(value) { Ok(()) } else { Err(ProblemError::Value { array: name.to_string(), value, must }) }
}

/// Returns an error for the first of `values` that is NaN or infinite.
pub(crate) fn expect_finite(array: &str, values: &[f64]) -> Result<(), ProblemError> {
    expect_each(array, values, "finite", f64::is_finite)
}

/// Returns an error unless the points `[time, value]` of a history are finite, and their times increase.
pub(crate) fn expect_history(array: &str, points: &[[f64; 2]]) -> Result<(), ProblemError> {
    points.iter().enumerate().try_for_each(|(k, point)| expect_finite(&format!("{array}[{k}]"), point))?;
    expect_increasing(array, points.iter().map(|point| point[0]))
}

/// Returns an error unless the times increase.
pub(crate) fn expect_increasing(array: &str, times: impl Iterator<Item = f64>) -> Result<(), ProblemError> {
    let mut last: Option<f64> = None;
    for (k, time) in times.enumerate() {
        match last {
            Some(before) if time <= before => {
                return Err(ProblemError::Order { array: format!("{array}[{k}]"), before, after: time });
            }
            _ => last = Some(time),
        }
    }
    Ok(())
}
