//! The local problem of frictional contact: contact forces and relative velocities alone, as in exchange formats.
//!
//! ```text
//! u = W r + q                                                  W: the Delassus matrix, q: the free velocity
//! u_N ≥ 0,   r_N ≥ 0,   u_N r_N = 0                            no penetration, no tension, no pressure across a gap
//! |r_T| ≤ μ r_N,   r_T = -μ r_N u_T / |u_T|  where u_T ≠ 0     Coulomb friction
//! ```
//!
//! Rows are ordered contact by contact, the normal first, then the one tangent of the plane or the two of space. In the
//! notation of [`stickslip::ContactProblem`], `r_N = p_n`, `r_T = -p_T`, `u_N = g - w_n` and `u_T = w_T - w̄_T`.
//!
//! `W` may be semidefinite, singular or not symmetric. If rigid bodies touch in more places than they have motions,
//! their contact forces are not unique. [`solve`] tries several methods until the independent [measure](Errors)
//! shows that the laws hold. None of them changes the problem.
//!
//! ```
//! use stickslip_exchange::local::{CascadeSettings, LocalProblem, LocalStatus, solve};
//! use stickslip::algebra::Csc;
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
pub use record::{CascadeSettings, LocalStatus, Solved, Stage, StageRecord};

use crate::checks::{expect_dimension, expect_finite, expect_friction, expect_size};
use crate::measure::Errors;
use stickslip::algebra::Csc;
use stickslip::base::InputError;

/// The problem `u = W r + q` with the laws of contact and friction. It is valid, because [`LocalProblem::new`] checks
/// it.
#[derive(Debug, Clone)]
pub struct LocalProblem {
    dimension: usize,
    delassus: Csc,
    q: Vec<f64>,
    mu: Vec<f64>,
}

impl LocalProblem {
    /// Creates the problem of a `delassus` matrix `W`, n_c d square, a free velocity `q`, n_c d, and coefficients of
    /// friction `mu`, n_c, in the plane (`dimension` 2) or in space (3), in any consistent units. It may have no
    /// contact at all.
    ///
    /// # Errors
    /// [`InputError`] names an array of wrong length, with a number that is not finite, or with a negative μ.
    pub fn new(dimension: usize, delassus: Csc, q: Vec<f64>, mu: Vec<f64>) -> Result<Self, InputError> {
        expect_dimension(dimension)?;
        let n = mu.len().saturating_mul(dimension);
        let (rows, columns) = (delassus.pattern().rows(), delassus.pattern().columns());
        for (key, what, found) in [("W", "rows", rows), ("W", "columns", columns), ("q", "entries", q.len())] {
            expect_size(key, what, n, found, "W and q have a row for each direction of each contact in mu")?;
        }
        expect_finite("W", delassus.values())?;
        expect_finite("q", &q)?;
        expect_friction(&mu)?;
        Ok(LocalProblem { dimension, delassus, q, mu })
    }

    /// Returns `d`, the dimension: 2 in the plane and 3 in space.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Returns n_c, the number of contacts.
    pub fn contacts(&self) -> usize {
        self.mu.len()
    }

    /// Returns `W`, n_c d square.
    pub fn delassus(&self) -> &Csc {
        &self.delassus
    }

    /// Returns `q`, the free velocity, n_c d.
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Returns `μ`, n_c.
    pub fn mu(&self) -> &[f64] {
        &self.mu
    }

    /// Returns the errors of forces `r` (n_c d) with velocities `u` (n_c d), or with the velocities that follow from
    /// the forces.
    ///
    /// # Errors
    /// When an array has a wrong length, or a number is not finite.
    pub fn errors(&self, r: &[f64], u: Option<&[f64]>) -> Result<Errors, InputError> {
        self.check("r", r)?;
        u.map_or(Ok(()), |u| self.check("u", u))?;
        Ok(errors::measure(self, r, u).0)
    }

    /// Returns an error unless there is one finite number for each row.
    fn check(&self, key: &str, values: &[f64]) -> Result<(), InputError> {
        expect_size(key, "entries", self.q.len(), values.len(), "give a number for each direction of each contact")?;
        expect_finite(key, values)
    }
}
