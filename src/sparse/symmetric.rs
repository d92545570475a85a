//! Symmetric matrices, of which only the lower triangle is stored.

use std::sync::Arc;

use super::{Csc, Pattern};

/// A symmetric matrix by its lower triangle, diagonal included.
#[derive(Debug, Clone)]
pub struct Symmetric {
    lower: Csc,
}

impl Symmetric {
    /// The zero matrix of order `n` with the entries that `visit` names in either triangle; see
    /// [`Pattern::from_entries`].
    pub fn from_entries(n: usize, visit: impl Fn(&mut dyn FnMut(usize, usize))) -> Self {
        let pattern = Pattern::from_entries(n, n, |take| {
            visit(&mut |row, column| {
                if row >= column {
                    take(row, column);
                }
            });
        });
        Symmetric { lower: Csc::zeros(Arc::new(pattern)) }
    }

    /// The matrix with this lower triangle; entries above the diagonal have no place in it.
    pub fn from_lower(lower: Csc) -> Self {
        debug_assert!(lower.entries().all(|(row, column, _)| row >= column));
        Symmetric { lower }
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.lower.pattern.columns()
    }

    /// The lower triangle, diagonal included: what is stored.
    pub fn lower(&self) -> &Csc {
        &self.lower
    }

    /// Adds `value` at `(row, column)` of the lower triangle; an entry of the upper one, which is
    /// stored as its mirror image, is passed over.
    ///
    /// # Panics
    /// If the entry was not named when the matrix was made.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        if row >= column {
            let slot = self.lower.pattern.slot(row, column).expect("an entry of the pattern");
            self.lower.values[slot] += value;
        }
    }

    /// All entries of both triangles as `(row, column, value)`.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.lower.entries().flat_map(|(row, column, value)| {
            let mirror = (row != column).then_some((column, row, value));
            std::iter::once((row, column, value)).chain(mirror)
        })
    }

    /// The entry at `(row, column)`; one that is not stored is 0.
    pub fn get(&self, row: usize, column: usize) -> f64 {
        let slot = self.lower.pattern.slot(row.max(column), row.min(column));
        slot.map_or(0.0, |slot| self.lower.values[slot])
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order()).map(|i| self.get(i, i)).collect()
    }

    /// `y = A x`.
    pub fn mul(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.accumulate(x, y, |value, x| value * x);
    }

    /// `y += |A| |x|`.
    pub fn add_sizes(&self, x: &[f64], y: &mut [f64]) {
        self.accumulate(x, y, |value, x| (value * x).abs());
    }

    /// `y_i += Σ_j term(A_ij, x_j)`, with a column of the lower triangle and its mirror image at a time.
    fn accumulate(&self, x: &[f64], y: &mut [f64], term: impl Fn(f64, f64) -> f64) {
        let Csc { pattern, values } = &self.lower;
        for column in 0..self.order() {
            let slots = pattern.column(column);
            let (factor, mut sum) = (x[column], 0.0);
            for (&row, &value) in pattern.row_indices()[slots.clone()].iter().zip(&values[slots]) {
                let row = row as usize;
                y[row] += term(value, factor);
                if row != column {
                    sum += term(value, x[row]);
                }
            }
            y[column] += sum;
        }
    }

    /// All values times `factor`: the matrix in another unit.
    pub fn scale(&mut self, factor: f64) {
        self.lower.values.iter_mut().for_each(|value| *value *= factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_it_is_enough() {
        // [ 2 1 0 ]
        // [ 1 3 4 ]
        // [ 0 4 5 ]
        let full = [(0, 0, 2.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 3.0), (1, 2, 4.0), (2, 1, 4.0), (2, 2, 5.0)];
        let mut a = Symmetric::from_entries(3, |take| full.iter().for_each(|&(i, j, _)| take(i, j)));
        for (i, j, value) in full {
            a.add(i, j, value);
        }
        assert_eq!(a.lower.pattern.len(), 5);
        assert_eq!(a.diagonal(), [2.0, 3.0, 5.0]);
        assert_eq!([a.get(1, 2), a.get(2, 1), a.get(0, 2)], [4.0, 4.0, 0.0]);
        let mut y = [0.0; 3];
        a.mul(&[1.0, -1.0, 2.0], &mut y);
        assert_eq!(y, [1.0, 6.0, 6.0]);
        let mut entries: Vec<_> = a.entries().collect();
        entries.sort_by_key(|&(i, j, _)| (i, j));
        assert_eq!(entries, full);
    }
}
