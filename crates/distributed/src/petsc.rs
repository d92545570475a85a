//! One cycle of PETSc's algebraic multigrid, GAMG, as an approximate inverse, on all MPI processes.
//!
//! Smoothed aggregation needs the near null space, the rigid modes, and the rows of each node. The smoother is two
//! Chebyshev steps: with an incomplete Cholesky factorisation if the matrix is symmetric, which works for stretched
//! elements, and with the diagonal otherwise. With several ranks each factors the couplings within its own rows.

mod share;
mod sys;

use super::ranks::{Kind, Shared};
use crate::{expect_finite, expect_length};
pub(super) use share::Share;
use stickslip::algebra::linear::LinearError;

/// A square matrix by compressed rows, sorted.
pub(super) struct Rows {
    pub starts: Vec<i32>,
    pub columns: Vec<i32>,
    pub values: Vec<f64>,
    /// The number of successive rows of one node.
    pub block: usize,
    pub symmetric: bool,
}

/// The only job of a hierarchy.
const CYCLE: i64 = 1;

/// The hierarchy of one matrix.
pub(super) struct Amg {
    shared: Shared<Share>,
    order: usize,
}

impl Amg {
    /// Creates the hierarchy of `matrix`. The orthonormal `kernel` is the null space of its operator without
    /// supports. Each rank gets the rows between its `bounds`.
    pub(super) fn new(matrix: Rows, kernel: Vec<Vec<f64>>, bounds: &[usize]) -> Result<Self, LinearError> {
        let order = matrix.starts.len() - 1;
        expect_finite(&matrix.values)?;
        for motion in &kernel {
            expect_length("displacements of a motion", order, motion.len())?;
        }
        let shared = Shared::new(Kind::Amg, |world| Share::deal(world, matrix, kernel, bounds))?;
        Ok(Amg { shared, order })
    }

    /// Applies one cycle: `z` with `A z ≈ r`.
    pub(super) fn cycle(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        expect_length("residual", self.order, r.len())?;
        expect_length("correction", self.order, z.len())?;
        self.shared.run(CYCLE, |world, share| share.cycle(world, r, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Creates -u'' with u = 0 at both ends; the only rigid mode is the constant.
    fn bar(n: usize, symmetric: bool) -> Amg {
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n as i32 {
            for (j, v) in [(i - 1, -1.0), (i, 2.0), (i + 1, -1.0)] {
                if (0..n as i32).contains(&j) {
                    columns.push(j);
                    values.push(v);
                }
            }
            starts.push(columns.len() as i32);
        }
        let constant = vec![1.0 / (n as f64).sqrt(); n];
        Amg::new(Rows { starts, columns, values, block: 1, symmetric }, vec![constant], &[0, n]).unwrap()
    }

    #[test]
    fn cycles_solve() {
        for symmetric in [true, false] {
            let n = 200;
            let mut amg = bar(n, symmetric);
            let (b, mut x) = (vec![1.0; n], vec![0.0; n]);
            let mut last = f64::INFINITY;
            for _ in 0..30 {
                let at = |i: usize| if i < n { x[i] } else { 0.0 };
                let r: Vec<f64> = (0..n).map(|i| b[i] - 2.0 * x[i] + at(i.wrapping_sub(1)) + at(i + 1)).collect();
                last = r.iter().map(|r| r * r).sum::<f64>().sqrt();
                let mut z = vec![0.0; n];
                amg.cycle(&r, &mut z).unwrap();
                x.iter_mut().zip(z).for_each(|(x, z)| *x += z);
            }
            assert!(last < 1e-6, "{symmetric} {last}");
        }
    }

    #[test]
    fn what_does_not_fit_is_an_error() {
        let mut amg = bar(10, true);
        assert!(matches!(amg.cycle(&[0.0; 9], &mut [0.0; 10]), Err(LinearError::Shape { .. })));
        let rows = Rows { starts: vec![0, 1], columns: vec![0], values: vec![f64::NAN], block: 1, symmetric: true };
        assert!(matches!(Amg::new(rows, vec![vec![1.0]], &[0, 1]), Err(LinearError::NotFinite)));
    }
}
