//! Sparse matrices: an immutable [`Pattern`] that many value arrays share, compressed columns ([`Csc`]) for
//! factorisations, half of them ([`Symmetric`]) for the stiffness, compressed rows ([`Csr`]) for the short rows of
//! the contact maps. The stiffness of a condensed body is dense ([`DenseSymmetric`]).
//!
//! All fields are private, and every constructor returns a [`MatrixError`] for inconsistent input, because the direct
//! solvers, some of them in C, rely on the lengths in these arrays.
//!
//! ```
//! use stickslip::algebra::{Csr, MatrixError, Symmetric};
//!
//! let k = Symmetric::from_triplets(2, &[(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0)])?;
//! assert_eq!(k.get(0, 1), -1.0);
//! let c_n = Csr::from_rows(2, [[(1, -1.0)]])?;
//! assert_eq!(c_n.rows(), 1);
//! assert!(matches!(Csr::from_rows(2, [[(2, 1.0)]]), Err(MatrixError::Column { column: 2, columns: 2, .. })));
//! # Ok::<(), MatrixError>(())
//! ```

mod csc;
mod csr;
mod dense;
mod double_double;
mod pattern;
mod symmetric;

pub use csc::Csc;
pub use csr::Csr;
pub use dense::DenseSymmetric;
pub(crate) use dense::mirror;
pub use double_double::{DoubleDouble, sum};
pub use pattern::Pattern;
pub use symmetric::Symmetric;

/// A source of the rows of a symmetric matrix at any selection of mesh nodes.
pub trait NodeRows: std::fmt::Debug + Send + Sync {
    /// Returns the dimension, 2 or 3, which is the largest number of rows of a node.
    fn dimension(&self) -> usize;

    /// Returns the number of nodes.
    fn nodes(&self) -> usize;

    /// Returns the number of rows.
    fn order(&self) -> usize;

    /// Returns the rows of `node`, by their direction.
    fn places(&self, node: usize) -> [Option<usize>; 3];

    /// Calls `take` with the nodes of each cell. Rows of nodes without a common cell have no entries for each other.
    fn each_cell(&self, take: &mut dyn FnMut(&[usize]));

    /// Returns a number that is equal for two sources only if their matrices are equal.
    fn fingerprint(&self) -> u64;

    /// Assembles all entries whose row or column is at `nodes`, or returns `None` if that is not possible.
    fn rows(&self, nodes: &[bool]) -> Option<Symmetric>;
}

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
fn expect_length(what: &'static str, expected: usize, found: usize) -> Result<(), MatrixError> {
    if expected == found { Ok(()) } else { Err(MatrixError::Length { what, expected, found }) }
}
