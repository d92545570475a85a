//! The common parts of the interior point formulations: complementary pairs, the faces on which one member of each pair vanishes,
//! and the Newton system on `(u, p_t, p_o, p_n)`, in which `v_n`, `s` and `λ` are eliminated node by node.

use super::mixed::MixedMatrix;
use super::natural::{NaturalRows, half_square};
use super::scaled::ScaledData;
use super::{Assembled, FormulationScaling, Layout};
use crate::algebra::linear::{Computed, SystemMatrix};
use crate::base::units::Scaling;
use crate::solver::problem::Increment;

/// The data of such a formulation in the units of its scaling, its merit, its pairs and the matrix of its Newton system.
pub struct Paired {
    pub(super) data: ScaledData,
    natural: NaturalRows,
    pub(super) matrix: MixedMatrix,
    /// The complementary pairs: `(p_n, v_n)` of every contact node, then `(s, λ)`.
    pub(super) pairs: Vec<Pair>,
    /// The largest coefficient, by which each normal row and then each tangential row was divided.
    pub(super) row_scale: Vec<[f64; 2]>,
}

impl Paired {
    pub(super) fn new(assembled: Assembled, conventions: &FormulationScaling, pairs: Vec<Pair>) -> Self {
        let Assembled { data, matrix } = assembled;
        let row_scale = vec![[1.0; 2]; data.layout.contacts()];
        Paired { natural: NaturalRows::new(conventions, &data.scaling), data, matrix, pairs, row_scale }
    }

    /// Returns the places of `p_n` and `v_n` of node `i`.
    pub(super) fn normal(&self, i: usize) -> (usize, usize) {
        (self.pairs[i].force, self.pairs[i].length)
    }
}

/// Equations `H(z) = 0` on `z = (u, p_t, p_o, p_n, v_n, s, λ)` that include the products of complementary pairs.
pub trait InteriorPoint: Send {
    /// Returns the data, the pairs and the matrix.
    fn paired(&self) -> &Paired;

    /// Returns them to change them.
    fn paired_mut(&mut self) -> &mut Paired;

    /// Computes the rows of `p_T` and `s` of node `i` in `h = H(z)`.
    fn friction_rows(&self, i: usize, z: &[f64], h: &mut [f64]);

    /// Writes the reduced rows of the friction of node `i`.
    fn linearize_friction(&mut self, i: usize, z: &[f64]);

    /// Computes the reduced right-hand sides of the friction of node `i`.
    fn reduce_friction(&self, i: usize, z: &[f64], b: &[f64], rhs: &mut [f64]);

    /// Computes `ds` and `dλ` of node `i`.
    fn recover_friction(&self, i: usize, z: &[f64], b: &[f64], dz: &mut [f64]);

    /// Makes the pairs of `z`, which begins with the last solution, positive. `force` and `length` are the expected
    /// changes of the contact forces and gaps with the load, scaled.
    fn move_inside(&self, z: &mut [f64], force: f64, length: f64);

    /// Returns the face that a step from `before` to `z` has approached, or `None` if the equations are not linear on
    /// their faces.
    fn face_ahead(&self, before: &[f64], z: &[f64]) -> Option<Face>;

    /// Returns the length of `z`.
    fn unknowns(&self) -> usize {
        self.forces().unknowns() + 2 * self.pairs().len() - self.forces().contacts()
    }

    /// Returns the layout of `(u, p_t, p_o, p_n)`, with which `z` begins.
    fn forces(&self) -> &Layout {
        &self.paired().data.layout
    }

    /// Returns the units of `z`.
    fn scaling(&self) -> &Scaling {
        &self.paired().data.scaling
    }

    /// Returns the complementary pairs: `(p_n, v_n)` of every contact node, then `(s, λ)`.
    fn pairs(&self) -> &[Pair] {
        &self.paired().pairs
    }

    /// Returns the gap `g - w_n` at node `i`, scaled.
    fn distance(&self, i: usize, z: &[f64]) -> f64 {
        self.paired().data.gap[i] - self.paired().data.w_n(i, z)
    }

    /// Sets the data of a new increment after the solution `z`.
    fn begin(&mut self, increment: &Increment<'_>, z: &[f64]) {
        self.paired_mut().data.begin(increment, z);
    }

    /// Computes `h = H(z)`.
    ///
    /// # Errors
    /// If a rank that shares the stiffness has failed.
    fn residual(&self, z: &[f64], h: &mut [f64]) -> Computed<()> {
        let (paired, matrix) = (self.paired(), self.matrix());
        // The equilibrium rows of the matrix are constant: K u + C_nᵀ p_n + C_tᵀ p_t + C_oᵀ p_o - f.
        let n = matrix.order();
        matrix.mul(&z[..n], &mut h[..n])?;
        h.iter_mut().zip(&paired.data.force).for_each(|(row, force)| *row -= force);
        for i in 0..self.forces().contacts() {
            let (p_n, v_n) = paired.normal(i);
            h[p_n] = z[v_n] - self.distance(i, z);
            self.friction_rows(i, z, h);
        }
        for pair in &paired.pairs {
            h[pair.length] = z[pair.force] * z[pair.length];
        }
        Ok(())
    }

    /// Returns `Theta` (10) of the `(u, p_t, p_o, p_n)` in `z`, SI, where `h` is the residual at `z`.
    fn theta(&self, z: &[f64], h: &[f64]) -> f64 {
        let equilibrium = half_square(&h[..self.forces().displacements()]);
        self.paired().natural.theta(&self.paired().data, equilibrium, z, z, 0.0)
    }

    /// Writes the matrix that represents `∇H(z)`. With the right-hand sides `b_v` (gap row) and `b_pv` (product), the row
    /// of `v_n` gives `dv_n = b_v - dw_n`. In the product it leaves `v_n dp_n - p_n dw_n = b_pv - p_n b_v`.
    fn linearize(&mut self, z: &[f64]) {
        for i in 0..self.forces().contacts() {
            let paired = self.paired_mut();
            let (p_n, v_n) = paired.normal(i);
            let normal = z[p_n].max(z[v_n]);
            paired.matrix.set_normal(i, -z[p_n] / normal, z[v_n] / normal);
            paired.row_scale[i][0] = normal;
            self.linearize_friction(i, z);
        }
    }

    /// Returns the matrix of the last linearisation. Its pattern never changes.
    fn matrix(&self) -> &SystemMatrix {
        self.paired().matrix.matrix()
    }

    /// Computes the right-hand side for [`InteriorPoint::matrix`] that represents `∇H(z) dz = b`.
    fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        let n_u = self.forces().displacements();
        rhs[..n_u].copy_from_slice(&b[..n_u]);
        for i in 0..self.forces().contacts() {
            let (p_n, v_n) = self.paired().normal(i);
            rhs[p_n] = (b[v_n] - z[p_n] * b[p_n]) / self.paired().row_scale[i][0];
            self.reduce_friction(i, z, b, rhs);
        }
    }

    /// Completes `dz`, which begins with the solution for the right-hand side of [`InteriorPoint::reduce`]. The small
    /// member of a normal pair gets its change from the product row, divided by the large member. As a difference of
    /// large numbers, or divided by the small member, it would lose most of its digits.
    fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]) {
        for i in 0..self.forces().contacts() {
            let (p_n, v_n) = self.paired().normal(i);
            let from_product = z[p_n] > z[v_n];
            dz[v_n] = if from_product {
                (b[v_n] - z[v_n] * dz[p_n]) / z[p_n]
            } else {
                b[p_n] - self.paired().data.w_n(i, dz)
            };
            self.recover_friction(i, z, b, dz);
        }
    }

    /// Returns the weights of a combination of the problem's rigid modes that no contact node stops, so that the
    /// matrix is singular in every state, or `None` if there is none.
    fn unconstrained_mode(&self) -> Option<Vec<f64>> {
        self.paired().data.unconstrained_mode()
    }

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

/// Two unknowns of which at least one vanishes in the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The place of `p_n` or `s`, a force.
    pub force: usize,
    /// The place of `v_n` or `λ`, a length; also the row of the product.
    pub length: usize,
}

impl Pair {
    /// Returns the product at `z + t dz`.
    pub fn product_ahead(&self, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let at = |k: usize| z[k] + t * dz[k];
        at(self.force) * at(self.length)
    }
}

/// The face of a solution: `true` for each pair, in their order, if the force vanishes, `false` if the length does.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Face(pub(super) Vec<bool>);

impl Face {
    /// Returns a point of length `unknowns` in the relative interior of the face. The linearised products at this
    /// point set the vanishing member of each of the `pairs` to zero.
    pub fn point(&self, pairs: &[Pair], unknowns: usize) -> Vec<f64> {
        let mut point = vec![0.0; unknowns];
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            point[if force_vanishes { pair.length } else { pair.force }] = 1.0;
        }
        point
    }

    /// Computes the right-hand side of the step from `z` (with residual `h`) to the face: `-h`, and in the rows of
    /// the products the vanishing member.
    pub fn towards(&self, pairs: &[Pair], z: &[f64], h: &[f64], b: &mut [f64]) {
        b.iter_mut().zip(h).for_each(|(b, h)| *b = -h);
        for (pair, &force_vanishes) in pairs.iter().zip(&self.0) {
            b[pair.length] = -z[if force_vanishes { pair.force } else { pair.length }];
        }
    }
}

/// Returns the largest step for which all `pairs` of `z + t dz` are nonnegative; infinite if there is no largest.
pub fn largest_step(pairs: &[Pair], z: &[f64], dz: &[f64]) -> f64 {
    least(pairs.iter().flat_map(|pair| [pair.force, pair.length]).map(|k| max_step_of(z[k], dz[k])))
}

/// Returns the largest step for which a positive `value` stays nonnegative along its `change`.
pub(super) fn max_step_of(value: f64, change: f64) -> f64 {
    if change < 0.0 { -value / change } else { f64::INFINITY }
}

/// Returns the smallest of the `steps`. `f64::min` would lose a NaN.
pub(super) fn least(steps: impl Iterator<Item = f64>) -> f64 {
    steps.fold(f64::INFINITY, |least, step| if step < least || step.is_nan() { step } else { least })
}
