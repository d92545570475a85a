//! The constrained equation formulation: `H_I` (25) on `z = (u, p_t, p_n, v_n, s, λ)`, whose last
//! four blocks stay positive, and the Newton systems that its products lead to.
//!
//! Rows stand where the unknowns do: equilibrium at `u`, the slip row at `p_t`, the gap row at
//! `p_n`, the cone rows at `s`, and the products at `v_n` and `λ`. Besides them, `L_n = [I; I]` and
//! `L_t = [I; -I]`:
//!
//! | place | row |
//! | --- | --- |
//! | `u` | `K u + C_tᵀ p_t + C_nᵀ p_n - f` |
//! | `p_n` | `v_n + C_n u - g` |
//! | `p_t` | `-C_t u + L_tᵀ λ + w̄_t` |
//! | `s` | `s - μ L_n p_n + L_t p_t` |
//! | `v_n` | `p_n ∘ v_n` |
//! | `λ` | `λ ∘ s` |
//!
//! A node without friction or without tangential freedom has no `p_t`, `s` and `λ`.

mod extended;
mod face;
mod layout;
mod reduced;

pub use face::Face;
pub use layout::SlackLayout;

use std::ops::Range;

use super::Conventions;
use super::natural::{NaturalRows, half_square};
use super::scaled::Scaled;
use crate::null_space::null_space;
use crate::problem::{ContactProblem, Increment};
use crate::scene::{NewtonSystem, Partition};
use crate::sparse::{Csc, Csr};
use crate::units::Scaling;
use extended::Extended;
use reduced::Reduced;

enum System {
    Reduced(Reduced),
    Extended(Extended),
}

/// `H_I` of a problem, in the units of its scaling.
pub struct Constrained {
    data: Scaled,
    natural: NaturalRows,
    layout: SlackLayout,
    /// Complementary pairs of unknowns, and the place of their product.
    pairs: Vec<Pair>,
    partition: Partition,
    system: System,
}

/// Two unknowns of which one vanishes in the solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// The place of `p_n` or `s`, a force.
    pub force: usize,
    /// The place of `v_n` or `λ`, a length, and of the product's row.
    pub length: usize,
}

impl Constrained {
    /// Sets up `H_I` of `problem`. The `conventions` are for [`Constrained::theta`] alone.
    pub fn new(
        problem: &ContactProblem,
        scaling: Scaling,
        conventions: &Conventions,
        partition: Partition,
        newton: NewtonSystem,
    ) -> Self {
        let data = Scaled::new(problem, scaling);
        let layout = SlackLayout::new(&data.layout);
        let system = match newton {
            NewtonSystem::Reduced => System::Reduced(Reduced::new(problem, &data)),
            NewtonSystem::Extended => System::Extended(Extended::new(problem, &data, &layout)),
        };
        let pairs = layout.pairs().collect();
        Constrained { natural: NaturalRows::new(conventions, &scaling), data, layout, pairs, partition, system }
    }

    /// The layout of `z`.
    pub fn layout(&self) -> &SlackLayout {
        &self.layout
    }

    /// The units of `z`.
    pub fn scaling(&self) -> &Scaling {
        &self.data.scaling
    }

    /// The complementary pairs: `(p_n, v_n)` and `(s, λ)`.
    pub fn pairs(&self) -> &[Pair] {
        &self.pairs
    }

    /// `μ` of every contact node.
    pub fn mu(&self) -> &[f64] {
        &self.data.mu
    }

    /// The gap `g - w_n` that `z` leaves at node `i`, scaled.
    pub fn distance(&self, i: usize, z: &[f64]) -> f64 {
        self.data.gap[i] - self.data.w_n(i, z)
    }

    /// n_2, the number of rows of `G`.
    pub fn n_2(&self) -> usize {
        self.pairs.len() + self.positive_cone_rows().len()
    }

    /// Sets the data of a new increment.
    pub fn begin(&mut self, increment: &Increment<'_>) {
        self.data.begin(increment);
    }

    /// `h = H_I(z)`, (25).
    pub fn residual(&self, z: &[f64], h: &mut [f64]) {
        let Constrained { data, layout, .. } = self;
        // The equilibrium rows of either matrix are constant: K u + C_nᵀ p_n + C_tᵀ p_t - f.
        let matrix = self.matrix();
        let n = matrix.pattern.rows();
        matrix.mul(&z[..n], &mut h[..n]);
        for (row, force) in h.iter_mut().zip(&data.force) {
            *row -= force;
        }
        for i in 0..data.layout.contacts() {
            let p_n = data.layout.p_n(i);
            h[p_n] = z[layout.v_n(i)] - self.distance(i, z);
            if let Some(p_t) = data.layout.p_t(i) {
                let ([s_plus, s_minus], [l_plus, l_minus]) = (layout.s(p_t), layout.lambda(p_t));
                h[p_t] = z[l_plus] - z[l_minus] - (data.w_t(i, z) - data.w_t_last[i]);
                h[s_plus] = z[s_plus] - data.mu[i] * z[p_n] + z[p_t];
                h[s_minus] = z[s_minus] - data.mu[i] * z[p_n] - z[p_t];
            }
        }
        for pair in &self.pairs {
            h[pair.length] = z[pair.force] * z[pair.length];
        }
    }

    /// The places of the rows of `G`.
    pub fn g_rows(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.iter().map(|pair| pair.length).chain(self.positive_cone_rows())
    }

    /// The cone rows in `G`.
    fn positive_cone_rows(&self) -> Range<usize> {
        match self.partition {
            Partition::Products => 0..0,
            Partition::Cone => self.layout.cone_rows(),
        }
    }

    /// `β = eᵀG / n_2` of a residual.
    pub fn beta(&self, h: &[f64]) -> f64 {
        self.g_rows().map(|k| h[k]).sum::<f64>() / self.n_2() as f64
    }

    /// The mean product of the pairs at `z + t dz`.
    pub fn beta_ahead(&self, z: &[f64], dz: &[f64], t: f64) -> f64 {
        let at = |k: usize| z[k] + t * dz[k];
        self.pairs.iter().map(|pair| at(pair.force) * at(pair.length)).sum::<f64>() / self.pairs.len() as f64
    }

    /// `Theta` (10) of the `(u, p_t, p_n)` in `z`, SI, where `h` is the residual there.
    pub fn theta(&self, z: &[f64], h: &[f64]) -> f64 {
        let equilibrium = half_square(&h[..self.data.layout.displacements()]);
        self.natural.theta(&self.data, equilibrium, z, z, 0.0)
    }

    /// `t ↦ ψ(z + t dz)` (13), with `h = H_I(z)` and a direction `dz` that solves (14) with
    /// `centring = σ β`. The rows of `F` are linear and `dz` solves them, so along it they shrink by
    /// `1 - t`.
    pub fn potential_along<'a>(
        &'a self,
        zeta: f64,
        z: &'a [f64],
        dz: &'a [f64],
        h: &'a [f64],
        centring: f64,
    ) -> impl Fn(f64) -> f64 + 'a {
        let g_square: f64 = self.g_rows().map(|k| h[k] * h[k]).sum();
        let f_square = (2.0 * half_square(h) - g_square).max(0.0);
        move |t| {
            let at = |k: usize| z[k] + t * dz[k];
            let (mut sum, mut logarithms) = (0.0, 0.0);
            let mut add = |g: f64| {
                sum += g;
                logarithms += g.ln();
            };
            self.pairs.iter().for_each(|pair| add(at(pair.force) * at(pair.length)));
            self.positive_cone_rows().for_each(|k| add((1.0 - t) * h[k] + t * centring));
            zeta * ((1.0 - t).powi(2) * f_square + sum).ln() - logarithms
        }
    }

    /// `δ`, the largest step for which `z + δ dz` is in the closure of `Ω₊₊`; infinite if there is
    /// no largest. `h` is the residual at `z`, and `centring` what the rows of `G` go to.
    pub fn largest_step(&self, z: &[f64], dz: &[f64], h: &[f64], centring: f64) -> f64 {
        let reach = |value: f64, change: f64| if change < 0.0 { -value / change } else { f64::INFINITY };
        let pairs = self.pairs.iter().flat_map(|pair| [pair.force, pair.length]).map(|k| reach(z[k], dz[k]));
        let cone = self.positive_cone_rows().map(|k| reach(h[k], centring - h[k]));
        // Not `f64::min`, which loses a NaN.
        pairs.chain(cone).fold(f64::INFINITY, |least, step| if step < least || step.is_nan() { step } else { least })
    }

    /// Writes the matrix of (14) at `z`.
    pub fn linearize(&mut self, z: &[f64]) {
        match &mut self.system {
            System::Reduced(system) => system.linearize(&self.data, &self.layout, z),
            System::Extended(system) => system.linearize(&self.layout, z),
        }
    }

    /// Linearises as if every contact node were held where it is: closed, and sticking where there
    /// is friction. With that matrix the other displacements follow a change of the load alone.
    pub fn hold_contacts(&mut self) {
        let mut z = vec![0.0; self.layout.unknowns()];
        // Pressure without distance, friction to spare without slip.
        self.pairs.iter().for_each(|pair| z[pair.force] = 1.0);
        self.linearize(&z);
    }

    /// The matrix of the last linearisation. Its pattern never changes.
    pub fn matrix(&self) -> &Csc {
        match &self.system {
            System::Reduced(system) => system.matrix(),
            System::Extended(system) => system.matrix(),
        }
    }

    /// The right-hand side for [`Constrained::matrix`] that stands for `∇H_I(z) dz = b`.
    pub fn reduce(&self, z: &[f64], b: &[f64], rhs: &mut [f64]) {
        match &self.system {
            System::Reduced(system) => system.reduce(&self.data, &self.layout, z, b, rhs),
            System::Extended(_) => rhs.copy_from_slice(b),
        }
    }

    /// Completes `dz`, which begins with the solution for the right-hand side of
    /// [`Constrained::reduce`].
    pub fn recover(&self, z: &[f64], b: &[f64], dz: &mut [f64]) {
        if let System::Reduced(_) = &self.system {
            reduced::recover(&self.data, &self.layout, z, b, dz);
        }
    }

    /// Weights of a combination of the problem's free motions that no contact node stops, so that
    /// the matrix is singular in every state; `None` if there is none.
    pub fn unheld_motion(&self) -> Option<Vec<f64>> {
        let Scaled { layout, c_n, c_t, free_motions, .. } = &self.data;
        let normal = (0..layout.contacts()).map(|i| (c_n, i));
        let tangential = (0..layout.contacts()).filter(|&i| layout.p_t(i).is_some()).map(|i| (c_t, i));
        let row = |(c, i): (&Csr, usize)| free_motions.iter().map(|motion| c.dot(i, motion)).collect();
        null_space(free_motions.len(), normal.chain(tangential).map(row)).into_iter().next()
    }

    /// Whether there is no contact node, so that a single step solves the increment.
    pub fn is_affine(&self) -> bool {
        self.pairs.is_empty()
    }
}
