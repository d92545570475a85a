//! From the global to the local problem and back: `W = Hᵀ M⁻¹ H`, `q = Hᵀ M⁻¹ f + w`, `v = M⁻¹ (f + H r)`.

use super::{GlobalProblem, Solution};
use crate::local::{LocalProblem, LocalProblemError};
use stickslip::algebra::linear::{LinearError, RefinedSolver};
use stickslip::algebra::sparse::{Csc, MatrixError, SystemMatrix};

/// Rows of a local problem beyond which its matrix, which is full, has no room.
const ROWS: usize = 20_000;

/// Why a global problem has no local one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReductionError {
    /// `M` cannot be factored, as where nothing holds a body.
    #[error("M cannot be eliminated: {0}")]
    Linear(#[from] LinearError),
    /// What came out is no matrix.
    #[error("the Delassus matrix: {0}")]
    Matrix(#[from] MatrixError),
    /// What came out is no local problem.
    #[error(transparent)]
    Local(#[from] LocalProblemError),
    /// The Delassus matrix is full.
    #[error("{rows} rows of contacts are too many for a Delassus matrix, which is full: {ROWS} at most")]
    TooLarge {
        /// How many there are.
        rows: usize,
    },
}

/// A global problem, factored, with its local one.
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
    /// [`ReductionError`] where `M` is singular, or the contacts are too many.
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

    /// The local problem.
    pub fn local(&self) -> &LocalProblem {
        &self.local
    }

    /// The solution of the global problem with contact forces `r`, n_c d.
    ///
    /// # Errors
    /// [`LinearError`] where the forces are of another length, or not finite.
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
