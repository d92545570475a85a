//! The reason why arrays form no local problem, or do not fit one.

/// The reason why arrays form no local problem, or do not fit one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LocalProblemError {
    /// The dimension is neither 2 nor 3.
    #[error("dimension is {dimension}, but must be 2 (plane) or 3 (space)")]
    Dimension {
        /// The given dimension.
        dimension: usize,
    },
    /// The length of an array does not match the number of contacts.
    #[error("{array}: there are {found}, but must be {expected}, one for each direction of each contact in mu")]
    Length {
        /// The array.
        array: &'static str,
        /// The required length.
        expected: usize,
        /// The given length.
        found: usize,
    },
    /// A number of a vector is NaN or infinite.
    #[error("{array}[{place}] is {value}, but must be finite")]
    NotFinite {
        /// The array.
        array: &'static str,
        /// The index.
        place: usize,
        /// The value.
        value: f64,
    },
    /// An entry of the Delassus matrix is NaN or infinite.
    #[error("the entry ({row}, {column}) of the Delassus matrix is {value}, but must be finite")]
    Entry {
        /// The row.
        row: usize,
        /// The column.
        column: usize,
        /// The value.
        value: f64,
    },
    /// A coefficient of friction is negative, NaN or infinite.
    #[error("mu[{place}] is {value}, but must be finite, and 0 or more")]
    Friction {
        /// The index of the contact.
        place: usize,
        /// The value.
        value: f64,
    },
    /// A setting has an invalid value.
    #[error("{setting} is {value}, but must be {must}")]
    Setting {
        /// The setting.
        setting: &'static str,
        /// The given value.
        value: f64,
        /// The allowed values.
        must: &'static str,
    },
}

/// Returns an error unless `found` equals `expected`.
pub(super) fn expect_length(array: &'static str, expected: usize, found: usize) -> Result<(), LocalProblemError> {
    if found == expected { Ok(()) } else { Err(LocalProblemError::Length { array, expected, found }) }
}

/// Returns an error unless all `values` are finite.
pub(super) fn expect_finite(array: &'static str, values: &[f64]) -> Result<(), LocalProblemError> {
    match values.iter().enumerate().find(|(_, value)| !value.is_finite()) {
        Some((place, &value)) => Err(LocalProblemError::NotFinite { array, place, value }),
        None => Ok(()),
    }
}
