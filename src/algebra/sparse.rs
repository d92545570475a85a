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
mod error;
mod node_rows;
mod pattern;
mod symmetric;

pub use csc::Csc;
pub use csr::Csr;
pub use dense::DenseSymmetric;
pub(crate) use dense::mirror;
pub use double_double::{DoubleDouble, sum};
pub use error::MatrixError;
pub use node_rows::NodeRows;
pub use pattern::Pattern;
pub use symmetric::Symmetric;
