//! Equations `H(z) = 0` of one increment and their linearisation on one fixed pattern.

mod bdiff;
mod cone;
mod constrained;
mod interior;
mod layout;
mod mixed;
mod natural;
mod scaled;

pub use bdiff::Bdiff;
pub use cone::Cone;
pub use constrained::{Constrained, Face, SlackLayout};
pub use interior::{InteriorPoint, Pair, largest_step};
pub use layout::Layout;
pub use natural::{Conventions, Pressure};

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

    /// `h = H(z + rest)`, the linear rows in twice the working precision; `rest` is below the rounding of `z`.
    fn residual_beyond(&self, z: &[f64], rest: &[f64], h: &mut [f64]);

    /// The merit `Theta` of a residual.
    fn merit(&self, h: &[f64]) -> f64;

    /// `t ↦ Theta(z + t dz)` along a Newton direction `dz` from `z` with `h = H(z)`.
    fn merit_along<'a>(&'a self, z: &'a [f64], dz: &'a [f64], h: &[f64]) -> impl Fn(f64) -> f64 + 'a;

    /// Linearises at `z`: rewrites the values of [`Formulation::jacobian`] that depend on it, and
    /// tells whether any of them changed.
    fn linearize(&mut self, z: &[f64]) -> bool;

    /// Linearises at `z` as seen from `z + t dz`, `t → 0+`: where several cases meet in `z`, each node
    /// takes the one that `dz` leads into. A `dz` that solves with it and is met by it again, unchanged,
    /// is the direction of the B-derivative itself (20). Tells whether any case changed.
    fn linearize_towards(&mut self, z: &[f64], dz: &[f64]) -> bool;

    /// Turns a residual into the right-hand side of the last linearisation's matrix, whose rows are
    /// those of the derivative up to row operations.
    fn right_hand_side(&self, h: &mut [f64]);

    /// The case of every contact node in the last linearisation, to be compared with others.
    fn cases(&self) -> Vec<u8>;

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
