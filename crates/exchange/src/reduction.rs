//! Reduces the global problem to the local one and recovers its solution: `W = Hᵀ M⁻¹ H`, `q = Hᵀ M⁻¹ f + w`, `v = M⁻¹
//! (f + H r)`.

use super::{GlobalProblem, Solution};
use crate::local::LocalProblem;
use stickslip::algebra::linear::{LinearError, RefinedSolver, SystemMatrix};
use stickslip::algebra::{Csc, MatrixError};
use stickslip::base::InputError;

/// The largest number of rows of a local problem, whose matrix is full.
const ROWS: usize = 20_000;

/// The reason why a global problem has no local one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// `M` cannot be factored, e.g. because a body is not supported.
    #[error("M cannot be eliminated: {0}")]
    Linear(#[from] LinearError),
    /// The result is no valid matrix.
    #[error("the Delassus matrix: {0}")]
    Matrix(#[from] MatrixError),
    /// The result is no valid local problem.
    #[error(transparent)]
    Local(#[from] InputError),
    /// The Delassus matrix is full.
    #[error("{rows} rows of contacts are too many for a Delassus matrix, which is full: {ROWS} at most")]
    TooLarge {
        /// The number of rows.
        rows: usize,
    },
}

/// A factored global problem with its local one.
pub struct Reduction<'a> {
    global: &'a GlobalProblem,
    matrix: SystemMatrix,
    direct: RefinedSolver,
    local: LocalProblem,
}

impl<'a> Reduction<'a> {
    /// Factors `M` and solves with every column of `H`.
    ///
    /// # Errors
    /// [`ReductionError`] if `M` is singular, or there are too many contacts.
    pub fn new(global: &'a GlobalProblem) -> Result<Self, ReductionError> {
        let rows = global.w().len();
        if rows > ROWS {
            return Err(ReductionError::TooLarge { rows });
        }
        let matrix = SystemMatrix::from(global.m().clone());
        let mut direct = RefinedSolver::default();
        direct.analyze(&matrix)?;
        direct.factorize(&matrix)?;
        let n = global.unknowns();
        let (mut x, mut entries) = (vec![0.0; n], Vec::new());
        let mut columns = vec![Vec::new(); rows];
        global.h().entries().for_each(|(row, column, value)| columns[column].push((row, value)));
        for (column, of_h) in columns.iter().enumerate() {
            let mut b = vec![0.0; n];
            for (row, value) in of_h {
                b[*row] += value;
            }
            direct.solve(&matrix, &b, &mut x)?;
            for (row, of_h) in columns.iter().enumerate() {
                let sum: f64 = of_h.iter().map(|(i, value)| value * x[*i]).sum();
                if sum != 0.0 {
                    entries.push((row, column, sum));
                }
            }
        }
        direct.solve(&matrix, global.f(), &mut x)?;
        let delassus = Csc::from_triplets(rows, rows, &entries)?;
        let local = LocalProblem::new(global.dimension(), delassus, global.velocities(&x), global.mu().to_vec())?;
        Ok(Reduction { global, matrix, direct, local })
    }

    /// Returns the local problem.
    pub fn local(&self) -> &LocalProblem {
        &self.local
    }

    /// Returns the solution of the global problem with contact forces `r`, n_c d.
    ///
    /// # Errors
    /// [`LinearError`] if the forces have a wrong length, or are not finite.
    pub fn solution(&mut self, r: Vec<f64>) -> Result<Solution, LinearError> {
        let found = r.len();
        let expected = self.global.w().len();
        if found != expected {
            return Err(LinearError::Shape { what: "contact forces", expected, found });
        }
        let mut b = self.global.f().to_vec();
        self.global.h().entries().for_each(|(row, column, value)| b[row] += value * r[column]);
        let mut v = vec![0.0; b.len()];
        self.direct.solve(&self.matrix, &b, &mut v)?;
        let u = self.global.velocities(&v);
        Ok(Solution { v, r, u })
    }
}
