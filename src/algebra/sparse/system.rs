//! The matrix of a linear system whose stiffness may be dense, or shared among processes.

use std::borrow::Cow;
use std::sync::Arc;

use super::error::expect_length;
use super::{Csc, DenseSymmetric, DoubleDouble, MatrixError, Pattern, SharedSymmetric, Symmetric};

/// A square sparse matrix whose first rows and columns may contain a dense or shared symmetric block:
///
/// ```text
/// A = [ S 0 ] + R.
///     [ 0 0 ]
/// ```
///
/// `S` is the stiffness of a condensed body, or of a body with rows on several processes. It never changes, and all
/// matrices of a run share its entries. Without `S` the matrix is `R`, in compressed columns.
#[derive(Debug, Clone)]
pub struct SystemMatrix {
    leading: Option<Leading>,
    rest: Csc,
}

/// The block `S`.
#[derive(Debug, Clone)]
enum Leading {
    Dense(DenseSymmetric),
    Shared(SharedSymmetric),
}

impl From<Csc> for SystemMatrix {
    /// Creates a matrix without the block `S`; its factorisation requires a square one.
    fn from(rest: Csc) -> Self {
        SystemMatrix { leading: None, rest }
    }
}

impl SystemMatrix {
    /// Creates the matrix with the dense block `leading`, and `rest` added to it.
    ///
    /// # Errors
    /// If `rest` is not square, or has fewer rows than the block.
    pub fn new(leading: DenseSymmetric, rest: Csc) -> Result<Self, MatrixError> {
        let (rows, columns) = (rest.pattern().rows(), rest.pattern().columns());
        if rows != columns {
            return Err(MatrixError::NotSquare { rows, columns });
        }
        expect_length("rows of the dense block", leading.order().min(rows), leading.order())?;
        Ok(SystemMatrix { leading: Some(Leading::Dense(leading)), rest })
    }

    /// Creates the zero matrix with this pattern, plus `factor` times the stiffness if that is dense or shared. It is
    /// for this crate's own matrices.
    pub(crate) fn of(stiffness: &Symmetric, factor: f64, pattern: Pattern) -> Self {
        let dense = stiffness.dense().map(|dense| Leading::Dense(dense.scaled(factor)));
        let shared = stiffness.shared().map(|shared| Leading::Shared(shared.scaled(factor)));
        SystemMatrix { leading: dense.or(shared), rest: Csc::zeros(Arc::new(pattern)) }
    }

    /// Returns the order.
    pub fn order(&self) -> usize {
        self.rest.pattern().columns()
    }

    /// Returns the dense block `S`.
    pub fn leading(&self) -> Option<&DenseSymmetric> {
        match &self.leading {
            Some(Leading::Dense(dense)) => Some(dense),
            Some(Leading::Shared(_)) | None => None,
        }
    }

    /// Returns the block `S` if processes share it.
    pub fn shared(&self) -> Option<&SharedSymmetric> {
        match &self.leading {
            Some(Leading::Shared(shared)) => Some(shared),
            Some(Leading::Dense(_)) | None => None,
        }
    }

    /// Returns `true` if there is a block `S`.
    pub(crate) fn has_leading(&self) -> bool {
        self.leading.is_some()
    }

    /// Returns `R`, all entries outside the block or added to it.
    pub fn rest(&self) -> &Csc {
        &self.rest
    }

    /// Returns `R` for changing it.
    pub(crate) fn rest_mut(&mut self) -> &mut Csc {
        &mut self.rest
    }

    /// Returns the pattern of [`SystemMatrix::rest`].
    pub fn pattern(&self) -> &Arc<Pattern> {
        self.rest.pattern()
    }

    /// Returns the entry at `(row, column)`, or 0 if it is not stored.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let rest = self.pattern().slot(row, column).map_or(0.0, |slot| self.rest.values()[slot]);
        self.leading.as_ref().map_or(0.0, |leading| leading.get(row, column)) + rest
    }

    /// Iterates over all stored entries as `(row, column, value)`. Entries added to the block are separate.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let shared = self.shared().map(|shared| Symmetric::of_lower(shared.lower()).entries().collect::<Vec<_>>());
        let dense = self.leading().into_iter().flat_map(DenseSymmetric::entries);
        dense.chain(shared.into_iter().flatten()).chain(self.rest.entries())
    }

    /// Returns the matrix in compressed columns.
    pub fn to_csc(&self) -> Cow<'_, Csc> {
        let Some(leading) = &self.leading else { return Cow::Borrowed(&self.rest) };
        let (leading, n, rest) = (leading.whole(), self.order(), &self.rest);
        let mut whole = Csc::zeros(Arc::new(Pattern::of(n, n, |take| {
            leading.entries().chain(rest.entries()).for_each(|(row, column, _)| take(row, column));
        })));
        let (pattern, values) = whole.parts_mut();
        for (row, column, value) in leading.entries().chain(rest.entries()) {
            if let Some(slot) = pattern.slot(row, column) {
                values[slot] += value;
            }
        }
        Cow::Owned(whole)
    }

    /// Computes `A x`.
    ///
    /// # Errors
    /// If the length of `x` differs from the number of columns.
    pub fn times(&self, x: &[f64]) -> Result<Vec<f64>, MatrixError> {
        expect_length("vector", self.order(), x.len())?;
        let mut y = vec![0.0; self.pattern().rows()];
        self.mul(x, &mut y);
        Ok(y)
    }

    /// Computes `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        match &self.leading {
            Some(Leading::Dense(dense)) => dense.mul(&x[..dense.order()], &mut y[..dense.order()]),
            Some(Leading::Shared(shared)) => shared.mul(&x[..shared.order()], &mut y[..shared.order()]),
            None => {}
        }
        self.rest.add_product(x, y);
    }

    /// Computes `r = b - A x` and its scale `s = |A| |x| + |b|`.
    pub(crate) fn residual(&self, x: &[f64], b: &[f64], r: &mut [f64], s: &mut [f64]) {
        for (i, &value) in b.iter().enumerate() {
            r[i] = value;
            s[i] = value.abs();
        }
        match &self.leading {
            Some(Leading::Dense(dense)) => {
                let m = dense.order();
                dense.residual(&x[..m], &mut r[..m], &mut s[..m]);
            }
            Some(Leading::Shared(shared)) => {
                let m = shared.order();
                shared.residual(&x[..m], &mut r[..m], &mut s[..m]);
            }
            None => {}
        }
        self.rest.subtract_product(x, r, s);
    }

    /// Adds `A (x + rest)` to `sums`, in twice the working precision.
    pub(crate) fn add_beyond(&self, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) {
        if let Some(shared) = self.shared() {
            let m = shared.order();
            shared.add_beyond(&x[..m], &rest[..m], &mut sums[..m]);
        }
        let dense = self.leading().into_iter().flat_map(DenseSymmetric::entries);
        for (row, column, value) in dense.chain(self.rest.entries()) {
            sums[row].add_product(value, x[column]);
            sums[row].add(value * rest[column]);
        }
    }

    /// Returns the largest absolute value.
    pub(crate) fn largest_entry(&self) -> f64 {
        let leading = match &self.leading {
            Some(Leading::Dense(dense)) => dense.largest_entry(),
            Some(Leading::Shared(shared)) => shared.row_norms().fold(0.0, f64::max),
            None => 0.0,
        };
        self.rest.values().iter().fold(leading, |m, value| m.max(value.abs()))
    }

    /// Returns the largest absolute value in each row.
    pub(crate) fn row_norms(&self) -> Vec<f64> {
        let mut norms = vec![0.0_f64; self.pattern().rows()];
        match &self.leading {
            Some(Leading::Dense(dense)) => norms.iter_mut().zip(dense.row_norms()).for_each(|(norm, own)| *norm = own),
            Some(Leading::Shared(shared)) => {
                norms.iter_mut().zip(shared.row_norms()).for_each(|(norm, own)| *norm = own);
            }
            None => {}
        }
        self.rest.entries().for_each(|(row, _, value)| norms[row] = norms[row].max(value.abs()));
        norms
    }
}

impl Leading {
    /// Returns the whole matrix, gathered in this process.
    fn whole(&self) -> Symmetric {
        match self {
            Leading::Dense(dense) => Symmetric::from(dense.clone()),
            Leading::Shared(shared) => Symmetric::of_lower(shared.lower()),
        }
    }

    fn get(&self, row: usize, column: usize) -> f64 {
        match self {
            Leading::Dense(dense) => dense.get(row, column),
            Leading::Shared(shared) => shared.get(row, column),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates S of order 3 with one more row and column, and a term added to its diagonal.
    fn example() -> SystemMatrix {
        let values = (0..9).map(|k| 1.0 + 0.5 * f64::from(k)).collect();
        let entries = [(1, 1, 8.0), (0, 3, -1.0), (3, 2, 0.25), (3, 3, 2.0)];
        let leading = DenseSymmetric::from_lower(3, values).unwrap().scaled(0.5);
        SystemMatrix::new(leading, Csc::from_triplets(4, 4, &entries).unwrap()).unwrap()
    }

    #[test]
    fn it_is_what_its_compressed_columns_are() {
        let a = example();
        let whole = a.to_csc().into_owned();
        let entry = |row, column| whole.pattern().slot(row, column).map_or(0.0, |slot| whole.values()[slot]);
        for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
            assert_eq!(a.get(row, column), entry(row, column), "{row} {column}");
        }
        let (x, b) = ([1.0, -2.0, 3.0, 0.5], [0.25, 8.0, -1.0, 0.0]);
        assert_eq!(a.times(&x).unwrap(), whole.times(&x).unwrap());
        let residual = |a: &SystemMatrix| {
            let (mut r, mut s) = ([0.0; 4], [0.0; 4]);
            a.residual(&x, &b, &mut r, &mut s);
            [r, s]
        };
        let whole = SystemMatrix::from(whole);
        assert_eq!(residual(&a), residual(&whole));
        assert!(matches!(whole.to_csc(), Cow::Borrowed(_)));
        // S_11 + 8 counts as two separate entries.
        assert_eq!((a.largest_entry(), whole.largest_entry()), (8.0, 9.5));
        assert_eq!(a.row_norms(), [1.0, 8.0, 2.5, 2.0]);
    }

    #[test]
    fn parts_that_do_not_fit() {
        let one = |n| DenseSymmetric::from_lower(n, vec![1.0; n * n]).unwrap();
        let rest = |rows, columns| Csc::from_triplets(rows, columns, &[]).unwrap();
        assert!(matches!(SystemMatrix::new(one(2), rest(2, 3)), Err(MatrixError::NotSquare { .. })));
        assert!(matches!(SystemMatrix::new(one(3), rest(2, 2)), Err(MatrixError::Length { .. })));
        assert!(SystemMatrix::new(one(2), rest(2, 2)).is_ok());
    }
}
