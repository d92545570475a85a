//! The local problem of frictional contact: contact forces and relative velocities alone, as exchange formats hold it.
//!
//! ```text
//! u = W r + q                                                  W: the Delassus matrix, q: the free velocity
//! u_N ≥ 0,   r_N ≥ 0,   u_N r_N = 0                            no penetration, no tension, no pressure across a gap
//! |r_T| ≤ μ r_N,   r_T = -μ r_N u_T / |u_T|  where u_T ≠ 0     Coulomb friction
//! ```
//!
//! Rows go contact by contact, the normal first, then the one tangent of the plane or the two of space. In the letters of
//! [`stickslip::solver::problem`] is `r_N = p_n`, `r_T = -p_T`, `u_N = g - w_n` and `u_T = w_T - w̄_T`.
//!
//! `W` may be semidefinite, singular or not symmetric: rigid bodies that touch in more places than they can move hold
//! forces that are not unique. [`solve`] goes through several methods until the independent [measure](LocalErrors) says that the laws
//! hold; none of them changes the problem.
//!
//! ```
//! use stickslip_exchange::local::{CascadeSettings, LocalProblem, LocalStatus, solve};
//! use stickslip::algebra::sparse::Csc;
//!
//! // A unit mass falls on a floor, and slides: the floor stops it, and brakes it with half of that.
//! let delassus = Csc::from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
//! let problem = LocalProblem::new(2, delassus, vec![-2.0, 3.0], vec![0.5])?;
//! let solved = solve(&problem, &CascadeSettings::default(), None)?;
//! assert_eq!(solved.status, LocalStatus::Solved);
//! assert_eq!((solved.r, solved.u), (vec![2.0, -1.0], vec![0.0, 2.0]));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cascade;
mod error;
mod errors;
mod factors;
mod interior;
mod islands;
mod judge;
mod law;
mod newton;
mod order;
mod record;
mod scaled;
mod single;
mod sweeps;
mod system;

pub use cascade::solve;
pub use error::LocalProblemError;
use error::{expect_finite, expect_length};
pub use errors::{LocalErrors, SOLVED};
pub use record::{CascadeSettings, LocalStatus, Solved, Stage, StageRecord};

use stickslip::algebra::sparse::Csc;

/// `u = W r + q` with the laws of contact and friction; sound, because [`LocalProblem::new`] lets nothing else pass.
#[derive(Debug, Clone)]
pub struct LocalProblem {
    dimension: usize,
    delassus: Csc,
    q: Vec<f64>,
    mu: Vec<f64>,
}

impl LocalProblem {
    /// The problem of a `delassus` matrix `W`, n_c d square, a free velocity `q`, n_c d, and coefficients of friction `mu`, n_c, in
    /// the plane (`dimension` 2) or in space (3), in any consistent units. There may be no contact at all.
    ///
    /// # Errors
    /// [`LocalProblemError`] names the array that does not fit the others, or holds a number that is not finite or a negative μ.
    pub fn new(dimension: usize, delassus: Csc, q: Vec<f64>, mu: Vec<f64>) -> Result<Self, LocalProblemError> {
        if !matches!(dimension, 2 | 3) {
            return Err(LocalProblemError::Dimension { dimension });
        }
        let n = mu.len().saturating_mul(dimension);
        let (rows, columns) = (delassus.pattern().rows(), delassus.pattern().columns());
        for (array, found) in [("rows of the Delassus matrix", rows), ("columns of the Delassus matrix", columns)] {
            expect_length(array, n, found)?;
        }
        expect_length("q", n, q.len())?;
        if let Some((row, column, value)) = delassus.entries().find(|(_, _, value)| !value.is_finite()) {
            return Err(LocalProblemError::Entry { row, column, value });
        }
        expect_finite("q", &q)?;
        match mu.iter().enumerate().find(|(_, mu)| !(mu.is_finite() && **mu >= 0.0)) {
            Some((place, &value)) => Err(LocalProblemError::Friction { place, value }),
            None => Ok(LocalProblem { dimension, delassus, q, mu }),
        }
    }

    /// `d`, 2 in the plane and 3 in space.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// n_c, the number of contacts.
    pub fn contacts(&self) -> usize {
        self.mu.len()
    }

    /// `W`, n_c d square.
    pub fn delassus(&self) -> &Csc {
        &self.delassus
    }

    /// `q`, the free velocity, n_c d.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// `μ`, n_c.
    pub fn mu(&self) -> &[f64] {
        &self.mu
    }

    /// How far forces `r` (n_c d) are from the exact law, with velocities `u` (n_c d), or with those that follow from the forces.
    ///
    /// # Errors
    /// When an array has another length than the problem asks for, or holds a number that is not finite.
    pub fn errors(&self, r: &[f64], u: Option<&[f64]>) -> Result<LocalErrors, LocalProblemError> {
        self.check("r", r)?;
        if let Some(u) = u {
            self.check("u", u)?;
        }
        Ok(match u {
            Some(u) => errors::measure_given(self, r, u),
            None => errors::measure(self, r),
        })
    }

    /// Whether there is one finite number for each row.
    fn check(&self, array: &'static str, values: &[f64]) -> Result<(), LocalProblemError> {
        expect_length(array, self.q.len(), values.len())?;
        expect_finite(array, values)
    }
}
