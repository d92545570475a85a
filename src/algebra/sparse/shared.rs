//! Symmetric matrices of which several processes have the rows, each those at nodes of its own. What the first process has of one is seldom
//! an entry: it multiplies.

use std::any::Any;
use std::fmt;
use std::sync::Arc;

use super::{Csc, DoubleDouble};

/// A symmetric matrix of finite elements whose rows several processes have. What cannot be done as they do not answer is NaN: the
/// error comes with the next thing that returns one.
pub trait SharedMatrix: Any + fmt::Debug + Send + Sync {
    /// The order.
    fn order(&self) -> usize;

    /// The process that has the rows at this node of the mesh, from 0; none where there are no rows.
    fn owner(&self, node: usize) -> Option<usize>;

    /// `y = A x`.
    fn mul(&self, x: &[f64], y: &mut [f64]);

    /// `y = A x` and `sizes = |A| |x|`.
    fn products(&self, x: &[f64], y: &mut [f64], sizes: &mut [f64]);

    /// Adds `factor A (x + rest)` to `sums`, in twice the working precision.
    fn add_beyond(&self, factor: f64, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]);

    /// The diagonal.
    fn diagonal(&self) -> &[f64];

    /// The largest size in each row.
    fn row_norms(&self) -> &[f64];

    /// The columns that this process has, whole; of the others none is stored.
    fn near(&self) -> &Csc;

    /// The entry at `(row, column)`.
    fn get(&self, row: usize, column: usize) -> f64;

    /// The lower triangle, all in this process, which is to be avoided.
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
    /// What is shared.
    pub fn matrix(&self) -> &dyn SharedMatrix {
        &*self.matrix
    }

    /// What it is multiplied by.
    pub fn factor(&self) -> f64 {
        self.factor
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.matrix.order()
    }

    /// The process that has the rows at this node of the mesh, from 0; none where there are no rows.
    pub fn owner(&self, node: usize) -> Option<usize> {
        self.matrix.owner(node)
    }

    /// The same matrix, times `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        SharedSymmetric { matrix: Arc::clone(&self.matrix), factor: factor * self.factor }
    }

    /// The entry at `(row, column)`; there is none outside.
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

    /// The columns that this process has, whole.
    pub(crate) fn near(&self) -> Csc {
        self.times_factor(self.matrix.near().clone())
    }

    /// The lower triangle, all in this process.
    pub(crate) fn lower(&self) -> Csc {
        self.times_factor(self.matrix.lower())
    }

    fn times_factor(&self, mut matrix: Csc) -> Csc {
        matrix.values_mut().iter_mut().for_each(|value| *value *= self.factor);
        matrix
    }

    /// The diagonal.
    pub(crate) fn diagonal(&self) -> Vec<f64> {
        self.matrix.diagonal().iter().map(|value| self.factor * value).collect()
    }

    /// The largest size in each row.
    pub(crate) fn row_norms(&self) -> impl Iterator<Item = f64> + '_ {
        self.matrix.row_norms().iter().map(|norm| self.factor.abs() * norm)
    }

    /// `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.mul(x, y);
        for y in y {
            *y *= self.factor;
        }
    }

    /// `y += |A| |x|`.
    pub(crate) fn add_sizes(&self, x: &[f64], y: &mut [f64]) {
        let (mut product, mut sizes) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        self.matrix.products(x, &mut product, &mut sizes);
        y.iter_mut().zip(sizes).for_each(|(y, size)| *y += self.factor.abs() * size);
    }

    /// `r -= A x` and `s += |A| |x|`.
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
