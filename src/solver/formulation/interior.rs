//! The interface between the predictor–corrector interior point method and its equations.

use super::Layout;
use super::pairs::{Face, Pair};
use crate::algebra::linear::{LinearError, SystemMatrix};
use crate::base::units::Scaling;
use crate::solver::problem::Increment;

/// Equations `H(z) = 0` on `z = (u, p_t, p_o, p_n, v_n, s, λ)` that include the products of complementary pairs.
pub trait InteriorPoint: Send {
    /// Returns the length of `z`.
    fn unknowns(&self) -> usize;

    /// Returns the layout of `(u, p_t, p_o, p_n)`, with which `z` begins.
    fn forces(&self) -> &Layout;

    /// Returns the units of `z`.
    fn scaling(&self) -> &Scaling;

    /// Returns the complementary pairs: `(p_n, v_n)` of every contact node, then `(s, λ)`.
    fn pairs(&self) -> &[Pair];

    /// Returns the gap `g - w_n` at node `i`, scaled.
    fn distance(&self, i: usize, z: &[f64]) -> f64;

    /// Sets the data of a new increment after the solution `z`.
    fn begin(&mut self, increment: &Increment<'_>, z: &[f64]);

    /// Computes `h = H(z)`.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed.
    fn residual(&self, z: &[f64], h: &mut [f64]) -> Result<(), LinearError>;

    /// Returns `Theta` (10) of the `(u, p_t, p_o, p_n)` in `z`, SI, where `h` is the residual at `z`.
    fn theta(&self, z: &[f64], h: &[f64]) -> f64;

    /// Writes the matrix that represents `∇H(z)`.
    fn linearize(&mut self, z: &[f64]);

    /// Returns the matrix of the last linearisation. Its pattern never changes.
    fn matrix(&self) -> &SystemMatrix;

    /// Computes the right-hand side for [`InteriorPoint::matrix`] that represents `∇H(z) dz = b`.
    fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]);

    /// Completes `dz`, which begins with the solution for the right-hand side of [`InteriorPoint::reduce`].
    fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]);

    /// Returns the weights of a combination of the problem's rigid modes that no contact node stops, so that the
    /// matrix is singular in every state, or `None` if there is none.
    fn unconstrained_mode(&self) -> Option<Vec<f64>>;

    /// Makes the pairs of `z`, which begins with the last solution, positive. `force` and `length` are the expected
    /// changes of the contact forces and gaps with the load, scaled.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64);

    /// Returns the face that a step from `before` to `z` has approached, or `None` if the equations are not linear on
    /// their faces.
    fn face_ahead(&self, before: &[f64], z: &[f64]) -> Option<Face>;

    /// Linearises with every contact node clamped: closed, and sticking if there is friction. With this matrix the
    /// other displacements follow a change of the load.
    fn clamp_contacts(&mut self) {
        let mut z = vec![0.0; self.unknowns()];
        // Pressure without distance, and friction below its limit without slip.
        self.pairs().iter().for_each(|pair| z[pair.force] = 1.0);
        self.linearize(&z);
    }

    /// Returns `true` if there is no contact node, so that a single step solves the increment.
    fn is_affine(&self) -> bool {
        self.pairs().is_empty()
    }
}
