//! Multithreaded products of the Newton matrix with a vector.

use rayon::prelude::*;

use stickslip::algebra::Pattern;

/// The number of partial sums. It does not depend on the number of threads, so that the product does not either.
const SUMS: usize = 8;

/// Products with one matrix.
pub(super) struct Product<'a> {
    pattern: &'a Pattern,
    values: &'a [f64],
    /// The ranges of columns of the sums, with nearly as many entries in each.
    bounds: Vec<usize>,
    sums: &'a mut Vec<Vec<f64>>,
}

impl<'a> Product<'a> {
    /// Creates products with the square matrix that has these values; `sums` is the workspace of an earlier one, or
    /// empty.
    pub(super) fn new(pattern: &'a Pattern, values: &'a [f64], sums: &'a mut Vec<Vec<f64>>) -> Self {
        let (starts, n) = (pattern.column_starts(), pattern.columns());
        let bounds = (0..=SUMS).map(|k| {
            let entries = (pattern.len() / SUMS * k) as u64;
            if k == SUMS { n } else { starts[..n].partition_point(|&start| (start as u64) < entries) }
        });
        sums.resize_with(SUMS, Vec::new);
        for sum in sums.iter_mut() {
            sum.resize(n, 0.0);
        }
        Product { pattern, values, bounds: bounds.collect(), sums }
    }

    /// Computes `y = A x`.
    pub(super) fn times(&mut self, x: &[f64], y: &mut [f64]) {
        let (starts, rows) = (self.pattern.column_starts(), self.pattern.row_indices());
        let columns = self.bounds.par_windows(2);
        self.sums.par_iter_mut().zip(columns).for_each(|(sum, columns)| {
            sum.fill(0.0);
            for column in columns[0]..columns[1] {
                let (x, entries) = (x[column], starts[column] as usize..starts[column + 1] as usize);
                for (row, value) in rows[entries.clone()].iter().zip(&self.values[entries]) {
                    sum[*row as usize] += value * x;
                }
            }
        });
        let sums = &*self.sums;
        y.par_iter_mut().with_min_len(4096).enumerate().for_each(|(i, y)| *y = sums.iter().map(|sum| sum[i]).sum());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::algebra::Csc;

    #[test]
    fn it_is_the_product() {
        let n = 50;
        let entries: Vec<(usize, usize, f64)> =
            (0..n).flat_map(|j| [(j, j, 3.0), ((j * j + 1) % n, j, 0.5), ((3 * j + 2) % n, j, -1.0)]).collect();
        let a = Csc::from_triplets(n, n, &entries).unwrap();
        let x: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let mut y = vec![1.0; n];
        let mut sums = Vec::new();
        let mut product = Product::new(a.pattern(), a.values(), &mut sums);
        for _ in 0..2 {
            product.times(&x, &mut y);
            let expected = a.times(&x).unwrap();
            assert!(y.iter().zip(expected).all(|(y, expected)| (y - expected).abs() < 1e-14));
        }
    }
}
