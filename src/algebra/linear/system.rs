//! The matrix of a linear system whose stiffness may be dense, or distributed over processes.

use std::borrow::Cow;
use std::sync::Arc;

use super::{Computed, Distributed, Stiffness, expect_length};
use crate::algebra::sparse::{Csc, DenseSymmetric, DoubleDouble, Pattern, Symmetric};

/// A square sparse matrix whose first rows and columns may contain a dense or distributed symmetric block:
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
    /// The number of displacements, if it is known.
    displacements: Option<usize>,
}

/// The block `S`.
#[derive(Debug, Clone)]
enum Leading {
    Dense(DenseSymmetric),
    /// A distributed stiffness times a factor.
    Distributed(Arc<dyn Distributed>, f64),
}

impl From<Csc> for SystemMatrix {
    /// Creates a matrix without the block `S`; its factorisation requires a square one.
    fn from(rest: Csc) -> Self {
        SystemMatrix { leading: None, rest, displacements: None }
    }
}

impl SystemMatrix {
    /// Creates the matrix with the dense block `leading`, and `rest` added to it.
    ///
    /// # Errors
    /// If `rest` is not square, or has fewer rows than the block.
    pub fn new(leading: DenseSymmetric, rest: Csc) -> Computed<Self> {
        let (rows, columns) = (rest.pattern().rows(), rest.pattern().columns());
        expect_length("rows of the matrix", columns, rows)?;
        expect_length("rows of the dense block", leading.order().min(rows), leading.order())?;
        let displacements = Some(leading.order());
        Ok(SystemMatrix { leading: Some(Leading::Dense(leading)), rest, displacements })
    }

    /// Creates the zero matrix with this pattern, plus `factor` times the stiffness if that is dense or distributed.
    pub fn of(stiffness: &Stiffness, factor: f64, pattern: Pattern) -> Self {
        let leading = match stiffness {
            Stiffness::Assembled(k) => k.dense().map(|dense| Leading::Dense(dense.scaled(factor))),
            Stiffness::Distributed(k) => Some(Leading::Distributed(Arc::clone(k), factor)),
        };
        SystemMatrix { leading, rest: Csc::zeros(Arc::new(pattern)), displacements: Some(stiffness.order()) }
    }

    /// States that the first `displacements` unknowns are displacements. Their block, the stiffness, must be symmetric. A solver
    /// that factors it once a run needs their number.
    ///
    /// # Errors
    /// If the matrix has fewer columns.
    pub fn with_displacements(self, displacements: usize) -> Computed<Self> {
        expect_length("displacements", displacements.min(self.order()), displacements)?;
        Ok(SystemMatrix { displacements: Some(displacements), ..self })
    }

    /// Returns the number of displacements, which are the first unknowns, if it is known.
    pub fn displacements(&self) -> Option<usize> {
        self.displacements
    }

    /// Returns the order.
    pub fn order(&self) -> usize {
        self.rest.pattern().columns()
    }

    /// Returns the dense block `S`.
    pub fn leading(&self) -> Option<&DenseSymmetric> {
        match &self.leading {
            Some(Leading::Dense(dense)) => Some(dense),
            Some(Leading::Distributed(..)) | None => None,
        }
    }

    /// Returns the distributed stiffness and its factor in the block `S`, if the block is one.
    pub fn distributed(&self) -> Option<(&dyn Distributed, f64)> {
        match &self.leading {
            Some(Leading::Distributed(stiffness, factor)) => Some((&**stiffness, *factor)),
            Some(Leading::Dense(_)) | None => None,
        }
    }

    /// Returns `R`, all entries outside the block or added to it.
    pub fn rest(&self) -> &Csc {
        &self.rest
    }

    /// Returns `R` for changing it.
    pub fn rest_mut(&mut self) -> &mut Csc {
        &mut self.rest
    }

    /// Returns the pattern of [`SystemMatrix::rest`].
    pub fn pattern(&self) -> &Arc<Pattern> {
        self.rest.pattern()
    }

    /// Returns the entry at `(row, column)`, or 0 if it is not stored. Of a distributed block it is the entry on the
    /// diagonal; the others count as not stored.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let leading = match &self.leading {
            Some(Leading::Dense(dense)) => dense.get(row, column),
            Some(Leading::Distributed(stiffness, factor)) if row == column => {
                stiffness.diagonal().get(row).map_or(0.0, |value| factor * value)
            }
            Some(Leading::Distributed(..)) | None => 0.0,
        };
        leading + self.pattern().slot(row, column).map_or(0.0, |slot| self.rest.values()[slot])
    }

    /// Returns the matrix in compressed columns. A distributed block is gathered in this process.
    ///
    /// # Errors
    /// [`super::LinearError`] if a process with rows of the block has failed, here and below.
    pub fn to_csc(&self) -> Computed<Cow<'_, Csc>> {
        let leading = match &self.leading {
            Some(Leading::Dense(dense)) => Symmetric::from(dense.clone()),
            Some(Leading::Distributed(stiffness, factor)) => {
                let mut gathered = stiffness.gathered()?;
                gathered.scale(*factor);
                gathered
            }
            None => return Ok(Cow::Borrowed(&self.rest)),
        };
        let (n, rest) = (self.order(), &self.rest);
        let mut whole = Csc::zeros(Arc::new(Pattern::of(n, n, |take| {
            leading.entries().chain(rest.entries()).for_each(|(row, column, _)| take(row, column));
        })));
        let (pattern, values) = whole.parts_mut();
        for (row, column, value) in leading.entries().chain(rest.entries()) {
            if let Some(slot) = pattern.slot(row, column) {
                values[slot] += value;
            }
        }
        Ok(Cow::Owned(whole))
    }

    /// Computes `A x`.
    ///
    /// # Errors
    /// As [`SystemMatrix::to_csc`], and if the length of `x` differs from the number of columns.
    pub fn times(&self, x: &[f64]) -> Computed<Vec<f64>> {
        expect_length("vector", self.order(), x.len())?;
        let mut y = vec![0.0; self.pattern().rows()];
        self.mul(x, &mut y)?;
        Ok(y)
    }

    /// Computes `y = A x`.
    pub(crate) fn mul(&self, x: &[f64], y: &mut [f64]) -> Computed<()> {
        y.fill(0.0);
        match &self.leading {
            Some(Leading::Dense(dense)) => dense.mul(&x[..dense.order()], &mut y[..dense.order()]),
            Some(Leading::Distributed(stiffness, factor)) => {
                let m = stiffness.order();
                stiffness.mul(&x[..m], &mut y[..m])?;
                y[..m].iter_mut().for_each(|y| *y *= factor);
            }
            None => {}
        }
        self.rest.add_product(x, y);
        Ok(())
    }

    /// Computes `r = b - A x` and its scale `s = |A| |x| + |b|`.
    pub(crate) fn residual(&self, x: &[f64], b: &[f64], r: &mut [f64], s: &mut [f64]) -> Computed<()> {
        for (i, &value) in b.iter().enumerate() {
            r[i] = value;
            s[i] = value.abs();
        }
        match &self.leading {
            Some(Leading::Dense(dense)) => {
                let m = dense.order();
                dense.residual(&x[..m], &mut r[..m], &mut s[..m]);
            }
            Some(Leading::Distributed(stiffness, factor)) => {
                let m = stiffness.order();
                let (mut product, mut sizes) = (vec![0.0; m], vec![0.0; m]);
                stiffness.products(&x[..m], &mut product, &mut sizes)?;
                r.iter_mut().zip(product).for_each(|(r, y)| *r -= factor * y);
                s.iter_mut().zip(sizes).for_each(|(s, size)| *s += factor.abs() * size);
            }
            None => {}
        }
        self.rest.subtract_product(x, r, s);
        Ok(())
    }

    /// Adds `A (x + rest)` to `sums`, in twice the working precision.
    pub(crate) fn add_beyond(&self, x: &[f64], rest: &[f64], sums: &mut [DoubleDouble]) -> Computed<()> {
        if let Some(Leading::Distributed(stiffness, factor)) = &self.leading {
            let m = stiffness.order();
            stiffness.add_beyond(*factor, &x[..m], &rest[..m], &mut sums[..m])?;
        }
        let dense = self.leading().into_iter().flat_map(DenseSymmetric::entries);
        for (row, column, value) in dense.chain(self.rest.entries()) {
            sums[row].add_product(value, x[column]);
            sums[row].add(value * rest[column]);
        }
        Ok(())
    }

    /// Returns the largest absolute value.
    pub(crate) fn largest_entry(&self) -> f64 {
        let leading = match &self.leading {
            Some(Leading::Dense(dense)) => dense.largest_entry(),
            Some(Leading::Distributed(stiffness, factor)) => {
                factor.abs() * stiffness.row_norms().iter().fold(0.0, |m, norm| norm.max(m))
            }
            None => 0.0,
        };
        self.rest.values().iter().fold(leading, |m, value| m.max(value.abs()))
    }

    /// Returns the largest absolute value in each row.
    pub(crate) fn row_norms(&self) -> Vec<f64> {
        let mut norms = vec![0.0_f64; self.pattern().rows()];
        match &self.leading {
            Some(Leading::Dense(dense)) => norms.iter_mut().zip(dense.row_norms()).for_each(|(norm, own)| *norm = own),
            Some(Leading::Distributed(stiffness, factor)) => {
                norms.iter_mut().zip(stiffness.row_norms()).for_each(|(norm, own)| *norm = factor.abs() * own);
            }
            None => {}
        }
        self.rest.entries().for_each(|(row, _, value)| norms[row] = norms[row].max(value.abs()));
        norms
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::linear::LinearError;

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
        let whole = a.to_csc().unwrap().into_owned();
        let entry = |row, column| whole.pattern().slot(row, column).map_or(0.0, |slot| whole.values()[slot]);
        for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
            assert_eq!(a.get(row, column), entry(row, column), "{row} {column}");
        }
        let (x, b) = ([1.0, -2.0, 3.0, 0.5], [0.25, 8.0, -1.0, 0.0]);
        assert_eq!(a.times(&x).unwrap(), whole.times(&x).unwrap());
        let residual = |a: &SystemMatrix| {
            let (mut r, mut s) = ([0.0; 4], [0.0; 4]);
            a.residual(&x, &b, &mut r, &mut s).unwrap();
            [r, s]
        };
        let whole = SystemMatrix::from(whole);
        assert_eq!(residual(&a), residual(&whole));
        assert!(matches!(whole.to_csc(), Ok(Cow::Borrowed(_))));
        // S_11 + 8 counts as two separate entries.
        assert_eq!((a.largest_entry(), whole.largest_entry()), (8.0, 9.5));
        assert_eq!(a.row_norms(), [1.0, 8.0, 2.5, 2.0]);
    }

    #[test]
    fn parts_that_do_not_fit() {
        let one = |n| DenseSymmetric::from_lower(n, vec![1.0; n * n]).unwrap();
        let rest = |rows, columns| Csc::from_triplets(rows, columns, &[]).unwrap();
        assert!(matches!(SystemMatrix::new(one(2), rest(2, 3)), Err(LinearError::Shape { .. })));
        assert!(matches!(SystemMatrix::new(one(3), rest(2, 2)), Err(LinearError::Shape { .. })));
        assert!(SystemMatrix::new(one(2), rest(2, 2)).is_ok());
    }
}
