//! Why arrays make no local problem, or do not fit one.

/// Why arrays make no local problem, or do not fit one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocalProblemError {
    /// Neither the plane nor space.
    #[error("dimension is {dimension}, but must be 2 (plane) or 3 (space)")]
    Dimension {
        /// What was given.
        dimension: usize,
    },
    /// An array has another length than the number of contacts asks for.
    #[error("{array}: there are {found}, but must be {expected}, one for each direction of each contact in mu")]
    Length {
        /// The array.
        array: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A number of a vector is NaN or infinite.
    #[error("{array}[{place}] is {value}, but must be finite")]
    NotFinite {
        /// The array.
        array: &'static str,
        /// Where in it.
        place: usize,
        /// What stands there.
        value: f64,
    },
    /// An entry of the Delassus matrix is NaN or infinite.
    #[error("the entry ({row}, {column}) of the Delassus matrix is {value}, but must be finite")]
    Entry {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// What stands there.
        value: f64,
    },
    /// A coefficient of friction is negative, NaN or infinite.
    #[error("mu[{place}] is {value}, but must be finite, and 0 or more")]
    Friction {
        /// The contact.
        place: usize,
        /// What stands there.
        value: f64,
    },
    /// A setting that no method can work with.
    #[error("{setting} is {value}, but must be {must}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// What was given.
        value: f64,
        /// What may be given.
        must: &'static str,
    },
}

/// An error unless there are as many as `expected`.
pub(super) fn expect_length(array: &'static str, expected: usize, found: usize) -> Result<(), LocalProblemError> {
    if found == expected { Ok(()) } else { Err(LocalProblemError::Length { array, expected, found }) }
}

/// An error unless all `values` are finite.
pub(super) fn expect_finite(array: &'static str, values: &[f64]) -> Result<(), LocalProblemError> {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((place, &value)) => Err(LocalProblemError::NotFinite { array, place, value }),
        None => Ok(()),
    }
}
