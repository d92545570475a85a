//! Matrices whose entries do not fit, or are no numbers, or ask for more memory than there is.

use crate::common::prelude::*;
use stickslip::algebra::MatrixError;
use stickslip::algebra::linear::{Cholesky, backward_error};

/// Patterns whose entries are outside never reach a direct solver, nor values of another number (R2).
#[test]
fn no_array_is_read_by_a_length_it_does_not_have() {
    let outside = Symmetric::from_entries(50, |take| (0..50).for_each(|i| take(i + 60, i)));
    assert!(matches!(outside, Err(MatrixError::Row { row: 60, rows: 50 })));
    let calls = std::cell::Cell::new(0);
    let unsteady = Pattern::from_entries(3, 3, |take| {
        calls.set(calls.get() + 1);
        (0..calls.get()).for_each(|i| take(i, 0));
    });
    assert_eq!(unsteady.unwrap_err(), MatrixError::Unsteady { column: 0 });
    let pattern = std::sync::Arc::new(Pattern::from_entries(2, 2, |take| take(1, 0)).unwrap());
    assert!(Csc::new(pattern.clone(), vec![1.0; 3]).is_err());
    assert!(Symmetric::from_lower(Csc::zeros(pattern)).is_ok());
    let above = Csc::from_triplets(2, 2, &[(0, 1, 1.0)]).unwrap();
    assert_eq!(Symmetric::from_lower(above).unwrap_err(), MatrixError::AboveDiagonal { row: 0, column: 1 });
    let mut k = Symmetric::from_triplets(2, &[(0, 0, 1.0)]).unwrap();
    assert_eq!(k.add(1, 0, 1.0), Err(MatrixError::NotStored { row: 1, column: 0 }));
    // Not positive definite, and said so.
    assert!(matches!(Cholesky::factor(&k, &[]), Err(LinearError::Singular { .. } | LinearError::NotBuiltIn { .. })));
}

/// Vectors of other lengths have no backward error, and sums of entries are entries.
#[test]
fn products_fit() {
    let a = SystemMatrix::from(Csc::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 4.0)]).unwrap());
    assert_eq!(backward_error(&a, &[1.0, 4.0], &[1.0, 1.0]).unwrap(), 0.0);
    for (b, x) in [(&[1.0][..], &[1.0, 1.0][..]), (&[1.0, 4.0], &[1.0])] {
        assert!(matches!(backward_error(&a, b, x), Err(LinearError::Shape { .. })));
    }
    let mut k = Symmetric::from_triplets(1, &[(0, 0, 1e308)]).unwrap();
    for value in [f64::NAN, f64::INFINITY, 1e308] {
        assert!(matches!(k.add(0, 0, value), Err(MatrixError::NotFinite { .. })));
    }
    assert_eq!(k.get(0, 0), 1e308);
}

/// Two entries in one place are added, and the sum is an entry, too.
#[test]
fn sums_of_entries_are_finite() {
    let twice = |value: f64| Csr::from_rows(2, [[(1, value), (1, value)]]);
    assert_eq!(twice(1e308).unwrap_err(), MatrixError::NotFinite { row: 0, column: 1, value: f64::INFINITY });
    assert_eq!(twice(0.5).unwrap().row(0), [(1, 1.0)]);
}

/// What is too large is refused before memory is taken, whoever announced it.
#[test]
fn matrices_without_room() {
    for columns in [usize::MAX, 1 << 60] {
        assert_eq!(Csc::from_triplets(2, columns, &[]).unwrap_err(), MatrixError::TooLarge { rows: 2, columns });
    }
    assert!(matches!(Csc::from_triplets(usize::MAX, 2, &[]), Err(MatrixError::TooLarge { .. })));
    assert!(matches!(Symmetric::from_triplets(usize::MAX, &[]), Err(MatrixError::TooLarge { .. })));
    for rows in [1 << 50, usize::MAX] {
        assert_eq!(Csr::empty(rows, 2).unwrap_err(), MatrixError::TooLarge { rows, columns: 2 });
    }
}
