//! Why arrays make no matrix.

/// Why arrays make no matrix, or do not fit one. Rows, columns and places in arrays are counted from 0.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixError {
    /// An entry stands below the last row.
    #[error("an entry stands in row {row} of a matrix with {rows} rows: rows are counted from 0")]
    Row {
        /// Its row.
        row: usize,
        /// How many there are.
        rows: usize,
    },
    /// An entry stands beyond the last column.
    #[error(
        "an entry of row {row} stands in column {column} of a matrix with {columns} columns: columns are counted from 0"
    )]
    Column {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// How many there are.
        columns: usize,
    },
    /// An array has another length than the others ask for.
    #[error("{what}: expected {expected} entries, got {found}")]
    Length {
        /// The array.
        what: &'static str,
        /// The length it must have.
        expected: usize,
        /// The length it has.
        found: usize,
    },
    /// The starts of compressed columns do not begin at 0, or fall.
    #[error("the starts of the columns must begin with 0 and never fall, but start {place} is {start}")]
    Starts {
        /// Its place in the array.
        place: usize,
        /// What stands there.
        start: usize,
    },
    /// An entry is NaN or infinite.
    #[error("the entry ({row}, {column}) is {value}, but must be finite")]
    NotFinite {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// There is no memory for so many columns, or no index for so many rows.
    #[error("a matrix of {rows} × {columns} has no room in memory")]
    TooLarge {
        /// The rows asked for.
        rows: usize,
        /// The columns asked for.
        columns: usize,
    },
    /// A matrix that must be square is not.
    #[error("the matrix is {rows} × {columns}, but must be square")]
    NotSquare {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// The triangles of a matrix that must be symmetric differ.
    #[error("the matrix is not symmetric: ({row}, {column}) is {lower:e} and ({column}, {row}) is {upper:e}")]
    NotSymmetric {
        /// The row of the entry below the diagonal.
        row: usize,
        /// Its column.
        column: usize,
        /// The entry below the diagonal.
        lower: f64,
        /// The one above it.
        upper: f64,
    },
    /// A lower triangle has an entry above the diagonal.
    #[error("the entry ({row}, {column}) stands above the diagonal of a lower triangle")]
    AboveDiagonal {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// There is no place for an entry.
    #[error("the pattern has no entry ({row}, {column})")]
    NotStored {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// The entries were other ones when they were named for the second time.
    #[error("the entries of column {column} were other ones when they were named for the second time")]
    Unsteady {
        /// A column where they differed.
        column: usize,
    },
    /// A text is no matrix in the Matrix Market format.
    #[error("Matrix Market, line {line}: {message}")]
    Text {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
}

/// An error unless both lengths agree.
pub(super) fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), MatrixError> {
    if expected == found { Ok(()) } else { Err(MatrixError::Length { what, expected, found }) }
}
