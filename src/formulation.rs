//! Equations `H(z) = 0` of one increment and their linearisation on one fixed pattern.

mod bdiff;
mod constrained;
mod layout;
mod mixed;
mod natural;
mod scaled;

pub use bdiff::Bdiff;
pub use constrained::{Constrained, Face, Pair, SlackLayout};
pub use layout::Layout;
pub use natural::Conventions;

use crate::problem::Increment;
use crate::sparse::Csc;

/// A system of equations that Newton's method can work on.
pub trait Formulation {
    /// The length of `z`.
    fn unknowns(&self) -> usize;

    /// Sets the data of a new increment.
    fn begin(&mut self, increment: &Increment<'_>);

    /// `h = H(z)`.
    fn residual(&self, z: &[f64], h: &mut [f64]);

    /// The merit `Theta` of a residual.
    fn merit(&self, h: &[f64]) -> f64;

    /// `t ↦ Theta(z + t dz)` along a Newton direction `dz` from `z` with `h = H(z)`.
    fn merit_along<'a>(&'a self, z: &'a [f64], dz: &'a [f64], h: &[f64]) -> impl Fn(f64) -> f64 + 'a;

    /// Linearises at `z`: rewrites the values of [`Formulation::jacobian`] that depend on it, and
    /// tells whether any of them changed.
    fn linearize(&mut self, z: &[f64]) -> bool;

    /// Linearises as if every contact node were held where it is: closed, and sticking where there
    /// is friction. With that matrix the other displacements follow a change of the load alone.
    fn hold_contacts(&mut self);

    /// The matrix of the last linearisation. Its pattern never changes.
    fn jacobian(&self) -> &Csc;

    /// Weights of a combination of the problem's free motions that the last linearisation leaves
    /// free, so that its matrix is singular; `None` if there is none.
    fn unheld_motion(&self) -> Option<Vec<f64>>;

    /// Whether `H` is affine, so that a single step solves it.
    fn is_affine(&self) -> bool;
}
