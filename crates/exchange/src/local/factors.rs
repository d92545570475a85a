//! Factors of a matrix given entry by entry: dense, or sparse if it is large and mostly 0.

use faer::Mat;

use stickslip::algebra::Csc;
use stickslip::algebra::linear::{LinearError, LinearSolver, Lu, SparseLu};

/// Receives an entry `(row, column, value)`.
pub(super) type Add<'a> = dyn FnMut(usize, usize, f64) + 'a;

/// The factors of a matrix.
pub(super) enum Factors {
    /// Factors of a dense matrix.
    Dense(Lu),
    /// Factors of a sparse matrix.
    Sparse(Box<dyn LinearSolver>),
}

/// A dense factorisation below this order takes a few milliseconds.
const SMALL: usize = 300;
/// The share of nonzero entries below which sparse factors are faster. Factors have more entries than the matrix.
const SPARSE: f64 = 0.1;
/// The largest order of a dense matrix, 1.2 GB. Larger matrices need sparse factors.
const LARGEST: usize = 12_000;

impl Factors {
    /// Factors the matrix of this `order` with the entries that `visit` passes on. Entries at the same position are
    /// added.
    ///
    /// # Errors
    /// When it is singular, has numbers that are not finite, or is too large.
    pub(super) fn new(order: usize, visit: &dyn Fn(&mut Add<'_>)) -> Result<Self, LinearError> {
        if order > SMALL && SparseLu::default().is_built_in() {
            let mut count = 0_usize;
            visit(&mut |_, _, value| count += usize::from(value != 0.0));
            if (count as f64) < SPARSE * (order as f64).powi(2) {
                return sparse(order, count, visit).map(Factors::Sparse);
            }
        }
        if order > LARGEST {
            return Err(LinearError::OutOfMemory { step: "the dense factorisation of a local problem" });
        }
        let mut matrix = Mat::<f64>::zeros(order, order);
        visit(&mut |row, column, value| matrix[(row, column)] += value);
        Lu::new(matrix, &vec![1.0; order]).map(Factors::Dense)
    }

    /// Returns the solution for `b`, with NaN if the factors fail.
    pub(super) fn solve(&mut self, b: &[f64]) -> Vec<f64> {
        match self {
            Factors::Dense(lu) => lu.solution(b).unwrap_or_else(|_| vec![f64::NAN; b.len()]),
            Factors::Sparse(solver) => {
                let mut x = vec![f64::NAN; b.len()];
                if solver.solve(b, &mut x).is_err() {
                    x.fill(f64::NAN);
                }
                x
            }
        }
    }
}

/// Factors `count` entries as a sparse matrix.
fn sparse(order: usize, count: usize, visit: &dyn Fn(&mut Add<'_>)) -> Result<Box<dyn LinearSolver>, LinearError> {
    let mut entries = Vec::with_capacity(count);
    visit(&mut |row, column, value| {
        if value != 0.0 {
            entries.push((row, column, value));
        }
    });
    let matrix = Csc::from_triplets(order, order, &entries).map_err(|_| LinearError::NotFinite)?;
    let mut solver = SparseLu::default().solver();
    solver.analyze(matrix.pattern())?;
    solver.factorize(matrix.values())?;
    Ok(solver)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Adds `2 x_k - x_(k - 1) - x_(k + 1)` in several parts, not symmetric.
    fn chain(order: usize, add: &mut Add<'_>) {
        for k in 0..order {
            add(k, k, 1.0);
            add(k, k, 1.25);
            if k > 0 {
                add(k, k - 1, -1.0);
                add(k - 1, k, -1.1);
            }
        }
    }

    #[test]
    fn small_and_large_matrices_are_solved() {
        for order in [0, 1, 20, SMALL + 100] {
            let mut factors = Factors::new(order, &|add| chain(order, add)).unwrap();
            let is_sparse = matches!(factors, Factors::Sparse(_));
            assert_eq!(is_sparse, order > SMALL && SparseLu::default().is_built_in());
            let x: Vec<f64> = (0..order).map(|k| (k as f64).sin()).collect();
            let mut b = vec![0.0; order];
            chain(order, &mut |row, column, value| b[row] += value * x[column]);
            assert!(factors.solve(&b).iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn singular_and_huge_matrices_are_refused() {
        for order in [3, SMALL + 100] {
            let of_one = |add: &mut Add<'_>| (1..order).for_each(|k| add(k, k, 1.0));
            assert!(matches!(Factors::new(order, &of_one), Err(LinearError::Singular { .. })));
        }
        // Counts as a full matrix, by its number of entries.
        let all = |add: &mut Add<'_>| (0..20_000_000).for_each(|k| add(k % 3, k % 7, 1.0));
        assert!(matches!(Factors::new(LARGEST + 1, &all), Err(LinearError::OutOfMemory { .. })));
    }
}
