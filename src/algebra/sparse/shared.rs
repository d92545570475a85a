//! Symmetric matrices whose rows are distributed among several processes, by nodes. The first process has few of the
//! entries, and uses the matrix mainly in products.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use super::{Csc, DoubleDouble};

/// A symmetric finite element matrix with rows on several processes. If a process fails, results are NaN; the error
/// is reported by the next fallible call.
pub trait SharedMatrix: Any + fmt::Debug + Send + Sync {
    /// Returns the order.
    fn order(&self) -> usize;

    /// Returns the process that has the rows of this mesh node, from 0, or `None` if the node has no rows.
    fn owner(&self, node: usize) -> Option<usize>;

    /// Computes `y = A x`.
    fn mul(&self, x: &[f64], y: &mut [f64]);

    /// Computes `y = A x` and `sizes = |A| |x|`.
    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]);

    /// Adds `factor A (x + rest)` to `sums`, in twice the working precision.
    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]);

    /// Returns the diagonal.
    fn diagonal(&self) -> &[f64];

    /// Returns the largest absolute value in each row.
    fn row_norms(&self) -> &[f64];

    /// Returns the columns stored in this process, with both triangles; all others are empty.
    fn near(&self) -> &Csc;

    /// Returns the entry at `(row, column)`.
    fn get(&self, row: usize, column: usize) -> f64;

    /// Returns the lower triangle, gathered in this process, which should be avoided.
    fn lower(&self) -> Csc;
}

/// A shared matrix times a factor.
#[derive(Debug, Clone)]
pub struct SharedSymmetric {
    matrix: Arc<dyn SharedMatrix>,
    factor: f64,
}

impl From<Arc<dyn SharedMatrix>> for SharedSymmetric {
    fn from(matrix: Arc<dyn SharedMatrix>) -> Self {
        SharedSymmetric { matrix, factor: 1.0 }
    }
}

impl SharedSymmetric {
    /// Returns the shared matrix.
    pub fn matrix(&self) -> &dyn SharedMatrix {
        &*self.matrix
    }

    /// Returns the factor of the shared matrix.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// Returns the order.
    pub fn order(&self) -> usize {
        self.matrix.order()
    }

    /// Returns the process that has the rows of this mesh node, from 0, or `None` if the node has no rows.
    pub fn owner(&self, node: usize) -> Option<usize> {
        self.matrix.owner(node)
    }

    /// Returns the matrix times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        SharedSymmetric { matrix: Arc::clone(&self.matrix), factor: factor * self.factor }
    }

    /// Returns the entry at `(row, column)`, or 0 outside the matrix.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let matrix = self.matrix();
        let stored = |row: usize, column: usize| matrix.near().pattern().slot(row, column);
        let value = if row.max(column) >= matrix.order() {
            0.0
        } else if row == column {
            matrix.diagonal()[row]
        } else if let Some(slot) = stored(row, column).or_else(|| stored(column, row)) {
            matrix.near().values()[slot]
        } else {
            matrix.get(row, column)
        };
        self.factor * value
    }

    /// Returns the columns stored in this process, with both triangles.
    pub(crate) fn near(&self) -> Csc {
        self.times_factor(self.matrix.near().clone())
    }

    /// Returns the lower triangle, gathered in this process.
    pub(crate) fn lower(&self) -> Csc {
        self.times_factor(self.matrix.lower())
    }

    fn times_factor(&self, mut matrix: Csc) -> Csc {
        matrix.values_mut().iter_mut().for_each(|value| *value *= self.factor);
        matrix
    }

    /// Returns the diagonal.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        self.matrix.diagonal().iter().map(|value| self.factor * value).collect()
    }

    /// Returns the largest absolute value in each row.
    pub(crate) fn row_norms(&self) -> impl Iterator<Item = f64> + '_ {
        self.matrix.row_norms().iter().map(|norm| self.factor.abs() * norm)
    }

    /// Computes `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.mul(x, y);
        for y in y {
            *y *= self.factor;
        }
    }

    /// Computes `y += |A| |x|`.
    pub(crate) fn add_sizes(&self, x: &[f64], y: &mut [f64]) {
        let (mut product, mut sizes) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.matrix.products(x, &mut product, &mut sizes);
        y.iter_mut().zip(sizes).for_each(|(y, size)| *y += self.factor.abs() * size);
    }

    /// Computes `r -= A x` and `s += |A| |x|`.
    pub(crate) fn residual(&self, x: &[f64], r: &mut [f64], s: &mut [f64]) {
        let (mut product, mut sizes) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.matrix.products(x, &mut product, &mut sizes);
        r.iter_mut().zip(product).for_each(|(r, y)| *r -= self.factor * y);
        s.iter_mut().zip(sizes).for_each(|(s, size)| *s += self.factor.abs() * size);
    }

    /// Adds `A (x + rest)` to `sums`, in twice the working precision.
    pub(crate) fn add_beyond(&self, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) {
        self.matrix.add_beyond(self.factor, x, rest, sums);
    }
}
