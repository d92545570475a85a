//! Dense kernels: `L Lᵀ`, and LU with partial pivoting.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, MatMut, MatRef, Par};

use crate::algebra::linear::{Computed, LinearError};
use crate::algebra::sparse::mirror;

/// The order below which a factorisation takes less than a few milliseconds, so that waiting for other threads costs
/// more than they save.
const PARALLEL_ORDER: usize = 400;

/// Returns the number of threads for a matrix of this order.
pub(super) fn threads(order: usize) -> usize {
    if order < PARALLEL_ORDER { 1 } else { rayon::current_num_threads() }
}

/// Returns the number of threads in faer's terms.
fn parallelism(order: usize) -> Par {
    match threads(order) {
        1 => Par::Seq,
        several => Par::rayon(several),
    }
}

/// Returns `L Lᵀ` for the lower triangle `l`, m × m, column by column. The result has both triangles.
pub(crate) fn times_transposed(l: &[f64], m: usize) -> Vec<f64> {
    let l = MatRef::from_column_major_slice(l, m, m);
    let mut product = vec![0.0; m * m];
    let to = MatMut::from_column_major_slice_mut(&mut product, m, m);
    let (lower, upper) = (BlockStructure::TriangularLower, BlockStructure::TriangularUpper);
    matmul(to, lower, Accum::Replace, l, lower, l.transpose(), upper, 1.0, parallelism(m));
    mirror(&mut product, m);
    product
}

/// A pivot below this size, relative to the diagonal entry that it came from, may be mere rounding. The diagonal of a
/// Schur complement is about a quarter of the original one. (Unsupported bodies have pivots of 2e-14, slender ones of
/// 1e-12.)
const PIVOT_ROUNDING: f64 = 256.0 * f64::EPSILON;

/// The factors of `P A = L U`.
#[derive(Debug)]
pub struct Lu {
    /// `L` below its unit diagonal, and `U`.
    factors: Mat<f64>,
    /// The permutation: row `k` of `P A` is row `permutation[k]` of `A`.
    permutation: Vec<usize>,
    pivot_ratio: f64,
}

impl Lu {
    /// Factors the square matrix `a`. Its columns were computed from numbers of these `sizes`, so that rounding turns
    /// zero pivots into pivots of about `ε size`.
    ///
    /// # Errors
    /// [`LinearError::Singular`] if a pivot vanishes or may be mere rounding, which faer does not check;
    /// [`LinearError::NotFinite`] if an entry is not finite; [`LinearError::Shape`] unless `a` is square and has as
    /// many sizes as columns.
    pub fn new(mut a: Mat<f64>, sizes: &[f64]) -> Computed<Self> {
        let n = a.nrows();
        for (what, found) in [("columns", a.ncols()), ("sizes", sizes.len())] {
            if found != n {
                return Err(LinearError::Shape { what, expected: n, found });
            }
        }
        if !a.is_all_finite() {
            return Err(LinearError::NotFinite);
        }
        let (mut permutation, mut inverse) = (vec![0_usize; n], vec![0_usize; n]);
        if n > 0 {
            let par = parallelism(n);
            let mut memory = MemBuffer::new(lu_in_place_scratch::<usize, f64>(n, n, par, faer::Spec::default()));
            let stack = MemStack::new(&mut memory);
            lu_in_place(a.as_mut(), &mut permutation, &mut inverse, par, stack, faer::Spec::default());
        }
        let mut pivot_ratio = 1.0_f64;
        for (k, size) in sizes.iter().enumerate() {
            // After a zero pivot faer continues with NaN, as from 0 / 0.
            let ratio = a[(k, k)].abs() / size;
            pivot_ratio = pivot_ratio.min(if ratio.is_finite() { ratio } else { 0.0 });
        }
        if pivot_ratio <= PIVOT_ROUNDING {
            return Err(LinearError::Singular { pivot_ratio });
        }
        Ok(Lu { factors: a, permutation, pivot_ratio })
    }

    /// Returns the memory of the factors.
    pub(super) fn into_memory(self) -> Mat<f64> {
        self.factors
    }

    /// Returns the order.
    pub(super) fn order(&self) -> usize {
        self.permutation.len()
    }

    /// Returns the smallest pivot relative to the size of its column.
    pub(in crate::algebra::linear) fn pivot_ratio(&self) -> f64 {
        self.pivot_ratio
    }

    /// Solves `A x = b`.
    ///
    /// # Errors
    /// [`LinearError::Shape`] if `b` does not have the order of `A`.
    pub fn solution(&self, b: &[f64]) -> Computed<Vec<f64>> {
        if b.len() != self.order() {
            return Err(LinearError::Shape { what: "b", expected: self.order(), found: b.len() });
        }
        Ok(self.solve(b))
    }

    /// Solves `A x = b`, where `b` has the order of `A`.
    pub(crate) fn solve(&self, b: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = self.permutation.iter().map(|&row| b[row]).collect();
        for column in 0..x.len() {
            let (head, below) = x.split_at_mut(column + 1);
            let factors = &self.factors.col_as_slice(column)[column + 1..];
            below.iter_mut().zip(factors).for_each(|(x, l)| *x -= l * head[column]);
        }
        for column in (0..x.len()).rev() {
            let (above, rest) = x.split_at_mut(column);
            let factors = self.factors.col_as_slice(column);
            rest[0] /= factors[column];
            above.iter_mut().zip(factors).for_each(|(x, u)| *x -= u * rest[0]);
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_a_triangle() {
        // L = [1 0; 2 3]
        let s = times_transposed(&[1.0, 2.0, 0.0, 3.0], 2);
        assert_eq!(s, [1.0, 2.0, 2.0, 13.0]);
        assert!(times_transposed(&[], 0).is_empty());
    }

    #[test]
    fn rows_are_exchanged() {
        for n in [1, 2, 7, 40, 130] {
            // Zeros on the diagonal where possible.
            let a =
                Mat::from_fn(n, n, |i, j| if i == j && n > 1 { 0.0 } else { 1.0 / (1.0 + i as f64 + 2.0 * j as f64) });
            let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let product = |x: &[f64]| -> Vec<f64> {
                (0..n).map(|i| x.iter().enumerate().map(|(j, x)| a[(i, j)] * x).sum()).collect()
            };
            let b = product(&x);
            let lu = Lu::new(a.clone(), &vec![1.0; n]).unwrap();
            assert_eq!(lu.order(), n);
            let found = product(&lu.solve(&b));
            assert!(found.iter().zip(&b).all(|(found, b)| (found - b).abs() < 1e-13), "{n}: {found:?}");
        }
        assert_eq!(Lu::new(Mat::zeros(0, 0), &[]).unwrap().pivot_ratio(), 1.0);
    }

    #[test]
    fn bad_pivots_are_errors() {
        let of = |values: [f64; 4]| Lu::new(Mat::from_fn(2, 2, |i, j| values[2 * i + j]), &[2.0, 4.0]).err();
        let singular = |error| assert!(matches!(error, Some(LinearError::Singular { .. })), "{error:?}");
        singular(of([1.0, 2.0, 2.0, 4.0]));
        singular(of([0.0; 4]));
        singular(of([1.0, 0.1, 0.3, 0.03]));
        // Rounding of numbers that have cancelled.
        singular(Lu::new(Mat::from_fn(1, 1, |_, _| 1e-17), &[1.0]).err());
        assert_eq!(of([f64::NAN, 2.0, 2.0, 4.0]), Some(LinearError::NotFinite));
        assert_eq!(of([1.0, 2.0, 2.0, 4.5]), None);
    }
}
