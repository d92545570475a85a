//! What the predictor–corrector interior point method asks of its equations.

use super::Layout;
use super::pairs::{Face, Pair};
use crate::algebra::sparse::SystemMatrix;
use crate::base::units::Scaling;
use crate::solver::problem::Increment;

/// Equations `H(z) = 0` on `z = (u, p_t, p_o, p_n, v_n, s, λ)`, of which the products of complementary
/// pairs are a part.
pub trait InteriorPoint {
    /// The length of `z`.
    fn unknowns(&self) -> usize;

    /// The layout of `(u, p_t, p_o, p_n)`, with which `z` begins.
    fn forces(&self) -> &Layout;

    /// The units of `z`.
    fn scaling(&self) -> &Scaling;

    /// The complementary pairs: `(p_n, v_n)` of every contact node, then `(s, λ)`.
    fn pairs(&self) -> &[Pair];

    /// The gap `g - w_n` that `z` leaves at node `i`, scaled.
    fn distance(&self, i: usize, z: &[f64]) -> f64;

    /// Sets the data of a new increment.
    fn begin(&mut self, increment: &Increment<'_>);

    /// `h = H(z)`.
    fn residual(&self, z: &[f64], h: &mut [f64]);

    /// `Theta` (10) of the `(u, p_t, p_o, p_n)` in `z`, SI, where `h` is the residual there.
    fn theta(&self, z: &[f64], h: &[f64]) -> f64;

    /// Writes the matrix that stands for `∇H(z)`.
    fn linearize(&mut self, z: &[f64]);

    /// The matrix of the last linearisation. Its pattern never changes.
    fn matrix(&self) -> &SystemMatrix;

    /// The right-hand side for [`InteriorPoint::matrix`] that stands for `∇H(z) dz = b`.
    fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]);

    /// Completes `dz`, which begins with the solution for the right-hand side of
    /// [`InteriorPoint::reduce`].
    fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]);

    /// Weights of a combination of the problem's free motions that no contact node stops, so that
    /// the matrix is singular in every state; `None` if there is none.
    fn unheld_motion(&self) -> Option<Vec<f64>>;

    /// Makes the pairs of `z`, which begins with the last solution, positive. `force` and `length`
    /// tell what the change of the load makes of the contact forces and gaps, scaled.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64);

    /// The face that a step from `before` to `z` has gone towards; `None` if the equations are not
    /// linear on their faces.
    fn face_ahead(&self, before: &[f64], z: &[f64]) -> Option<Face>;

    /// Linearises as if every contact node were held where it is: closed, and sticking where there
    /// is friction. With that matrix the other displacements follow a change of the load alone.
    fn hold_contacts(&mut self) {
        let mut z = vec![0.0; self.unknowns()];
        // Pressure without distance, friction to spare without slip.
        self.pairs().iter().for_each(|pair| z[pair.force] = 1.0);
        self.linearize(&z);
    }

    /// Whether there is no contact node, so that a single step solves the increment.
    fn is_affine(&self) -> bool {
        self.pairs().is_empty()
    }
}
