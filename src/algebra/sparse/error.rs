//! The errors of arrays that do not make a matrix.

/// The reason why arrays do not make a matrix, or do not fit one. Rows, columns and places in arrays are counted from
/// 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// An entry is below the last row.
    #[error("an entry stands in row {row} of a matrix with {rows} rows: rows are counted from 0")]
    Row {
        /// The row of the entry.
        row: usize,
        /// The number of rows.
        rows: usize,
    },
    /// An entry is beyond the last column.
    #[error(
        "an entry of row {row} stands in column {column} of a matrix with {columns} columns: columns are counted from 0"
    )]
    Column {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
        /// The number of columns.
        columns: usize,
    },
    /// An array has another length than the others require.
    #[error("{what}: expected {expected} entries, got {found}")]
    Length {
        /// The name of the array.
        what: &'static str,
        /// The required length.
        expected: usize,
        /// The given length.
        found: usize,
    },
    /// The starts of compressed columns do not begin at 0, or decrease.
    #[error("the starts of the columns must begin with 0 and never fall, but start {place} is {start}")]
    Starts {
        /// The index in the array.
        place: usize,
        /// The value there.
        start: usize,
    },
    /// An entry is NaN or infinite.
    #[error("the entry ({row}, {column}) is {value}, but must be finite")]
    NotFinite {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
        /// The value of the entry.
        value: f64,
    },
    /// There is not enough memory for the columns, or the row indices are too large.
    #[error("a matrix of {rows} × {columns} has no room in memory")]
    TooLarge {
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        columns: usize,
    },
    /// A matrix that must be square is not.
    #[error("the matrix is {rows} × {columns}, but must be square")]
    NotSquare {
        /// The number of rows.
        rows: usize,
        /// The number of columns.
        columns: usize,
    },
    /// The triangles of a matrix that must be symmetric differ.
    #[error("the matrix is not symmetric: ({row}, {column}) is {lower:e} and ({column}, {row}) is {upper:e}")]
    NotSymmetric {
        /// The row of the entry below the diagonal.
        row: usize,
        /// The column of this entry.
        column: usize,
        /// The entry below the diagonal.
        lower: f64,
        /// The entry above the diagonal.
        upper: f64,
    },
    /// A lower triangle has an entry above the diagonal.
    #[error("the entry ({row}, {column}) stands above the diagonal of a lower triangle")]
    AboveDiagonal {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
    },
    /// The pattern has no place for an entry.
    #[error("the pattern has no entry ({row}, {column})")]
    NotStored {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
    },
    /// The two calls of `visit` gave different entries.
    #[error("the entries of column {column} were other ones when they were named for the second time")]
    Unsteady {
        /// A column with different entries.
        column: usize,
    },
}

/// Returns an error unless both lengths agree.
pub(super) fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), MatrixError> {
    if expected == found { Ok(()) } else { Err(MatrixError::Length { what, expected, found }) }
}
